//! `slipline sweep`.

use super::argument::{self, PlateArgument};
use super::destination::{Destination, ForceArgument};
use super::device::{ArmingArgument, Device, LoadedDevice, run};
use super::failure::Failure;
use super::measuring::FrequenciesArgument;
use super::output;
use super::rig::PortArgument;
use clap::Args;
use serde_json::{Value, json};
use slipline_instrument::measure::{PlayedSweep, Playing, QUIETER, SWEEP_S};
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
    output::print(as_json, &value(&plate, &played, &out), |writer| {
        output::lines(writer, &lines(plate.name(), &played, &out))
    })
}

fn value(plate: &slipline_plate::Plate, played: &PlayedSweep, out: &Destination) -> Value {
    let chirp = played.chirp();
    json!({
        "plate": plate.name(),
        "sample_rate_hz": chirp.rate_hz,
        "first_hz": chirp.ends_hz.0,
        "last_hz": chirp.ends_hz.1,
        "levels": [played.level(), QUIETER * played.level()],
        "sweep_s": chirp.samples as f64 / chirp.rate_hz,
        "apart_s": played.apart_s(),
        "played_s": played.seconds(),
        "files": Destination::names([out]),
    })
}

fn lines(plate: &str, played: &PlayedSweep, out: &Destination) -> Vec<(&'static str, String)> {
    let chirp = played.chirp();
    let (first, last) = chirp.ends_hz;
    let seconds = |value: f64| format!("{} s", with_decimals(value, 2));
    vec![
        ("Plate", plate.to_owned()),
        (
            "Sweep",
            format!(
                "{} to {} in {}, twice",
                show_frequency(first),
                show_frequency(last),
                seconds(chirp.samples as f64 / chirp.rate_hz)
            ),
        ),
        (
            "Levels",
            format!(
                "{} and {}",
                with_decimals(played.level(), 3),
                with_decimals(QUIETER * played.level(), 3)
            ),
        ),
        ("Apart", seconds(played.apart_s())),
        ("Written to", out.path().display().to_string()),
    ]
}
