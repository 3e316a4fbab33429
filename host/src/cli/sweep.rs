//! `slipline sweep`.

use super::argument::{self, PlateArgument};
use super::destination::{Destination, ForceArgument};
use super::device::{ArmingArgument, Device, LoadedDevice, run};
use super::failure::Failure;
use super::measuring::FrequenciesArgument;
use super::output;
use super::rig::PortArgument;
use super::schema::with_files;
use clap::Args;
use serde_json::json;
use slipline_instrument::measure::{PlayedSweep, Playing, SWEEP_S};
use slipline_instrument::requests::SweepAnswer;
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::show_frequency;
use std::path::PathBuf;

/// `sweep`.
#[derive(Debug, Args)]
pub struct SweepArguments {
    #[command(flatten)]
    port: PortArgument,
    #[command(flatten)]
    plate: PlateArgument,
    #[command(flatten)]
    frequencies: FrequenciesArgument,
    /// Level of the first sweep, as a share of full scale, 0.001 to 1; the second sweep has half of it.
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true, default_value = "0.5")]
    level: f64,
    /// Duration of one sweep, 10ms to 10s.
    #[arg(long = "for", alias = "time", value_name = "TIME", value_parser = argument::seconds(SWEEP_S.low, SWEEP_S.high), allow_hyphen_values = true, default_value = "4s")]
    time: f64,
    /// Write the description of the sweep, which `calibrate --played` needs with each recording.
    #[arg(long, value_name = "SWEEP.toml", help_heading = "Output")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgument,
    #[command(flatten)]
    arming: ArmingArgument,
}

pub(super) fn run_sweep(arguments: &SweepArguments, as_json: bool) -> Result<(), Failure> {
    let plate = arguments.plate.read()?;
    let out = Destination::new(&arguments.out, arguments.force)?;
    let rig = arguments.port.rig(Some(&plate))?;
    let device = Device::connect(&arguments.port.port()?, rig.as_ref())?;
    device.may_be_armed(&arguments.arming)?;
    let wanted = arguments.frequencies.at(Some(arguments.level)).on(&plate);
    let bench = LoadedDevice::new(&device, &plate)?;
    let sweep = PlayedSweep::new(&plate, &bench.table, &wanted, bench.rate_hz, arguments.time);
    let playing = Playing::new(sweep.map_err(Failure::refused)?, bench.table);
    let played = run(&device, "sweep", playing.map_err(Failure::failed)?)?;
    let text = played.to_toml();
    out.write_measured(&text)?;
    let answer = SweepAnswer::of(&plate, &played);
    let value = with_files(json!(answer), Destination::names([&out]));
    output::print(as_json, &value, |writer| output::lines(writer, &lines(&answer, &out)))
}

fn lines(
    SweepAnswer { plate, first_hz, last_hz, levels, sweep_s, apart_s, .. }: &SweepAnswer<'_>,
    out: &Destination,
) -> Vec<(&'static str, String)> {
    let seconds = |value: f64| format!("{} s", with_decimals(value, 2));
    let (first, last) = (show_frequency(*first_hz), show_frequency(*last_hz));
    let [loud, quiet] = levels.map(|level| with_decimals(level, 3));
    vec![
        ("Plate", (*plate).to_owned()),
        ("Sweep", format!("{first} to {last} in {}, twice", seconds(*sweep_s))),
        ("Levels", format!("{loud} and {quiet}")),
        ("Apart", seconds(*apart_s)),
        ("Written to", out.path().display().to_string()),
    ]
}
