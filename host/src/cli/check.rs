//! `slipline check`.

use super::{CheckArguments, Failure, argument, output, progress};
use serde_json::{Value, json};
use slipline_plate::check::{Checker, Colour, Conditions, Report};

/// The JSON of a report: its lights and the worst colour.
pub(super) fn value(report: &Report) -> Value {
    let mut value = json!(report);
    value["worst"] = json!(report.worst());
    value
}

pub(super) fn run(arguments: &CheckArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate(&arguments.plate.plate)?;
    arguments.gone.refuse("--felt-edge of drive, simulate and record")?;
    let turning_point_m = arguments.turning_point.as_ref();
    let turning_point_m =
        turning_point_m.map(|place| place.turning_point_on(&plate, "--turning-point")).transpose()?;
    let conditions =
        Conditions { level: arguments.level, off_centre: arguments.off_centre, ..Conditions::default() };
    let report = progress::watched("check", |progress| {
        let checker = Checker::watched(&plate, conditions, &mut progress.part(0.0, 0.2))?;
        match turning_point_m {
            Some(turning_point_m) => checker.at(turning_point_m),
            None => checker.over_span_watched(&mut progress.part(0.2, 1.0)),
        }
    })
    .map_err(Failure::refused)?;
    output::print(as_json, &value(&report), |out| {
        if let Some(known) = report.known() {
            writeln!(out, "By its calibration {known} (95 %).")?;
        }
        for light in &report.lights {
            writeln!(out, "{:<9}  {:<16}  {}", light.colour.name(), light.name, light.sentence)?;
        }
        Ok(())
    })?;
    match report.lights.iter().filter(|light| light.colour == Colour::Red).count() {
        0 => Ok(()),
        1 => Err(Failure::Red(format!("1 of {} lights is red", report.lights.len()))),
        red => Err(Failure::Red(format!("{red} of {} lights are red", report.lights.len()))),
    }
}
