//! `slipline check`.

use super::argument::{self, PlaceArgument, PlateArgument};
use super::failure::Failure;
use super::tones::GoneArgument;
use super::{output, progress};
use clap::Args;
use serde_json::json;
use slipline_model::answer::check::{CheckAnswer, check};
use slipline_plate::check::{Colour, Conditions};

/// `check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    plate: PlateArgument,
    /// One tone by its turning point (120mm) or its frequency (126Hz); by default, the worst over the span.
    #[arg(long, value_name = "X", value_parser = argument::place_or_frequency, allow_hyphen_values = true)]
    turning_point: Option<PlaceArgument>,
    #[command(flatten)]
    gone: GoneArgument,
    /// The tone's level, 0 to 1.
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true, default_value = "1")]
    level: f64,
    /// Share of full scale within which the DAC's output is linear, 0.1 to 1, as `slipline info` reports it of a board (0.88).
    #[arg(long, value_name = "SHARE", value_parser = argument::level, allow_hyphen_values = true, default_value = "1")]
    linear_share: f64,
    /// The drive acts beside the centre line.
    #[arg(long)]
    off_centre: bool,
}

pub(super) fn run(arguments: &CheckArguments, as_json: bool) -> Result<(), Failure> {
    let plate = arguments.plate.read()?;
    arguments.gone.refuse("--felt-edge of drive, simulate and record")?;
    let turning_point_m = arguments.turning_point.as_ref();
    let turning_point_m =
        turning_point_m.map(|place| place.turning_point_on(&plate, "--turning-point")).transpose()?;
    let &CheckArguments { level, off_centre, linear_share, .. } = arguments;
    let conditions = Conditions { level, off_centre, linear_share, ..Conditions::default() };
    let report = progress::watched("check", |progress| check(&plate, turning_point_m, conditions, progress))
        .map_err(Failure::refused)?;
    output::print(as_json, &json!(CheckAnswer::of(&report)), |out| {
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
