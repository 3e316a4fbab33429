//! The fields of a plate file, each stated once: name, type and range, meaning, place in a [`crate::PlateSpec`], and caption.
//! Reader and writer (`file`), messages and the panels of the window are made from these tables; a test holds the page on
//! plate files, `PLATES.md`, to them.

mod drive;
mod field;
mod sheet;

pub(crate) use drive::DRIVE;
pub use field::Field;
pub(crate) use field::{FieldType, Kind, Section, Slot};
pub(crate) use sheet::{MODEL, PLATE, TAPER};

/// All sections; the plate's own fields come first.
pub(crate) const SECTIONS: [&Section; 9] = [
    &PLATE,
    &TAPER,
    &MODEL,
    &sheet::THICKNESS,
    &DRIVE,
    &drive::LEAD_IN,
    &drive::AIR,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_on_plate_files_tells_of_every_field_and_kind_and_of_the_ranges_in_force() {
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
