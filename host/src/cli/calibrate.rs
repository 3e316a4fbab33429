//! `slipline calibrate`.

use super::destination::Destination;
use super::measured_file::{SensorArgument, measurements};
use super::{Failure, ForceArgument, PlateArgument, argument, output, progress};
use argument::TouchArgument;
use clap::Args;
use serde_json::{Value, json};
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_plate::calibrate::{
    CalibrateError, Calipers, Departure, Measurement, Parameter, Priors, Touch, departure, from_ratio,
    from_touches,
};
use slipline_plate::feeling::Feeling;
use slipline_plate::number_format::{significant, with_decimals};
use slipline_plate::quantity::{Measure, Range, must_be, show_length};
use slipline_plate::{Plate, limits};
use std::io::Write;
use std::path::PathBuf;

/// How well a fingertip meets a mark, metres.
const TOUCH_TOLERANCE: Range = Range::new(1e-5, 0.05, "m");
/// Standard deviation of what calipers say, metres.
const CALIPERS_TOLERANCE: Range = Range::new(1e-7, 0.01, "m");

/// `calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArguments {
    #[command(flatten)]
    plate: PlateArgument,
    #[command(flatten)]
    measured: MeasuredArgument,
    #[command(flatten)]
    sensor: SensorArgument,
    /// The level at which the touched tones were played, 0 to 1.
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true, default_value = "0.8")]
    level: f64,
    /// How far a felt edge may be from where it was told, one standard deviation, 10um to 50mm.
    #[arg(long, value_name = "LENGTH", value_parser = argument::length(TOUCH_TOLERANCE), allow_hyphen_values = true, default_value = "2mm")]
    touch_tolerance: f64,
    #[command(flatten)]
    calipers: CalipersArgument,
    /// Write the plate file with the measured numbers, their intervals and the measured gain.
    #[arg(long, value_name = "FITTED.toml")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// What was measured; one of these.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct MeasuredArgument {
    /// What the same sensor measured at one place; name two files, of two places. A CSV file of PLATES.md tells all; of
    /// other programs REW's text, .frd, any table of frequency and level, and universal files (58) are read.
    #[arg(long, value_name = "FILE")]
    data: Vec<PathBuf>,
    /// Without a sensor: the boundary that was asked for (or its frequency), and where the finger felt the edge
    /// (120mm:118mm); name at least two, far apart. This gives places and no levels.
    #[arg(long = "touch", value_name = "X:EDGE", value_parser = argument::touch, allow_hyphen_values = true)]
    touches: Vec<TouchArgument>,
}

/// The plate's widths and length by calipers and a rule: all three or none.
#[derive(Debug, Args)]
struct CalipersArgument {
    /// Half of the width at the driven end, by calipers.
    #[arg(long, value_name = "W0", value_parser = argument::length(limits::HALF_WIDTH), allow_hyphen_values = true, requires = "end_half_width", requires = "length")]
    half_width: Option<f64>,
    /// Half of the width at the narrow end, by calipers.
    #[arg(long, value_name = "WL", value_parser = argument::length(limits::HALF_WIDTH), allow_hyphen_values = true, requires = "half_width", requires = "length")]
    end_half_width: Option<f64>,
    /// From the driven to the narrow end, by a rule.
    #[arg(long, value_name = "L", value_parser = argument::length(limits::LENGTH), allow_hyphen_values = true, requires = "half_width", requires = "end_half_width")]
    length: Option<f64>,
    /// How well the calipers know both half-widths, one standard deviation, 100nm to 10mm.
    #[arg(long, value_name = "LENGTH", value_parser = argument::length(CALIPERS_TOLERANCE), allow_hyphen_values = true, default_value = "50um")]
    calipers_tolerance: f64,
}

impl CalipersArgument {
    /// The plate with what was measured on it, and how well its numbers are known.
    fn applied_to(&self, plate: Plate) -> Result<(Plate, Priors), Failure> {
        let (Some(half_width_m), Some(end_half_width_m), Some(length_m)) =
            (self.half_width, self.end_half_width, self.length)
        else {
            return Ok((plate, Priors::default()));
        };
        let tolerance_m = self.calipers_tolerance;
        let calipers = Calipers { half_width_m, end_half_width_m, length_m, tolerance_m };
        calipers.applied_to(&plate).map_err(|error| Failure::Usage(format!("by calipers: {error}")))
    }
}

/// A calibrated plate, and what is told of it.
struct Found {
    plate: Plate,
    parameters: Vec<Parameter>,
    chi2_per_n: f64,
    /// Half of the 95 % interval of the boundary, metres, and what a misplaced sensor does to it per metre.
    boundary: Option<(f64, Vec<f64>)>,
    /// Half of the 95 % interval of the level, dB; nothing where no levels were measured.
    level_tolerance_db: Option<f64>,
}

pub(super) fn run(arguments: &CalibrateArguments, as_json: bool) -> Result<(), Failure> {
    let file = argument::plate(&arguments.plate.plate)?;
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let (nominal, priors) = arguments.calipers.applied_to(file.clone())?;
    let found = match &arguments.measured.touches[..] {
        [] => from_files(&nominal, arguments, &priors)?,
        touches => touched(&nominal, touches, arguments, &priors)?,
    };
    finish(&file, found, out.as_ref(), as_json)
}

/// Tells what was found, and writes the plate file. What was refused ends the command with 1 and the reason.
fn finish(
    file: &Plate,
    found: Result<Found, CalibrateError>,
    out: Option<&Destination>,
    as_json: bool,
) -> Result<(), Failure> {
    let found = match found {
        Ok(found) => found,
        Err(error) => {
            if as_json {
                output::print(true, &refused(file, &error), |_| Ok(()))?;
            }
            return Err(Failure::failed(error));
        }
    };
    let before = departure(file, &found.plate, f64::from(SAMPLE_RATE_HZ)).map_err(Failure::usage)?;
    if let Some(out) = out {
        let text = found.plate.to_toml();
        out.write(|writer| Ok(writer.write_all(text.as_bytes())?))?;
    }
    output::print(as_json, &value(file, &found, &before), |writer| {
        output::lines(writer, &lines(file, &found, &before, out))
    })
}

/// The calibration by two files of the same sensor at two places.
fn from_files(
    nominal: &Plate,
    arguments: &CalibrateArguments,
    priors: &Priors,
) -> Result<Result<Found, CalibrateError>, Failure> {
    let data = &arguments.measured.data;
    if data.len() != 2 {
        let given = format_args!("{} files of --data", data.len());
        return Err(Failure::Usage(must_be(given, "2, of the same sensor at two places")));
    }
    let sensors = measurements(nominal, data, &arguments.sensor)?;
    let [near, far] = &sensors[..] else { return Err(Failure::Usage("two files are needed".to_owned())) };
    Ok(by_ratio(nominal, [near, far], priors))
}

/// The calibration by the ratio of two places.
fn by_ratio(nominal: &Plate, sensors: [&Measurement; 2], priors: &Priors) -> Result<Found, CalibrateError> {
    let found = from_ratio(nominal, sensors, priors)?;
    Ok(Found {
        plate: found.plate,
        parameters: found.parameters,
        chi2_per_n: found.chi2_per_n,
        boundary: Some((found.boundary_tolerance_m, found.boundary_per_place)),
        level_tolerance_db: Some(found.level_tolerance_db).filter(|db| db.is_finite()),
    })
}

/// The calibration by felt edges.
fn touched(
    nominal: &Plate,
    touches: &[TouchArgument],
    arguments: &CalibrateArguments,
    priors: &Priors,
) -> Result<Result<Found, CalibrateError>, Failure> {
    let (table, _) = progress::table_for(nominal, SAMPLE_RATE_HZ)?;
    let touch = |touch: &TouchArgument| {
        let boundary_m = touch.boundary.on(nominal, "--touch")?;
        let on_plate = Range::new(0.0, nominal.length_m(), "m");
        Ok(Touch {
            mark_m: touch.edge.within("--touch", on_plate, Measure::Length, ", on the plate")?,
            tolerance_m: arguments.touch_tolerance,
            frequency_hz: table.frequency_hz(boundary_m),
        })
    };
    let touches = touches.iter().map(touch).collect::<Result<Vec<_>, Failure>>()?;
    let peak_m = arguments.level * table.peak_at_full_scale_m;
    let found = from_touches(nominal, &touches, peak_m, &Feeling::default(), priors);
    Ok(found.map(|found| Found {
        plate: found.plate,
        parameters: found.parameters,
        chi2_per_n: found.chi2_per_n,
        boundary: None,
        level_tolerance_db: None,
    }))
}

/// What a program is told of a calibration that was refused.
fn refused(file: &Plate, error: &CalibrateError) -> Value {
    let chi2_per_n = match error {
        CalibrateError::Unlike { chi2_per_n, .. } | CalibrateError::EdgesUnlike { chi2_per_n, .. } => {
            Some(*chi2_per_n)
        }
        _ => None,
    };
    json!({
        "plate": file.name(),
        "accepted": false,
        "reason": error.to_string(),
        "chi2_per_n": chi2_per_n,
        "parameters": [],
    })
}

fn value(file: &Plate, found: &Found, before: &Departure) -> Value {
    json!({
        "plate": file.name(),
        "accepted": true,
        "parameters": found.parameters.iter().map(|it| json!({
            "name": it.name,
            "value": it.value,
            "low": it.low,
            "high": it.high,
        })).collect::<Vec<_>>(),
        "chi2_per_n": found.chi2_per_n,
        "boundary_tolerance_m": found.boundary.as_ref().map(|it| it.0),
        "boundary_per_place": found.boundary.as_ref().map(|it| &it.1),
        "level_tolerance_db": found.level_tolerance_db,
        "before": {
            "boundary_error_m": before.boundary_m,
            "level_error_db": found.level_tolerance_db.map(|_| before.level_db),
        },
    })
}

fn lines<'a>(
    file: &Plate,
    found: &'a Found,
    before: &Departure,
    out: Option<&Destination>,
) -> Vec<(&'a str, String)> {
    let number = |value: f64| significant(value, 5);
    let mut lines = vec![("Plate", file.name().to_owned())];
    for it in &found.parameters {
        let interval = format!("{} ({} to {})", number(it.value), number(it.low), number(it.high));
        lines.push((it.name, interval));
    }
    lines.push(("chi^2 per answer", with_decimals(found.chi2_per_n, 2)));
    let decibel = |db: f64| format!("{} dB", with_decimals(db, 1));
    let level = found.level_tolerance_db;
    let was = level
        .map_or(String::new(), |_| format!(", the level up to {} high or low", decibel(before.level_db)));
    let boundary_m = show_length(before.boundary_m);
    lines.push(("Before", format!("the boundary is up to {boundary_m} off over the span{was}")));
    let is = level.map_or(String::new(), |db| format!(", the level to {}", decibel(db)));
    match &found.boundary {
        Some((boundary_m, per_place)) => {
            lines
                .push(("After", format!("the boundary is known to {}{is} (95 %)", show_length(*boundary_m))));
            let ways: Vec<String> = per_place.iter().map(|share| show_length(1e-3 * share.abs())).collect();
            let told = match &ways[..] {
                [near, far] => format!("moves the boundary by {near} (the first) or {far} (the second)"),
                ways => format!("moves the boundary by {}", ways.join(", ")),
            };
            lines.push(("A sensor 1 mm off", told));
        }
        None => lines.push(("Levels", "not measured: those of the file stay".to_owned())),
    }
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}
