//! `slipline measure`.

use super::argument::{self, PlateArgument};
use super::destination::{Destination, ForceArgument};
use super::device::ArmingArgument;
use super::failure::Failure;
use super::harmonics;
use super::known_drive::KnownDriveArgument;
use super::measured_file::{BodyArgument, kind};
use super::measuring::{BandArgument, ByDevice};
use super::output;
use super::rig::PortArgument;
use argument::Typed;
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use slipline_instrument::measure::{HARMONIC_POINTS, Measured, Sensor, current_sensor};
use slipline_instrument::rig::RigOptions;
use slipline_model::atomic_file::STANDARD_STREAM;
use slipline_plate::Plate;
use slipline_plate::calibrate::{DriveCheck, Measurement, SensorKind};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{decibels, must_be, show_frequency, show_place};
use std::path::{Path, PathBuf};

/// `measure`.
#[derive(Debug, Args)]
pub struct MeasureArguments {
    #[command(flatten)]
    port: PortArgument,
    #[command(flatten)]
    plate: PlateArgument,
    /// The measured input: the sensor at the device's first input, or the current of the drive at its second.
    #[arg(long, value_enum, default_value_t = Input::Sensor)]
    input: Input,
    /// Place of the sensor, from the driven end (30mm).
    #[arg(long, value_name = "PLACE", value_parser = argument::place, allow_hyphen_values = true, required_if_eq("input", "sensor"))]
    sensor: Option<Typed<f64>>,
    /// What the sensor measures: displacement, velocity, acceleration or strain.
    #[arg(long, value_name = "KIND", value_parser = kind, default_value = "displacement")]
    kind: SensorKind,
    #[command(flatten)]
    body: BodyArgument,
    /// Measure the second and third harmonic that the drive adds to tones: at 8 frequencies over the plate's span, or COUNT of them
    /// (2 to 64), and at --level of the table's full scale; --out is the plate file with them (.toml).
    #[arg(long, value_name = "COUNT", num_args = 0..=1, default_missing_value = "8", value_parser = argument::count(HARMONIC_POINTS.low as usize, HARMONIC_POINTS.high as usize), conflicts_with_all = ["sweep", "from", "to", "points"])]
    harmonics: Option<usize>,
    #[command(flatten)]
    band: BandArgument,
    /// Largest sum of all tones, over full scale, 0.001 to 1.
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true, default_value = "0.5")]
    level: f64,
    /// Write the measurement as CSV (.csv), universal file (.uff, .unv) or .frd; - is CSV. With --harmonics, the plate file (.toml).
    #[arg(long, value_name = "FILE", value_parser = measurement_file, help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
    #[command(flatten)]
    known: KnownDriveArgument,
    #[command(flatten)]
    arming: ArmingArgument,
}

/// An input of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Input {
    /// The sensor.
    Sensor,
    /// The current of the drive.
    Current,
}

/// Formats a measurement as text.
type Form = fn(&Measurement) -> String;

/// The formats of a measurement's file, by the extension of its name.
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
        None if is_plate_file(&path) => Ok(path),
        // A stream without an ending gets CSV.
        None if path == Path::new(STANDARD_STREAM) => Ok(path),
        None => Err(must_be("its ending", ".csv, .uff, .unv or .frd; with --harmonics .toml")),
    }
}

/// Whether it is the name of a plate file.
fn is_plate_file(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

impl MeasureArguments {
    /// The ending of --out must be that of what is measured.
    fn check_ending(&self) -> Result<(), Failure> {
        let Some(path) = self.out.as_deref().filter(|path| *path != Path::new(STANDARD_STREAM)) else {
            return Ok(());
        };
        let is_of_harmonics = self.harmonics.is_some();
        let wanted = if is_of_harmonics { ".toml with --harmonics" } else { ".csv, .uff, .unv or .frd" };
        if is_plate_file(path) == is_of_harmonics {
            return Ok(());
        }
        Err(Failure::Usage(must_be(format_args!("--out {}: its ending", path.display()), wanted)))
    }
}

pub(super) fn run(arguments: &MeasureArguments, as_json: bool) -> Result<(), Failure> {
    arguments.check_ending()?;
    if arguments.harmonics.is_some() && arguments.input == Input::Current {
        return Err(Failure::usage(
            "--harmonics are measured by the sensor on the plate, not by --input current",
        ));
    }
    let plate = arguments.plate.read()?;
    let sensor = match (&arguments.sensor, arguments.input) {
        (_, Input::Current) => current_sensor(),
        (Some(place), Input::Sensor) => {
            let body = arguments.body.body()?;
            Sensor { place_m: place.of_sensor(&plate)?, kind: arguments.kind, input: 0, body }
        }
        (None, Input::Sensor) => {
            return Err(Failure::usage("--sensor PLACE is missing: the sensor's place, from the driven end"));
        }
    };
    let out = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let Sensor { place_m, kind, body, .. } = sensor;
    let options = RigOptions { place_m, sensor: kind, body, ..RigOptions::default() };
    let rig = arguments.port.rig_with_sensor(&plate, &options)?;
    let request = arguments.band.request(Some(arguments.level), arguments.known.stated()?);
    let by = ByDevice { port: &arguments.port, request, arming: &arguments.arming };
    if let Some(points) = arguments.harmonics {
        let level = arguments.level;
        let wanted = harmonics::Wanted { plate: &plate, sensor, points, level, out: out.as_ref() };
        return harmonics::run(&wanted, &by, rig.as_ref(), as_json);
    }
    let device = by.connect(rig.as_ref())?;
    let (measurer, drive) = by.measurer(&device, &plate, rig.as_ref())?;
    let measured = measurer.measure(sensor)?;
    let report = Report { plate: &plate, input: arguments.input, drive, measured: &measured };
    if let Some(out) = &out {
        let text = form(out.path()).unwrap_or(Measurement::to_csv)(&measured.measurement);
        out.write_measured(&text)?;
    }
    output::print(as_json, &value(&report, out.as_ref()), |writer| {
        output::lines(writer, &lines(&report, out.as_ref()))?;
        if out.is_none() {
            writeln!(writer)?;
            output::table(writer, &rows(&measured.measurement))?;
        }
        Ok(())
    })
}

/// Most rows of the table, and the width of its plot, in characters.
const ROWS: usize = 24;
const PLOT: usize = 32;
/// Lowest level of the plot, dB below the largest response.
const PLOT_DB: f64 = 48.0;

/// What was found, as a table with a plot of the level beside it; of many frequencies, some over the band.
fn rows(measurement: &Measurement) -> Vec<Vec<String>> {
    let points = &measurement.points;
    let level_db = |response: f64, of: f64| decibels(response / of);
    let largest = points.iter().map(|it| it.response.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let mut rows = vec![["Frequency", "Level", "Phase", "Over noise", ""].map(str::to_owned).to_vec()];
    let count = points.len().min(ROWS);
    let shown = (0..count).filter_map(|i| points.get(i * (points.len() - 1) / (count - 1).max(1)));
    rows.extend(shown.map(|it| {
        let size = it.response.norm();
        let level = level_db(size, largest);
        let share = (1.0 + level / PLOT_DB).clamp(0.0, 1.0);
        let bar = "#".repeat((share * PLOT as f64).round() as usize);
        vec![
            show_frequency(it.frequency_hz),
            format!("{} dB", with_decimals(level, 1)),
            format!("{}°", with_decimals(it.response.arg().to_degrees(), 0)),
            format!("{} dB", with_decimals(level_db(size, it.noise), 1)),
            format!("{bar:<PLOT$}"),
        ]
    }));
    rows
}

/// A measurement and the printed values.
struct Report<'a> {
    plate: &'a Plate,
    input: Input,
    drive: Option<DriveCheck>,
    measured: &'a Measured,
}

fn value(&Report { plate, input, drive, measured }: &Report<'_>, out: Option<&Destination>) -> Value {
    let measurement = &measured.measurement;
    let points = || measurement.points.iter();
    json!({
        "plate": plate.name(),
        "place_m": measurement.place_m,
        // JSON, text: sensor or current
        "input": if input == Input::Current { "current" } else { "sensor" },
        "kind": (input == Input::Sensor).then(|| measurement.sensor.word()),
        "sample_rate_hz": measurement.sample_rate_hz,
        "frequency_hz": points().map(|it| it.frequency_hz).collect::<Vec<_>>(),
        "response": points().map(|it| json!({ "re": it.response.re, "im": it.response.im })).collect::<Vec<_>>(),
        // JSON, unit of `response`: Noise of each answer
        "noise": points().map(|it| it.noise).collect::<Vec<_>>(),
        // JSON: Level of the input below the end of its range; of a chord, above the sum of its tones
        "headroom_db": points().map(|it| it.headroom_db).collect::<Vec<_>>(),
        // JSON: The least headroom of the measurement
        "least_headroom_db": measured.headroom_db,
        // JSON, text: Light of the least headroom: green, amber or red
        "headroom_colour": measured.light().name(),
        // JSON, codes: Noise at the input, in codes
        "noise_codes": measured.noise_codes,
        // JSON, text: Whether the drive is on; null where it was not checked
        "drive": drive.map(|drive| drive.to_string()),
        "warnings": warnings(measured),
        "files": Destination::names(out),
    })
}

/// The warnings of a measurement, as sentences.
pub(super) fn warnings(measured: &Measured) -> Vec<String> {
    measured.warnings.iter().map(slipline_instrument::measure::Warning::sentence).collect()
}

fn lines(
    &Report { plate, input, drive, measured }: &Report<'_>,
    out: Option<&Destination>,
) -> Vec<(&'static str, String)> {
    let measurement = &measured.measurement;
    let points = &measurement.points;
    let hertz = |point: Option<&slipline_plate::calibrate::MeasuredPoint>| {
        point.map_or_else(String::new, |point| show_frequency(point.frequency_hz))
    };
    let above_db = points.iter().map(|it| decibels(it.response.norm() / it.noise));
    let mut above_db: Vec<f64> = above_db.collect();
    above_db.sort_by(f64::total_cmp);
    let middle_db = above_db.get(above_db.len() / 2).copied().unwrap_or(0.0);
    let decibel = |value: f64| format!("{} dB", with_decimals(value, 1));
    let mut lines = vec![
        ("Plate", plate.name().to_owned()),
        match input {
            Input::Sensor => {
                ("Sensor", format!("{} at {}", measurement.sensor.word(), show_place(measurement.place_m)))
            }
            Input::Current => ("Input", "the current of the drive".to_owned()),
        },
        (
            "Frequencies",
            format!("{} from {} to {}", points.len(), hertz(points.first()), hertz(points.last())),
        ),
        ("Answers", format!("{} above the noise in the middle", decibel(middle_db))),
        ("Headroom", format!("{}, {}", decibel(measured.headroom_db), measured.light().name())),
    ];
    lines.extend(drive.map(|drive| ("Drive", drive.to_string())));
    lines.extend(warnings(measured).into_iter().map(|sentence| ("Note", sentence)));
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}
