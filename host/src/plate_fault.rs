//! What is wrong with a plate, in the words of the panels: fields by their labels, numbers as a person types them, in
//! the panels' units. A plate file's own words are [`PlateError`]'s.

use slipline_plate::PlateError;

/// Which panel's labels are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The numbers of the plate on the screen.
    Plate,
    /// The designer.
    Designer,
}

/// The labels of the fields that both panels call the same.
const LABELS: [(&str, &str); 27] = [
    ("name", "Name"),
    ("length_m", "Length"),
    ("taper.half_width_m", "Half-width"),
    ("taper.rate_per_m", "Taper rate"),
    ("taper.end_half_width_m", "Half-width at the end"),
    ("span_start_m", "Span from"),
    ("span_end_m", "Span to"),
    ("model.wave_speed_m_per_s", "Wave speed"),
    ("model.shear_modulus_pa", "Shear modulus"),
    ("model.density_kg_per_m3", "Density"),
    ("model.youngs_modulus_pa", "Young's modulus"),
    ("model.poisson_ratio", "Poisson's ratio"),
    ("model.thickness_m", "Thickness"),
    ("loss_factor", "Loss factor"),
    ("drive.ratio", "Resistance ratio"),
    ("full_scale_m", "At full scale"),
    ("thickness_m", "Thickness"),
    ("band low", "Band from"),
    ("band high", "Band to"),
    ("start_margin_m", "Start margin"),
    ("end_margin_m", "End margin"),
    ("material.loss_factor", "Loss factor"),
    ("material.youngs_modulus_pa", "Young's modulus"),
    ("material.poisson_ratio", "Poisson's ratio"),
    ("material.density_kg_per_m3", "Density"),
    ("rim_m", "Rim"),
    ("drive.at_frequency_hz", "Frequency of the resistance"),
];

/// Where the designer's labels differ: it chooses what the other panel shows.
const DESIGNER: [(&str, &str); 3] =
    [("full_scale_m", "Full scale"), ("span_start_m", "Start margin"), ("span_end_m", "End margin")];

fn label(panel: Panel, field: &str) -> String {
    let named = |labels: &[(&str, &'static str)]| {
        labels.iter().find(|(name, _)| *name == field).map(|(_, label)| *label)
    };
    let own = if panel == Panel::Designer { named(&DESIGNER) } else { None };
    match own.or_else(|| named(&LABELS)) {
        Some(label) => label.to_owned(),
        None if field.starts_with("taper.points") => "The file's half-widths".to_owned(),
        None => field.to_owned(),
    }
}

/// What is wrong, as a sentence for a panel.
#[must_use]
pub fn sentence(error: &PlateError, panel: Panel) -> String {
    let label = |field: &str| label(panel, field);
    match error {
        PlateError::OutOfRange { field, value, allowed } => {
            let unit = unit_of(field);
            let value = if field.starts_with("taper.points") { String::new() } else { written(*value, unit) };
            let allowed = in_panel_units(&allowed.replace("length_m = ", "the length, "), unit);
            format!("{}: must be {allowed}", format!("{} {value}", label(field)).trim_end())
        }
        PlateError::Missing { field, needed } => format!("{} is missing: {needed}", label(field)),
        PlateError::Unexpected { field, reason } => {
            format!("{} does not belong here: {reason}", label(field))
        }
        PlateError::UnknownKind { field, value, allowed } => {
            format!("{} {value}: must be {allowed}", label(field))
        }
        PlateError::TooLong { field, length, unit, allowed } => {
            format!("{} has {length} {unit}: must be {allowed}", label(field))
        }
        PlateError::NotNarrowing { index, .. } => format!(
            "The file's half-widths: from point {} to point {} the plate does not narrow",
            index,
            index + 1
        ),
    }
}

/// A unit of the library, the panels' unit for it, and the factor from the first to the second.
type Unit = (&'static str, &'static str, f64);

const METRES: Unit = ("m", "mm", 1e3);
const HERTZ: Unit = ("Hz", "Hz", 1.0);
const PLAIN: Unit = ("", "", 1.0);

/// The unit of a field, by its name's end.
fn unit_of(field: &str) -> Unit {
    [
        ("wave_speed_m_per_s", ("m/s", "m/s", 1.0)),
        ("density_kg_per_m3", ("kg/m^3", "kg/m³", 1.0)),
        ("youngs_modulus_pa", ("Pa", "GPa", 1e-9)),
        ("shear_modulus_pa", ("Pa", "MPa", 1e-6)),
        ("_per_m", ("1/m", "1/m", 1.0)),
        ("_hz", HERTZ),
        ("band low", HERTZ),
        ("band high", HERTZ),
        ("_m", METRES),
    ]
    .into_iter()
    .find(|(end, _)| field.ends_with(end))
    .map_or(PLAIN, |(_, unit)| unit)
}

/// A number as a person types it: five digits that count, as many as the library's own ranges have, no exponent where none is needed.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value.is_finite() { "0".to_owned() } else { "no number".to_owned() };
    }
    let decade = value.abs().log10().floor();
    if !(-9.0..9.0).contains(&decade) {
        return format!("{value:.3e}");
    }
    let decimals = (4.0 - decade).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A value of the library's with the panels' unit.
fn written(value: f64, unit: Unit) -> String {
    let (shown, factor) = shown_unit(unit, value);
    format!("{} {shown}", number(value * factor)).trim_end().to_owned()
}

/// The unit in which a value is written, and the factor to it: frequencies from 1 kHz on are in kHz.
fn shown_unit((_, shown, factor): Unit, value: f64) -> (&'static str, f64) {
    if shown == "Hz" && value.abs() >= 1e3 { ("kHz", 1e-3) } else { (shown, factor) }
}

/// Words of the library's with every number in the panels' units; `unit` is that of the field they are about.
fn in_panel_units(text: &str, unit: Unit) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        out.push_str(&rest[..start]);
        let (low, after) = split_number(&rest[start..]);
        let (high, after) = match after.strip_prefix(" to ").map(split_number) {
            Some((Some(high), after)) => (Some(high), after),
            _ => (None, after),
        };
        let known = [unit, METRES, HERTZ].into_iter().filter(|(name, ..)| !name.is_empty());
        let found = known.into_iter().find_map(|unit| Some((unit, strip_unit(after, unit.0)?)));
        let (found, after) = found.unwrap_or((PLAIN, after));
        match (low, high) {
            (Some(low), Some(high)) => {
                // One unit for both ends.
                let (shown, factor) = shown_unit(found, high);
                let range = format!("{} to {} {shown}", number(low * factor), number(high * factor));
                out.push_str(range.trim_end());
            }
            (Some(value), None) => out.push_str(&written(value, found)),
            (None, _) => out.push_str(&rest[start..rest.len() - after.len()]),
        }
        rest = after;
    }
    out.push_str(rest);
    out
}

/// The number at the beginning of a text, and what follows it.
fn split_number(text: &str) -> (Option<f64>, &str) {
    let is_numeric = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-' | '+');
    let end = text.find(|c| !is_numeric(c)).unwrap_or(text.len());
    let (digits, after) = text.split_at(end);
    (digits.parse().ok(), after)
}

/// What follows ` unit`, if the text begins with that word.
fn strip_unit<'a>(text: &'a str, unit: &str) -> Option<&'a str> {
    let after = text.strip_prefix(' ')?.strip_prefix(unit)?;
    (!after.starts_with(|c: char| c.is_alphanumeric() || c == '/')).then_some(after)
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::{Plate, PlateSpec, Taper};

    fn fault(preset: &str, change: impl FnOnce(&mut PlateSpec)) -> String {
        let mut spec = slipline_plate::preset(preset).unwrap().spec().clone();
        change(&mut spec);
        sentence(&Plate::new(spec).unwrap_err(), Panel::Plate)
    }

    #[test]
    fn a_fault_names_the_label_and_the_panels_units() {
        let half_width = |value| {
            move |spec: &mut PlateSpec| {
                if let Taper::Exponential { half_width_m, .. } = &mut spec.taper {
                    *half_width_m = value;
                }
            }
        };
        assert_eq!(fault("membrane", |spec| spec.length_m = 11.0), "Length 11000 mm: must be 5 to 10000 mm");
        assert_eq!(fault("membrane", |spec| spec.loss_factor = 0.7), "Loss factor 0.7: must be 0 to 0.5");
        assert!(fault("membrane", half_width(9e9)).starts_with("Half-width 9.000e12 mm: must be "));
        assert!(
            fault("membrane", |spec| spec.span_end_m = 1.0)
                .starts_with("Span to 1000 mm: must be 80.32 to 320 mm")
        );
        let modulus = fault("al-bending", |spec| {
            if let slipline_plate::Model::BendingSupported(bending) = &mut spec.model {
                bending.youngs_modulus_pa = 2e13;
            }
        });
        assert_eq!(modulus, "Young's modulus 20000 GPa: must be 0.000001 to 10000 GPa");
    }

    #[test]
    fn no_fault_of_a_plate_shows_a_name_of_the_file_or_a_bare_metre() {
        for preset in slipline_plate::presets() {
            for factor in [1e-9, 1e-3, 0.1, 3.0, 1e4, 1e300, f64::NAN] {
                let changes: [fn(&mut PlateSpec, f64); 6] = [
                    |spec, f| spec.length_m *= f,
                    |spec, f| spec.full_scale_m *= f,
                    |spec, f| spec.span_start_m *= f,
                    |spec, f| spec.span_end_m *= f,
                    |spec, f| {
                        if let Taper::Exponential { rate_per_m, .. } = &mut spec.taper {
                            *rate_per_m *= f;
                        }
                    },
                    |spec, f| {
                        if let Taper::Exponential { half_width_m, .. } = &mut spec.taper {
                            *half_width_m *= f;
                        }
                    },
                ];
                for change in changes {
                    let mut spec = slipline_plate::preset(preset.name).unwrap().spec().clone();
                    change(&mut spec, factor);
                    if let Err(error) = Plate::new(spec) {
                        let text = sentence(&error, Panel::Plate);
                        assert!(
                            !text.contains('_') && !text.contains(" m ") && !text.ends_with(" m"),
                            "{text}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn numbers_in_words_are_rewritten_and_words_stay() {
        let words = "longer: the peak of 20000 Hz and the tail of 400 Hz take 0.123 m of it; at least 1/16";
        let want = "longer: the peak of 20 kHz and the tail of 400 Hz take 123 mm of it; at least 1/16";
        assert_eq!(in_panel_units(words, METRES), want);
        assert_eq!(
            in_panel_units("21000 to 10000000 Hz (5 % above its low end)", HERTZ),
            "21 to 10000 kHz (5 % above its low end)"
        );
        assert_eq!(
            in_panel_units("at most 28.31234567 1/m", unit_of("taper.rate_per_m")),
            "at most 28.312 1/m"
        );
        assert_eq!(
            in_panel_units("0.1 to 20000 m/s", unit_of("model.wave_speed_m_per_s")),
            "0.1 to 20000 m/s"
        );
    }
}
