//! The fields of a plate file, each stated once: name, type and range, meaning, place in a [`crate::PlateSpec`], and caption.
//! Reader and writer (`file`), range checks, messages and the panels of the window are made from these tables; a test holds the
//! page on plate files, `PLATES.md`, to them.

mod drive;
mod field;
mod sheet;

use crate::definition::error::PlateError;
use crate::definition::spec::PlateSpec;
pub(crate) use drive::{DRIVE, HARMONIC_POINTS};
pub use field::Field;
pub(crate) use field::{FieldType, Kind, Section, Slot};
pub(crate) use sheet::{MODEL, PLATE, TAPER};

/// All sections; the plate's own fields come first.
pub(crate) const SECTIONS: [&Section; 10] = [
    &PLATE,
    &TAPER,
    &MODEL,
    &sheet::THICKNESS,
    &DRIVE,
    &drive::LEAD_IN,
    &drive::AIR,
    &drive::FRAME,
    &drive::ACTUATOR,
    &drive::CALIBRATION,
];

/// The field with the path of a plate file, such as `taper.half_width_m`. The path of a list stands for all its elements:
/// `taper.points` for `taper.points[3][1]`.
#[must_use]
pub fn field(path: &str) -> Option<&'static Field> {
    let path = path.split_once('[').map_or(path, |(list, _)| list);
    let (section, name) = path.rsplit_once('.').unwrap_or(("", path));
    SECTIONS.into_iter().find(|schema| schema.name == section)?.field(name)
}

/// Checks every number that a specification has by the range of its field.
pub(crate) fn check_ranges(spec: &mut PlateSpec) -> Result<(), PlateError> {
    for section in SECTIONS {
        for field in section.fields {
            let number = field.number_of(spec).copied();
            if let (FieldType::Number(range), Some(number)) = (&field.field_type, number)
                && !range.contains(number)
            {
                return Err(range.refuse(&section.path(field.name), number, None));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::air::{Air, AirMounting};
    use crate::definition::drive::DriveEnd;
    use crate::definition::model::Model;
    use crate::definition::taper::Taper;
    use crate::definition::thickness::Thickness;

    /// A section, the words of its kinds, and the word of a specification's kind: a match over all alternatives, so that a new one
    /// does not compile without its word here.
    macro_rules! words {
        ($section:expr, $spec:ident => $place:expr, $($is:pat => $word:literal),+) => {
            ($section, [$($word),+].as_slice(), |$spec: &PlateSpec| match $place { $($is => $word),+ })
        };
    }

    #[test]
    fn every_kind_of_a_plate_has_a_row_in_its_section() {
        type Words = (&'static Section, &'static [&'static str], fn(&PlateSpec) -> &'static str);
        let sections: [Words; 5] = [
            words!(&TAPER, spec => spec.taper,
                Taper::Exponential { .. } => "exponential",
                Taper::Linear { .. } => "linear",
                Taper::Sampled { .. } => "sampled"),
            words!(&MODEL, spec => spec.model,
                Model::Membrane { .. } => "membrane",
                Model::ShearHorizontal { .. } => "shear-horizontal",
                Model::BendingSupported(_) => "bending-supported",
                Model::BendingClamped(_) => "bending-clamped"),
            words!(&sheet::THICKNESS, spec => spec.thickness.as_ref().expect("a thickness"),
                Thickness::Exponential { .. } => "exponential",
                Thickness::Linear { .. } => "linear",
                Thickness::Sampled { .. } => "sampled"),
            words!(&DRIVE, spec => spec.drive_end,
                DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. } => "displacement",
                DriveEnd::Force { .. } => "force",
                DriveEnd::Resistance { .. } => "resistance",
                DriveEnd::Source(_) => "source"),
            words!(&drive::AIR, spec => spec.air.expect("air"),
                Air::Around { mounting: AirMounting::Baffle { .. }, .. } => "baffle",
                Air::Around { mounting: AirMounting::BareFrame, .. } => "bare-frame",
                Air::Around { mounting: AirMounting::Unknown, .. } => "unknown",
                Air::Around { mounting: AirMounting::Coefficient { .. }, .. } => "coefficient",
                Air::Around { mounting: AirMounting::Calibrated { .. }, .. } => "calibrated",
                Air::Vacuum => "vacuum"),
        ];
        for (section, words, word_of) in sections {
            let rows: Vec<&str> = section.kinds.iter().map(|kind| kind.word).collect();
            assert_eq!(rows, words, "[{}]", section.name);
            for kind in section.kinds {
                let mut spec = crate::preset("membrane").expect("a preset").spec().clone();
                (kind.begin)(&mut spec, &|_| false);
                assert_eq!(word_of(&spec), kind.word, "[{}]", section.name);
                let found = section.kind_of(&spec).map(|kind| kind.word);
                assert_eq!(found, Some(kind.word), "[{}]", section.name);
            }
        }
    }

    #[test]
    fn the_page_on_plate_files_names_every_field_and_kind_and_the_ranges_in_force() {
        // The page groups the thousands.
        let page = include_str!("../../../PLATES.md").replace(" 000", "000");
        for section in SECTIONS {
            for field in section.fields {
                let name = match field.field_type {
                    FieldType::Section => format!("`[{}]`", section.path(field.name)),
                    _ => format!("`{}`", field.name),
                };
                let FieldType::Number(range) = field.field_type else {
                    assert!(page.contains(&name), "{name}");
                    continue;
                };
                let mut range = range.to_string().trim_end_matches(range.unit).trim().to_owned();
                if let Some(default) = field.default {
                    range = format!("{range}, default {}", crate::quantity::number_format::typed(default));
                }
                let row = page.lines().find(|line| line.contains(&name) && line.contains(&range));
                assert!(row.is_some(), "{name} {range}");
            }
            for kind in section.kinds.iter().filter(|_| !section.kind_field.is_empty()) {
                let is_row =
                    |line: &&str| line.starts_with('|') && line.contains(&format!("`\"{}\"`", kind.word));
                // Several sections have kinds of the same name.
                let has_all = |row: &str| kind.fields.iter().all(|field| row.contains(field));
                assert!(page.lines().filter(is_row).any(has_all), "{}", kind.word);
            }
        }
    }
}
