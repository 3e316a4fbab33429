//! Output of `calibrate`: the calibration, or why it was refused.

use super::destination::Destination;
use super::failure::Failure;
use super::output;
use super::schema::with_files;
use serde_json::json;
use slipline_instrument::calibration::named_calibrated;
use slipline_model::answer::calibrate::{CalibrateAnswer, CalibrationReport, FileReadAnswer, Way};
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_plate::Plate;
use slipline_plate::calibrate::{CalibrateError, Departure, Parameter, departure};
use slipline_plate::quantity::number_format::{significant, with_decimals};
use slipline_plate::quantity::{show_length, show_place, show_si};

/// Accuracy of a method on simulated plates: the table of PHYSICS.md, section 9.
const fn reaches(way: Way) -> &'static str {
    match way {
        Way::TwoPlaces | Way::CheckedPlaces => {
            "two places of one sensor: on simulated plates turning points came within 0.2 mm, 0.8 mm at worst, and the level within 0.3 dB"
        }
        Way::OneSensor => {
            "one sensor and a model of the source: on simulated plates turning points came within 0.5 mm, 0.9 mm at worst, and the level within 0.5 dB; two places do not need the model"
        }
        Way::Current => {
            "the current alone: on simulated plates turning points came within 0.5 mm, 1.2 mm at worst; the level is the model's and is not measured"
        }
        Way::Touches => {
            "felt edges alone, of a known drive: on simulated plates the felt edge came within 1.5 mm; the level is not measured"
        }
        Way::TouchesOfUnknownDrive => {
            "felt edges alone, of an unknown drive: on simulated membranes the felt edge came within 4 mm by two touches and 2 mm by six; the drive's current or one sensor gives more, and levels"
        }
    }
}

/// Prints the calibration with what was `understood` of files by other programs, and writes the plate file. A
/// refused calibration ends the command with exit code 1 and the reason.
pub(super) fn finish(
    file: &Plate,
    found: Result<CalibrationReport, CalibrateError>,
    understood: &[FileReadAnswer],
    out: Option<&Destination>,
    feeling_out: Option<&Destination>,
    as_json: bool,
) -> Result<(), Failure> {
    let read = Some(understood);
    let found = match found {
        Ok(found) => found,
        Err(error) => {
            if as_json {
                let answer = CalibrateAnswer { read, ..CalibrateAnswer::refused(file, &error) };
                output::print(true, &with_files(json!(answer), Vec::new()), |_| Ok(()))?;
            }
            return Err(Failure::failed(error));
        }
    };
    let before = departure(file, &found.plate, f64::from(SAMPLE_RATE_HZ)).map_err(Failure::refused)?;
    if let Some(out) = out {
        let text = named_calibrated(&found.plate).to_toml();
        out.write_measured(&text)?;
    }
    let files = Destination::names(out.into_iter().chain(feeling_out));
    let answer = CalibrateAnswer { read, ..CalibrateAnswer::of(file, &found, &before) };
    let value = with_files(json!(answer), files);
    output::print(as_json, &value, |writer| output::lines(writer, &lines(file, &found, &before, out)))
}

/// A parameter and its interval, in the units of a person. What cannot be negative is not: where its interval reaches 0, only
/// its upper end is known.
fn in_words(&Parameter { name, value, low, high }: &Parameter) -> String {
    let shown = |value: f64| with_unit(name, value);
    let is_positive = name.starts_with("drive.") || name == "loss_factor";
    if is_positive && low <= 0.0 {
        return format!("up to {}; {} fits best", shown(high), shown(value.max(0.0)));
    }
    format!("{} ({} to {})", shown(value), shown(low), shown(high))
}

/// A value of the plate file in a suitable unit, by the ending of its name.
fn with_unit(name: &str, value: f64) -> String {
    const UNITS: [(&str, &str, f64); 7] = [
        ("_n_s_per_m", "N s/m", 1.0),
        ("_m_per_s", "m/s", 1.0),
        ("_n_per_m", "N/m", 1.0),
        ("_kg", "g", 1e3),
        ("_pa", "Pa", 1.0),
        ("_hz", "Hz", 1.0),
        ("_s", "s", 1.0),
    ];
    let of_name = UNITS.iter().find(|(ending, ..)| name.ends_with(ending));
    match of_name {
        Some((_, unit, scale)) => show_si(value * scale, unit),
        None if name == "place_m" => show_place(value),
        None if name.ends_with("_per_m") => format!("{} /m", significant(value, 4)),
        None if name.ends_with("_m") => format!("{} mm", significant(1e3 * value, 4)),
        None => significant(value, 4),
    }
}

fn lines<'a>(
    file: &Plate,
    found: &'a CalibrationReport,
    before: &Departure,
    out: Option<&Destination>,
) -> Vec<(&'a str, String)> {
    let mut lines = vec![("Plate", file.name().to_owned()), ("By", reaches(found.way).to_owned())];
    lines.extend(found.parameters.iter().map(|it| (it.name, in_words(it))));
    if found.misfit.is_none() {
        let times = with_decimals(found.chi2_per_n.sqrt(), 2);
        lines.push((
            "Touches",
            format!(
                "{times} times their tolerance from the plate's edges (RMS): up to about 1 where it is right"
            ),
        ));
    }
    lines.extend(found.misfit.iter().map(|(_, note)| ("Model", note.clone())));
    let decibel = |db: f64| format!("{} dB", with_decimals(db, 1));
    let level = found.level_tolerance_db;
    let was = level
        .map_or(String::new(), |_| format!(", the level up to {} high or low", decibel(before.level_db)));
    let off_m = show_length(before.boundary_m);
    lines.push(("Before", format!("turning points are up to {off_m} off over the span{was}")));
    let is = level.map_or(String::new(), |db| format!(", the level to {}", decibel(db)));
    match &found.turning_point {
        Some((known_m, _)) => {
            lines
                .push(("After", format!("turning points are known to {}{is} (95 %)", show_length(*known_m))));
        }
        None => lines.push(("Levels", "not measured".to_owned())),
    }
    let edge = |edge_m: f64| format!("known to {} (95 %)", show_length(edge_m));
    lines.extend(found.edge_tolerance_m.map(|edge_m| ("Felt edge", edge(edge_m))));
    lines.extend(found.caution.iter().map(|sentence| ("Note", sentence.clone())));
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_has_units_few_digits_and_no_negative_mass() {
        for (name, [value, low, high], words) in [
            ("drive.mass_kg", [0.012, 0.01, 0.014], "12.00 g (10.00 g to 14.00 g)"),
            ("drive.mass_kg", [1.234_567_89e-3, -2e-3, 4.5e-3], "up to 4.500 g; 1.235 g fits best"),
            ("drive.stiffness_n_per_m", [-3.0, -9.0, 20.0], "up to 20.00 N/m; 0 N/m fits best"),
            ("drive.resistance_n_s_per_m", [0.5, 0.4, 0.6], "500.0 mN s/m (400.0 mN s/m to 600.0 mN s/m)"),
            ("model.wave_speed_m_per_s", [12.034_567, 12.0, 12.1], "12.03 m/s (12.00 m/s to 12.10 m/s)"),
            ("model.youngs_modulus_pa", [7e10, 6.9e10, 7.1e10], "70.00 GPa (69.00 GPa to 71.00 GPa)"),
            ("taper.rate_per_m", [5.123_456, 5.0, 5.2], "5.123 /m (5 /m to 5.2 /m)"),
            ("taper.half_width_m", [0.060_012_345, 0.06, 0.061], "60.01 mm (60 mm to 61 mm)"),
            ("place_m", [0.034_012_3, 0.0339, 0.0341], "34.0 mm (33.9 mm to 34.1 mm)"),
            ("delay_s", [-1e-6, -3e-6, 1e-6], "-1.000 µs (-3.000 µs to 1.000 µs)"),
            ("loss_factor", [0.01, -0.001, 0.02], "up to 0.02; 0.01 fits best"),
        ] {
            assert_eq!(in_words(&Parameter { name, value, low, high }), words, "{name}");
        }
    }
}
