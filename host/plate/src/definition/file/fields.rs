//! The schema of a plate file: for each field its meaning, its type and range, and the kinds of taper, model or drive
//! end that have it.

use crate::definition::limits;
use crate::definition::turning_width::TurningWidth;
use crate::quantity::{Count, Range};
use std::borrow::Cow;

/// Type and range of a field.
pub(super) enum FieldType {
    /// A number in a range that is the same for every plate.
    Number(Range),
    /// A number whose range depends on other fields; the text describes the range.
    NumberThat(&'static str),
    /// A text with the given number of characters.
    Text(Count),
    /// true or false.
    Flag,
    /// Points of several numbers.
    Points(&'static Columns),
    /// One of the section's kinds.
    Kind,
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A section of its own.
    Section,
}

/// A list of points: how many there may be, and what each of them is, in words.
pub(super) struct Columns {
    points: Count,
    /// `a pair [place, half-width] of numbers, in m`.
    pub(super) one: &'static str,
    many: &'static str,
}

const PLACES: Columns = Columns {
    points: limits::TAPER_POINTS,
    one: "a pair [place, half-width] of numbers, in m",
    many: "pairs [place, half-width] of numbers, in m",
};
const THICKNESSES: Columns = Columns {
    points: limits::TAPER_POINTS,
    one: "a pair [place, thickness] of numbers, in m",
    many: "pairs [place, thickness] of numbers, in m",
};
const CURVE: Columns = Columns {
    points: limits::CURVE_POINTS,
    one: "a triple [frequency, gain, phase] of numbers, in Hz, dB and degrees",
    many: "triples [frequency, gain, phase] of numbers, in Hz, dB and degrees",
};

/// One field.
pub(super) struct FieldSpec {
    pub(super) name: &'static str,
    pub(super) field_type: FieldType,
    pub(super) meaning: &'static str,
}

/// A section of the file. The fields above the first section header form a section with an empty name.
pub(super) struct Section {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
    /// The field that selects the kind; empty if the section has no kinds.
    pub(super) kind_field: &'static str,
    /// Each kind with the names of its fields.
    pub(super) kinds: &'static [(&'static str, &'static [&'static str])],
    /// A kind that one may look for here, and why it is not there; both empty if there is none.
    pub(super) not_a_kind: (&'static str, &'static str),
    pub(super) fields: &'static [FieldSpec],
}

const fn field(name: &'static str, field_type: FieldType, meaning: &'static str) -> FieldSpec {
    FieldSpec { name, field_type, meaning }
}

/// No kind that one may look for in vain.
const NONE: (&str, &str) = ("", "");

const TURNING_WIDTHS: &[&str] = &[TurningWidth::ALL[0].word(), TurningWidth::ALL[1].word()];

pub(super) const PLATE: Section = Section {
    name: "",
    meaning: "",
    kind_field: "",
    kinds: &[],
    not_a_kind: NONE,
    fields: &[
        field("name", FieldType::Text(limits::NAME), "the plate's short name"),
        field("description", FieldType::Text(limits::DESCRIPTION), "one line that says what the plate is"),
        field("length_m", FieldType::Number(limits::LENGTH), "from the driven end to the narrow end"),
        field(
            "loss_factor",
            FieldType::Number(limits::LOSS_FACTOR),
            "loss factor of the modulus or the tension",
        ),
        field(
            "wave_speed_tolerance",
            FieldType::Number(limits::WAVE_SPEED_TOLERANCE),
            "how well the wave speed is known",
        ),
        field("turning_width", FieldType::OneOf(TURNING_WIDTHS), "the width that decides where a wave turns"),
        field(
            "loss_tolerance",
            FieldType::Number(limits::LOSS_TOLERANCE),
            "how well the loss factor is known",
        ),
        field(
            "full_scale_m",
            FieldType::Number(limits::FULL_SCALE),
            "the drive's displacement at DAC full scale",
        ),
        field(
            "span_start_m",
            FieldType::NumberThat("above 0, in m"),
            "the nearest turning point that is offered",
        ),
        field(
            "span_end_m",
            FieldType::NumberThat("up to length_m, in m"),
            "the farthest turning point that is offered",
        ),
        field(
            "band_start_hz",
            FieldType::NumberThat("in Hz, so high that it enters the plate"),
            "the lowest frequency",
        ),
        field(
            "band_end_hz",
            FieldType::NumberThat("in Hz, so low that it turns on the plate"),
            "the highest frequency",
        ),
    ],
};

pub(super) const TAPER: Section = Section {
    name: "taper",
    meaning: "how the half-width narrows",
    kind_field: "kind",
    kinds: &[
        ("exponential", &["half_width_m", "rate_per_m"]),
        ("linear", &["half_width_m", "end_half_width_m"]),
        ("sampled", &["points"]),
    ],
    not_a_kind: NONE,
    fields: &[
        field("kind", FieldType::Kind, "the law of the half-width"),
        field("half_width_m", FieldType::Number(limits::HALF_WIDTH), "half-width at the driven end"),
        field("rate_per_m", FieldType::Number(limits::TAPER_RATE), "how fast the half-width falls"),
        field(
            "end_half_width_m",
            FieldType::NumberThat("1e-5 m to 0.999 half_width_m"),
            "half-width at the narrow end",
        ),
        field("points", FieldType::Points(&PLACES), "places with their half-widths"),
    ],
};

const BENDING: &[&str] =
    &["youngs_modulus_pa", "poisson_ratio", "density_kg_per_m3", "thickness_m", "thick_plate"];

pub(super) const MODEL: Section = Section {
    name: "model",
    meaning: "material, edge and wave",
    kind_field: "kind",
    kinds: &[
        (
            "membrane",
            &["wave_speed_m_per_s", "tension_n_per_m", "youngs_modulus_pa", "poisson_ratio", "thickness_m"],
        ),
        ("shear-horizontal", &["shear_modulus_pa", "density_kg_per_m3", "thickness_m"]),
        ("bending-supported", BENDING),
        ("bending-clamped", BENDING),
    ],
    not_a_kind: NONE,
    fields: &[
        field("kind", FieldType::Kind, "the wave and the edge"),
        field("wave_speed_m_per_s", FieldType::Number(limits::WAVE_SPEED), "wave speed of the membrane"),
        field("tension_n_per_m", FieldType::Number(limits::TENSION), "tension per metre of width"),
        field("shear_modulus_pa", FieldType::Number(limits::SHEAR_MODULUS), "shear modulus"),
        field("youngs_modulus_pa", FieldType::Number(limits::YOUNGS_MODULUS), "Young's modulus"),
        field("poisson_ratio", FieldType::Number(limits::POISSON_RATIO), "Poisson's ratio"),
        field("density_kg_per_m3", FieldType::Number(limits::DENSITY), "density"),
        field("thickness_m", FieldType::Number(limits::THICKNESS), "thickness of the sheet"),
        field("thick_plate", FieldType::Flag, "Mindlin's correction"),
    ],
};

pub(super) const THICKNESS: Section = Section {
    name: "thickness",
    meaning: "how the thickness of a plate in bending changes along it",
    kind_field: "kind",
    kinds: &[("exponential", &["rate_per_m"]), ("linear", &["end_thickness_m"]), ("sampled", &["points"])],
    not_a_kind: NONE,
    fields: &[
        field("kind", FieldType::Kind, "the law of the thickness"),
        field("rate_per_m", FieldType::Number(limits::THICKNESS_RATE), "how fast the thickness falls"),
        field("end_thickness_m", FieldType::Number(limits::THICKNESS), "thickness at the narrow end"),
        field("points", FieldType::Points(&THICKNESSES), "places with their thicknesses"),
    ],
};

const AT_FREQUENCY: &str = "in Hz, so high that it enters the plate";

pub(super) const DRIVE: Section = Section {
    name: "drive",
    meaning: "what is held at the driven end",
    kind_field: "end",
    kinds: &[
        ("displacement", &["slope"]),
        ("force", &["at_frequency_hz"]),
        ("resistance", &["ratio", "at_frequency_hz"]),
        ("source", &["at_frequency_hz", "resistance_n_s_per_m", "mass_kg", "stiffness_n_per_m", "slope"]),
    ],
    not_a_kind: NONE,
    fields: &[
        field("end", FieldType::Kind, "what is held at the driven end"),
        field("slope", FieldType::OneOf(&["free", "held"]), "what holds the slope of an end in bending"),
        field(
            "resistance_n_s_per_m",
            FieldType::Number(limits::MECHANICAL_RESISTANCE),
            "resistance of the driven end",
        ),
        field("mass_kg", FieldType::Number(limits::MOVING_MASS), "mass that moves with the driven end"),
        field(
            "stiffness_n_per_m",
            FieldType::Number(limits::END_STIFFNESS),
            "stiffness of the driven end against the frame",
        ),
        field("lead_in", FieldType::Section, "a strip with loss behind the drive"),
        field("ratio", FieldType::Number(limits::DRIVE_RATIO), "the resistance over the wave's own"),
        field("at_frequency_hz", FieldType::NumberThat(AT_FREQUENCY), "the frequency it is told for"),
    ],
};

pub(super) const LEAD_IN: Section = Section {
    name: "drive.lead_in",
    meaning: "a strip with loss behind the drive of a plate in bending",
    kind_field: "",
    kinds: &[],
    not_a_kind: NONE,
    fields: &[
        field("length_m", FieldType::Number(limits::LEAD_IN_LENGTH), "length of the lead-in"),
        field(
            "loss_factor",
            FieldType::Number(limits::LEAD_IN_LOSS),
            "loss factor of the lead-in with its layer",
        ),
        field(
            "end_resistance_n_s_per_m",
            FieldType::Number(limits::MECHANICAL_RESISTANCE),
            "resistance at the far end of the lead-in",
        ),
    ],
};

pub(super) const AIR: Section = Section {
    name: "air",
    meaning: "the air that swings with the plate",
    kind_field: "mounting",
    kinds: &[
        ("baffle", &["faces", "density_kg_per_m3", "sound_speed_m_per_s", "temperature_c", "height_m"]),
        ("bare-frame", &["density_kg_per_m3", "sound_speed_m_per_s", "temperature_c", "height_m"]),
        ("unknown", &["density_kg_per_m3", "sound_speed_m_per_s", "temperature_c", "height_m"]),
        (
            "coefficient",
            &[
                "coefficient",
                "faces",
                "density_kg_per_m3",
                "sound_speed_m_per_s",
                "temperature_c",
                "height_m",
            ],
        ),
        (
            "calibrated",
            &[
                "coefficient",
                "distant_share",
                "faces",
                "density_kg_per_m3",
                "sound_speed_m_per_s",
                "temperature_c",
                "height_m",
            ],
        ),
        ("vacuum", &[]),
    ],
    not_a_kind: (
        "closed-box",
        "a closed box is a spring against the volume that the plate moves, which no law here has: open its back",
    ),
    fields: &[
        field("mounting", FieldType::Kind, "how the plate stands in the air"),
        field(
            "coefficient",
            FieldType::Number(limits::AIR_COEFFICIENT),
            "the air's mass on each face over that of an endless plane wave",
        ),
        field(
            "distant_share",
            FieldType::Number(limits::DISTANT_AIR),
            "the pressure at a distance over that in a baffle",
        ),
        field("faces", FieldType::NumberThat("1 or 2"), "how many faces have air"),
        field("density_kg_per_m3", FieldType::Number(limits::AIR_DENSITY), "density of the air"),
        field("sound_speed_m_per_s", FieldType::Number(limits::SOUND_SPEED), "speed of sound"),
        field("temperature_c", FieldType::Number(limits::AIR_TEMPERATURE), "temperature of the air"),
        field("height_m", FieldType::Number(limits::AIR_HEIGHT), "height above the sea"),
    ],
};

pub(super) const ACTUATOR: Section = Section {
    name: "actuator",
    meaning: "what lies between the DAC and the driven end",
    kind_field: "",
    kinds: &[],
    not_a_kind: NONE,
    fields: &[
        field("resonance_hz", FieldType::Number(limits::RESONANCE), "resonance of the actuator"),
        field("quality", FieldType::Number(limits::QUALITY), "quality factor of the resonance"),
        field(
            "peak_travel_m",
            FieldType::Number(limits::TRAVEL),
            "farthest that the actuator may move from its rest",
        ),
        field(
            "static_travel_m",
            FieldType::Number(limits::TRAVEL),
            "how far a steady signal at DAC full scale would move it",
        ),
        field("points", FieldType::Points(&CURVE), "the measured response"),
    ],
};

pub(super) const CALIBRATION: Section = Section {
    name: "calibration",
    meaning: "how well the plate was measured, and what its drive does over what the file says",
    kind_field: "",
    kinds: &[],
    not_a_kind: NONE,
    fields: &[
        field("chi2_per_n", FieldType::Number(limits::CHI2_PER_N), "how well the measurement fits"),
        field(
            "half_width_tolerance",
            FieldType::Number(limits::CALIBRATED),
            "how well the half-width at the driven end is known",
        ),
        field("taper_tolerance", FieldType::Number(limits::CALIBRATED), "how well ln(W0/W(L)) is known"),
        field(
            "level_tolerance_db",
            FieldType::Number(limits::LEVEL_TOLERANCE_DB),
            "how well the level of the peak is known",
        ),
        field(
            "resistance_tolerance_n_s_per_m",
            FieldType::Number(limits::MECHANICAL_RESISTANCE),
            "how well the drive's resistance is known",
        ),
        field(
            "mass_tolerance_kg",
            FieldType::Number(limits::MOVING_MASS),
            "how well the drive's moving mass is known",
        ),
        field(
            "stiffness_tolerance_n_per_m",
            FieldType::Number(limits::END_STIFFNESS),
            "how well the drive's stiffness is known",
        ),
        field("points", FieldType::Points(&CURVE), "the measured gain over what the file gives"),
    ],
};

/// All sections; the plate's own fields come first.
pub(super) const SECTIONS: [&Section; 9] =
    [&PLATE, &TAPER, &MODEL, &THICKNESS, &DRIVE, &LEAD_IN, &AIR, &ACTUATOR, &CALIBRATION];

impl Section {
    /// The field of that name.
    pub(super) fn field(&self, name: &str) -> Option<&'static FieldSpec> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// The field's name in a message: `taper.kind`.
    pub(super) fn path(&self, name: &str) -> String {
        if self.name.is_empty() { name.to_owned() } else { format!("{}.{name}", self.name) }
    }

    /// The allowed values of a field, as a phrase that follows "must be".
    pub(super) fn allowed(&self, field: &FieldSpec) -> Cow<'static, str> {
        match &field.field_type {
            FieldType::Number(range) => format!("a number, {range}").into(),
            FieldType::NumberThat(words) => format!("a number, {words}").into(),
            FieldType::Text(Count { least: 0, most, of }) => {
                format!("a text in quotes, up to {most} {of}").into()
            }
            FieldType::Text(count) => format!("a text in quotes, {}", count.with_unit()).into(),
            FieldType::Flag => "true or false".into(),
            FieldType::Points(Columns { points, many, .. }) => format!("{points} {many}").into(),
            FieldType::Kind => self.one_of().into(),
            FieldType::OneOf(words) => one_of(words.iter().copied()).into(),
            FieldType::Section => format!("a section [{}]", self.path(field.name)).into(),
        }
    }

    /// `one of "force", "displacement"`.
    pub(super) fn one_of(&self) -> String {
        one_of(self.kinds.iter().map(|(word, _)| *word))
    }
}

fn one_of<'w>(words: impl Iterator<Item = &'w str>) -> String {
    let words: Vec<String> = words.map(|word| format!("\"{word}\"")).collect();
    format!("one of {}", words.join(", "))
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
                let range = range.to_string().trim_end_matches(range.unit).trim().to_owned();
                let row = page.lines().find(|line| line.contains(&name) && line.contains(&range));
                assert!(row.is_some(), "{name} {range}");
            }
            for (kind, fields) in section.kinds {
                let is_row = |line: &&str| line.starts_with('|') && line.contains(&format!("`\"{kind}\"`"));
                // Several sections have kinds of the same name.
                let has_all = |row: &str| fields.iter().all(|field| row.contains(field));
                assert!(page.lines().filter(is_row).any(has_all), "{kind}");
            }
        }
    }
}
