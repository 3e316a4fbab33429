//! `slipline measure`.

use super::destination::Destination;
use super::device::Device;
use super::measured_file::kind;
use super::measuring::{BandArgument, Bench, place_on};
use super::{ArmingArgument, Failure, ForceArgument, PlateArgument, PortArgument, argument, output};
use argument::Typed;
use clap::Args;
use serde_json::{Value, json};
use slipline_model::measure::{Measured, Sensor};
use slipline_model::rig::RigOptions;
use slipline_plate::Plate;
use slipline_plate::calibrate::{Measurement, SensorKind};
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity::{must_be, show_frequency, show_place};
use std::io::Write;
use std::path::{Path, PathBuf};

/// `measure`.
#[derive(Debug, Args)]
pub struct MeasureArguments {
    #[command(flatten)]
    port: PortArgument,
    #[command(flatten)]
    plate: PlateArgument,
    /// Where the sensor stands, from the driven end (30mm).
    #[arg(long, value_name = "PLACE", value_parser = argument::place, allow_hyphen_values = true)]
    sensor: Typed<f64>,
    /// What the sensor shows: displacement, velocity, acceleration or strain.
    #[arg(long, value_name = "KIND", value_parser = kind, default_value = "displacement")]
    kind: SensorKind,
    #[command(flatten)]
    band: BandArgument,
    /// What all tones together may be of full scale, 0.001 to 1.
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true, default_value = "0.5")]
    level: f64,
    /// Write the measurement: as CSV (.csv), universal file (.uff, .unv) or .frd.
    #[arg(long, value_name = "FILE", value_parser = measurement_file)]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
    #[command(flatten)]
    arming: ArmingArgument,
}

/// How a measurement is written as text.
type Form = fn(&Measurement) -> String;

/// The forms of a measurement's file, by the ending of its name.
const ENDINGS: [(&str, Form); 4] = [
    ("csv", Measurement::to_csv),
    ("uff", Measurement::to_uff58),
    ("unv", Measurement::to_uff58),
    ("frd", Measurement::to_frd),
];

fn form(path: &Path) -> Option<Form> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    ENDINGS.iter().find(|(name, _)| *name == ending).map(|(_, form)| *form)
}

fn measurement_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match form(&path) {
        Some(_) => Ok(path),
        None => Err(must_be("its ending", ".csv, .uff, .unv or .frd")),
    }
}

pub(super) fn run(arguments: &MeasureArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate(&arguments.plate.plate)?;
    let place_m = place_on(&plate, &arguments.sensor)?;
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let options = RigOptions { place_m, sensor: arguments.kind, ..RigOptions::default() };
    let rig = arguments.port.rig_with_sensor(&plate, &options)?;
    let device = Device::connect(&arguments.port.port, rig.as_ref())?;
    device.may_be_armed(&arguments.arming)?;
    let bench = Bench::new(&device, &plate, &arguments.band, Some(arguments.level))?;
    let measured = bench.measure(Sensor { place_m, kind: arguments.kind, input: 0 })?;
    if let Some(out) = &out {
        let text = form(out.path()).unwrap_or(Measurement::to_csv)(&measured.measurement);
        out.write(|writer| Ok(writer.write_all(text.as_bytes())?))?;
    }
    output::print(as_json, &value(&plate, &measured), |writer| {
        output::lines(writer, &lines(&plate, &measured, out.as_ref()))
    })
}

fn value(plate: &Plate, measured: &Measured) -> Value {
    let measurement = &measured.measurement;
    let points = || measurement.points.iter();
    json!({
        "plate": plate.name(),
        "place_m": measurement.place_m,
        "sensor": measurement.sensor.word(),
        "sample_rate_hz": measurement.sample_rate_hz,
        "frequency_hz": points().map(|it| it.frequency_hz).collect::<Vec<_>>(),
        "response": points().map(|it| json!({ "re": it.response.re, "im": it.response.im })).collect::<Vec<_>>(),
        "noise": points().map(|it| it.noise).collect::<Vec<_>>(),
        "headroom_db": points().map(|it| it.headroom_db).collect::<Vec<_>>(),
        "least_headroom_db": measured.headroom_db,
        "headroom_light": measured.light().name(),
        "noise_codes": measured.noise_codes,
        "warnings": warnings(measured),
    })
}

/// What is to be told of a measurement, in sentences.
pub(super) fn warnings(measured: &Measured) -> Vec<String> {
    measured.warnings.iter().map(slipline_model::measure::Warning::sentence).collect()
}

fn lines(plate: &Plate, measured: &Measured, out: Option<&Destination>) -> Vec<(&'static str, String)> {
    let measurement = &measured.measurement;
    let points = &measurement.points;
    let hertz = |point: Option<&slipline_plate::calibrate::MeasuredPoint>| {
        point.map_or_else(String::new, |point| show_frequency(point.frequency_hz))
    };
    let above_db = points.iter().map(|it| 20.0 * (it.response.norm() / it.noise).log10());
    let mut above_db: Vec<f64> = above_db.collect();
    above_db.sort_by(f64::total_cmp);
    let middle_db = above_db.get(above_db.len() / 2).copied().unwrap_or(0.0);
    let decibel = |value: f64| format!("{} dB", with_decimals(value, 1));
    let mut lines = vec![
        ("Plate", plate.name().to_owned()),
        ("Sensor", format!("{} at {}", measurement.sensor.word(), show_place(measurement.place_m))),
        (
            "Frequencies",
            format!("{} from {} to {}", points.len(), hertz(points.first()), hertz(points.last())),
        ),
        ("Answers", format!("{} above the noise in the middle", decibel(middle_db))),
        ("Headroom", format!("{}, {}", decibel(measured.headroom_db), measured.light().name())),
    ];
    lines.extend(warnings(measured).into_iter().map(|sentence| ("Note", sentence)));
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}
