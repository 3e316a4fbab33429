//! `slipline trim`.

use super::argument::{self, PlateArgument};
use super::destination::{Destination, ForceArgument};
use super::device::ArmingArgument;
use super::failure::Failure;
use super::measured_file::{BodyArgument, kind};
use super::measuring::{BandArgument, ByDevice, Measurer};
use super::output;
use super::rig::PortArgument;
use super::schema::with_files;
use crate::signals::{self, Signal};
use argument::Typed;
use clap::Args;
use serde_json::json;
use slipline_instrument::measure::Sensor;
use slipline_instrument::native::{TRIM_S, Trimming};
use slipline_instrument::rig::RigOptions;
use slipline_plate::Plate;
use slipline_plate::calibrate::{SensorKind, SpeedTrim, Trimmed};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{show_length, show_place};
use std::path::PathBuf;

/// `trim`.
#[derive(Debug, Args)]
pub struct TrimArguments {
    #[command(flatten)]
    port: PortArgument,
    #[command(flatten)]
    plate: PlateArgument,
    /// Place of the sensor, from the driven end (30mm).
    #[arg(long, value_name = "PLACE", value_parser = argument::place, allow_hyphen_values = true)]
    sensor: Typed<f64>,
    /// What the sensor measures: displacement, velocity, acceleration or strain.
    #[arg(long, value_name = "KIND", value_parser = kind, default_value = "displacement")]
    kind: SensorKind,
    #[command(flatten)]
    body: BodyArgument,
    #[command(flatten)]
    band: BandArgument,
    /// Largest sum of all tones, over full scale, 0.001 to 1.
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true, default_value = "0.5")]
    level: f64,
    /// Repeat with one comb of tones for this time, up to 24h, print the wave speed each time, and write it to --out; Ctrl-C
    /// ends it before.
    #[arg(long = "for", alias = "watch", value_name = "TIME", value_parser = argument::seconds(TRIM_S.low, TRIM_S.high), allow_hyphen_values = true)]
    watch: Option<f64>,
    /// Write the plate file with the last wave speed.
    #[arg(long, value_name = "TRIMMED.toml", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
    #[command(flatten)]
    arming: ArmingArgument,
}

pub(super) fn run(arguments: &TrimArguments, as_json: bool) -> Result<(), Failure> {
    let plate = arguments.plate.read()?;
    let place_m = arguments.sensor.of_sensor(&plate)?;
    SpeedTrim::check(&plate).map_err(Failure::failed)?;
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let body = arguments.body.body()?;
    let options = RigOptions { place_m, sensor: arguments.kind, body, ..RigOptions::default() };
    let rig = arguments.port.rig_with_sensor(&plate, &options)?;
    let request = arguments.band.request(Some(arguments.level), None);
    let by = ByDevice { port: &arguments.port, request, arming: &arguments.arming };
    let device = by.connect(rig.as_ref())?;
    let measurer = Measurer::new(&device, &plate, &request)?;
    let sensor = Sensor { place_m, kind: arguments.kind, input: 0, body };
    let first = measurer.measure(sensor)?.measurement;
    let mut trim = Trimming::begin(&plate, &first).map_err(Failure::failed)?;
    let save = |plate: &Plate| out.iter().try_for_each(|out| out.write_measured(&plate.to_toml()));
    // Standard output takes the last plate only.
    let is_kept = out.as_ref().is_some_and(Destination::is_standard_output);
    let save_now = |plate: &Plate| if is_kept { Ok(()) } else { save(plate) };
    let closing = signals::end_by(device.stopper());
    save_now(&trim.last().plate)?;
    let short = measurer.short();
    while trim.goes_on(arguments.watch) {
        let measured = match short.measure(sensor) {
            // Stopped by the signal: what was found before stands.
            Err(_) if signals::ended_by().is_some() => break,
            measured => measured?,
        };
        let (after_s, now) = trim.add(&measured.measurement).map_err(Failure::failed)?;
        if !as_json {
            output::note(format_args!("after {} s: {}", with_decimals(after_s, 1), interval(now)));
        }
        save_now(&now.plate)?;
        if signals::ended_by().is_some() {
            break;
        }
    }
    let ended_by = signals::ended_by();
    if ended_by.is_some() {
        device.disarm()?;
    }
    drop(closing);
    let last = trim.last();
    if is_kept {
        save(&last.plate)?;
    }
    let answer =
        trim.answer(&plate, place_m, ended_by.map_or("time", Signal::name)).map_err(Failure::refused)?;
    let moved_m = answer.turning_point_error_m;
    let value = with_files(json!(answer), Destination::names(&out));
    output::print(as_json, &value, |writer| {
        output::lines(writer, &lines(&plate, place_m, &trim, last, moved_m, out.as_ref()))
    })
}

fn interval(trimmed: &Trimmed) -> String {
    let [share, low, high] = [trimmed.share, trimmed.low, trimmed.high].map(|it| with_decimals(it, 5));
    format!("{share} times the file's ({low} to {high})")
}

/// How well one speed explains the phases.
fn fit(trimmed: &Trimmed) -> String {
    let times = with_decimals(trimmed.chi2_per_n.sqrt(), 2);
    format!(
        "phases {times} times their noise from this speed (RMS): about 1 where nothing but the speed has changed"
    )
}

fn lines(
    plate: &Plate,
    place_m: f64,
    trim: &Trimming,
    last: &Trimmed,
    moved_m: f64,
    out: Option<&Destination>,
) -> Vec<(&'static str, String)> {
    let mut lines = vec![
        ("Plate", plate.name().to_owned()),
        ("Sensor", show_place(place_m)),
        ("Wave speed", interval(last)),
        ("Fit", fit(last)),
        ("By the file", format!("turning points are up to {} off over the span", show_length(moved_m))),
    ];
    lines.extend(trim.caution().map(|sentence| ("Note", sentence)));
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}
