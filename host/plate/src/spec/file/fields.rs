//! The fields of a plate file: what each means, what it may be, and which kind of taper, model or drive end has it.

use crate::quantity::{Count, Range};
use crate::spec::limits;
use std::borrow::Cow;

/// What a field has to hold.
pub(super) enum Due {
    /// A number in a range that is the same for every plate.
    Number(Range),
    /// A number whose range depends on the other fields, in words.
    NumberThat(&'static str),
    /// A text, by its length in characters.
    Text(Count),
    /// true or false.
    Flag,
    /// Pairs of numbers.
    Points,
    /// One of the section's kinds.
    Kind,
}

/// One field.
pub(super) struct FieldSpec {
    pub(super) name: &'static str,
    pub(super) due: Due,
    pub(super) meaning: &'static str,
}

/// One section, or the plate itself (whose name is empty).
pub(super) struct Section {
    pub(super) name: &'static str,
    pub(super) meaning: &'static str,
    /// The field that says which kind it is, and so which other fields it has.
    pub(super) kind_field: &'static str,
    /// Each kind with its fields.
    pub(super) kinds: &'static [(&'static str, &'static [&'static str])],
    pub(super) fields: &'static [FieldSpec],
}

const fn field(name: &'static str, due: Due, meaning: &'static str) -> FieldSpec {
    FieldSpec { name, due, meaning }
}

pub(super) const PLATE: Section = Section {
    name: "",
    meaning: "",
    kind_field: "",
    kinds: &[],
    fields: &[
        field("name", Due::Text(limits::NAME), "the plate's short name"),
        field("description", Due::Text(limits::DESCRIPTION), "one line that says what the plate is"),
        field("length_m", Due::Number(limits::LENGTH), "from the driven end to the narrow end"),
        field("loss_factor", Due::Number(limits::LOSS_FACTOR), "loss factor of the modulus or the tension"),
        field(
            "wave_speed_tolerance",
            Due::Number(limits::WAVE_SPEED_TOLERANCE),
            "how well the wave speed is known",
        ),
        field("full_scale_m", Due::Number(limits::FULL_SCALE), "the drive's displacement at DAC full scale"),
        field("span_start_m", Due::NumberThat("above 0, in m"), "the nearest turning point that is offered"),
        field(
            "span_end_m",
            Due::NumberThat("up to length_m, in m"),
            "the farthest turning point that is offered",
        ),
        field(
            "band_start_hz",
            Due::NumberThat("in Hz, so high that it enters the plate"),
            "the lowest frequency",
        ),
        field(
            "band_end_hz",
            Due::NumberThat("in Hz, so low that it turns on the plate"),
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
    fields: &[
        field("kind", Due::Kind, "the law of the half-width"),
        field("half_width_m", Due::Number(limits::HALF_WIDTH), "half-width at the driven end"),
        field("rate_per_m", Due::Number(limits::TAPER_RATE), "how fast the half-width falls"),
        field(
            "end_half_width_m",
            Due::NumberThat("1e-5 m to 0.999 half_width_m"),
            "half-width at the narrow end",
        ),
        field("points", Due::Points, "places with their half-widths"),
    ],
};

const BENDING: &[&str] =
    &["youngs_modulus_pa", "poisson_ratio", "density_kg_per_m3", "thickness_m", "thick_plate"];

pub(super) const MODEL: Section = Section {
    name: "model",
    meaning: "material, edge and wave",
    kind_field: "kind",
    kinds: &[
        ("membrane", &["wave_speed_m_per_s"]),
        ("shear-horizontal", &["shear_modulus_pa", "density_kg_per_m3"]),
        ("bending-supported", BENDING),
        ("bending-clamped", BENDING),
    ],
    fields: &[
        field("kind", Due::Kind, "the wave and the edge"),
        field("wave_speed_m_per_s", Due::Number(limits::WAVE_SPEED), "wave speed of the membrane"),
        field("shear_modulus_pa", Due::Number(limits::SHEAR_MODULUS), "shear modulus"),
        field("youngs_modulus_pa", Due::Number(limits::YOUNGS_MODULUS), "Young's modulus"),
        field("poisson_ratio", Due::Number(limits::POISSON_RATIO), "Poisson's ratio"),
        field("density_kg_per_m3", Due::Number(limits::DENSITY), "density"),
        field("thickness_m", Due::Number(limits::THICKNESS), "thickness of the sheet"),
        field("thick_plate", Due::Flag, "Mindlin's correction"),
    ],
};

const AT_FREQUENCY: &str = "in Hz, so high that it enters the plate";

pub(super) const DRIVE: Section = Section {
    name: "drive",
    meaning: "what is held at the driven end",
    kind_field: "end",
    kinds: &[
        ("displacement", &[]),
        ("force", &["at_frequency_hz"]),
        ("resistance", &["ratio", "at_frequency_hz"]),
    ],
    fields: &[
        field("end", Due::Kind, "what is held at the driven end"),
        field("ratio", Due::Number(limits::DRIVE_RATIO), "the resistance over the wave's own"),
        field("at_frequency_hz", Due::NumberThat(AT_FREQUENCY), "the frequency it is told for"),
    ],
};

pub(super) const ACTUATOR: Section = Section {
    name: "actuator",
    meaning: "the resonance between the DAC and the driven end",
    kind_field: "",
    kinds: &[],
    fields: &[
        field("resonance_hz", Due::Number(limits::RESONANCE), "resonance of the actuator"),
        field("quality", Due::Number(limits::QUALITY), "quality factor of the resonance"),
    ],
};

/// All of them; the plate's own fields first.
pub(super) const SECTIONS: [&Section; 5] = [&PLATE, &TAPER, &MODEL, &DRIVE, &ACTUATOR];

impl Section {
    /// The field of that name.
    pub(super) fn field(&self, name: &str) -> Option<&'static FieldSpec> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// The field as it is written in a message: `taper.kind`.
    pub(super) fn path(&self, name: &str) -> String {
        if self.name.is_empty() { name.to_owned() } else { format!("{}.{name}", self.name) }
    }

    /// What a field of it has to be, in words that follow "must be".
    pub(super) fn allowed(&self, field: &FieldSpec) -> Cow<'static, str> {
        match &field.due {
            Due::Number(range) => format!("a number, {range}").into(),
            Due::NumberThat(words) => format!("a number, {words}").into(),
            Due::Text(Count { least: 0, most, of }) => format!("a text in quotes, up to {most} {of}").into(),
            Due::Text(count) => format!("a text in quotes, {count} {}", count.of).into(),
            Due::Flag => "true or false".into(),
            Due::Points => {
                format!("{} pairs [place, half-width] of numbers, in m", limits::TAPER_POINTS).into()
            }
            Due::Kind => self.one_of().into(),
        }
    }

    /// `one of "force", "displacement"`.
    pub(super) fn one_of(&self) -> String {
        let words: Vec<String> = self.kinds.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        format!("one of {}", words.join(", "))
    }
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
                let name = format!("`{}`", field.name);
                let Due::Number(range) = field.due else {
                    assert!(page.contains(&name), "{name}");
                    continue;
                };
                let range = range.to_string().trim_end_matches(range.unit).trim().to_owned();
                let row = page.lines().find(|line| line.contains(&name) && line.contains(&range));
                assert!(row.is_some(), "{name} {range}");
            }
            for (kind, fields) in section.kinds {
                let row = page.lines().find(|line| line.contains(&format!("`\"{kind}\"`"))).expect(kind);
                assert!(fields.iter().all(|field| row.contains(field)), "{kind}");
            }
        }
    }
}
