//! Measurement files of `calibrate`, and the arguments that describe their sensors.

use super::argument::{self, Typed};
use super::failure::Failure;
use super::output;
use super::source::{bytes_of, text_of};
use clap::Args;
use slipline_instrument::measure::{PLAYED_BYTES_MAX, PlayedSweep};
use slipline_instrument::measured_file::{
    BYTES_MAX, ForeignError, ForeignMetadata, OpenError, Opened, RecordingMetadata, measurement, recorded,
};
use slipline_model::answer::calibrate::FileReadAnswer;
use slipline_plate::Plate;
use slipline_plate::calibrate::{
    FileError, Measurement, SENSOR_MASS, SENSOR_WIDTH, SNR, SNR_DB, SensorBody, SensorKind, band_hz,
};
use slipline_plate::quantity::{Measure, QuantityError, must_be, only, plain};
use slipline_plate::text_table::{Chosen, chosen};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Properties that a file of another program does not state.
#[derive(Debug, Args)]
#[command(next_help_heading = "Sensor")]
pub(super) struct SensorArgument {
    /// Place of the sensor, from the driven end (30mm): one or two with --port, and one for each file of
    /// another program, in their order. One place with --port needs a model of the source.
    #[arg(long = "sensor", value_name = "PLACE", value_parser = argument::place, allow_hyphen_values = true)]
    pub(super) places: Vec<Typed<f64>>,
    /// What the sensor measures: displacement, velocity, acceleration or strain. Universal files state it; with --port the
    /// default is displacement.
    #[arg(long, value_name = "KIND", value_parser = kind)]
    pub(super) kind: Option<SensorKind>,
    #[command(flatten)]
    pub(super) body: BodyArgument,
    /// Signal-to-noise ratio of a file that states no noise, 0 to 140 dB.
    #[arg(long, value_name = "RATIO", value_parser = argument::within(decibel, Measure::Plain("dB"), (SNR.low, SNR.high)), allow_hyphen_values = true, default_value_t = SNR_DB)]
    snr: f64,
    /// The columns of a table by their numbers from 1, where their names are not clear: frequency; level, magnitude,
    /// displacement, velocity, acceleration or strain with an optional phase, or real and imaginary; each with its unit if
    /// need be (frequency=1,level=3:dB,phase=4:rad). Once for all tables, or once for each file of --data.
    #[arg(long = "columns", value_name = "COLUMNS", value_parser = columns, requires = "data")]
    columns: Vec<ChosenColumns>,
    #[command(flatten)]
    recording: RecordingArgument,
}

/// What the sensor weighs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Sensor")]
pub(super) struct BodyArgument {
    /// Mass of a sensor that stands on the plate (50mg), within a fifth: it lessens the motion that it measures. Without it, 0
    /// or that of the file.
    #[arg(long, value_name = "MASS", value_parser = argument::within(argument::mass, Measure::Plain("kg"), (SENSOR_MASS.low, SENSOR_MASS.high)), allow_hyphen_values = true, requires = "sensor_width")]
    sensor_mass: Option<f64>,
    /// Side of the square on which such a sensor stands (4mm).
    #[arg(long, value_name = "WIDTH", value_parser = argument::length(SENSOR_WIDTH), allow_hyphen_values = true, requires = "sensor_mass")]
    sensor_width: Option<f64>,
}

impl BodyArgument {
    /// The body; `None` without a mass.
    pub(super) fn body(&self) -> Result<Option<SensorBody>, Failure> {
        let (mass_kg, width_m) = (self.sensor_mass.unwrap_or(0.0), self.sensor_width.unwrap_or(0.0));
        SensorBody::new(mass_kg, width_m).map_err(Failure::refused)
    }
}

/// The columns of a table.
#[derive(Debug, Clone)]
struct ChosenColumns(Vec<Chosen>);

fn columns(text: &str) -> Result<ChosenColumns, String> {
    chosen(text).map(ChosenColumns)
}

/// Properties that a recording of a sweep does not state.
#[derive(Debug, Args)]
#[command(next_help_heading = "Sensor")]
pub(super) struct RecordingArgument {
    /// The description of the recorded sweep, as written by `slipline sweep`: once for all recordings, or once
    /// for each, in their order. Record with the same gain at both places.
    #[arg(long, value_name = "SWEEP.toml", requires = "data")]
    played: Vec<PathBuf>,
    /// The sensor's channel in a recording, from 1: once for all recordings, or once for each. Without it, the first.
    #[arg(long = "channel", value_name = "N", value_parser = argument::count(1, 65535), allow_hyphen_values = true, requires = "data")]
    channels: Vec<usize>,
}

impl RecordingArgument {
    /// The value for recording `number` of `count`: one value applies to all recordings, or each has its own.
    fn of<'a, T>(name: &str, values: &'a [T], number: usize, count: usize) -> Result<Option<&'a T>, Failure> {
        match values.len() {
            0 => Ok(None),
            1 => Ok(values.first()),
            each if each == count => Ok(values.get(number)),
            other => {
                let allowed = format_args!("1, or {count}: one for each file that it describes");
                Err(Failure::Usage(must_be(format_args!("{other} {name}"), allowed)))
            }
        }
    }

    /// The description of the sweep and the channel of a recording.
    fn sweep(&self, path: &Path, number: usize, count: usize) -> Result<(PlayedSweep, usize), Failure> {
        let played = Self::of("--played", &self.played, number, count)?.ok_or_else(|| {
            Failure::of_file(
                path,
                "a recording: name the description of its sweep with --played, as slipline sweep wrote it",
            )
        })?;
        let text = text_of(played, PLAYED_BYTES_MAX)?;
        let sweep = PlayedSweep::from_toml(&text).map_err(|error| Failure::of_file(played, error))?;
        Ok((sweep, Self::of("--channel", &self.channels, number, count)?.copied().unwrap_or(1)))
    }
}

fn decibel(text: &str) -> Result<f64, QuantityError> {
    plain(text, "dB")
}

/// Parses the name of the sensor's quantity.
pub(super) fn kind(text: &str) -> Result<SensorKind, String> {
    let words = SensorKind::ALL.map(SensorKind::word);
    let found = SensorKind::ALL.into_iter().find(|kind| kind.word() == text.trim());
    found.ok_or_else(|| only(format_args!("one of {}", words.join(", "))))
}

/// Reads the files of the same sensor at several places of a plate; and what was read of those by other programs.
pub(super) fn measurements(
    plate: &Plate,
    files: &[PathBuf],
    sensor: &SensorArgument,
) -> Result<(Vec<Measurement>, Vec<FileReadAnswer>), Failure> {
    let opened = files.iter().enumerate().map(|(at, path)| read(path, sensor, at, files.len()));
    let opened = opened.collect::<Result<Vec<_>, Failure>>()?;
    let recordings = opened.iter().filter(|file| matches!(file, Opened::Recording(_))).count();
    if recordings == 0 && !(sensor.recording.played.is_empty() && sensor.recording.channels.is_empty()) {
        let why = "--played and --channel describe recordings, but no file of --data is a recording";
        return Err(Failure::usage(why));
    }
    let mut places = sensor.places.iter();
    let mut files_read = FilesRead { plate, sensor, recordings: (0, recordings), understood: Vec::new() };
    let measured = files.iter().zip(opened).map(|(path, opened)| {
        let stated = |what: &str| {
            let why = format_args!("{what}: state its sensor's place with --sensor PLACE");
            let place = places.next().ok_or_else(|| Failure::of_file(path, why))?;
            Ok((place.of_sensor(plate)?, sensor.kind))
        };
        files_read.measured(path, opened, stated)
    });
    let mut measured = measured.collect::<Result<Vec<_>, Failure>>()?;
    if let Some(body) = sensor.body.body()? {
        measured = measured.into_iter().map(|it| it.by(Some(body))).collect();
    }
    match places.count() {
        0 => Ok((measured, files_read.understood)),
        more => {
            let given = format_args!("{} --sensor", sensor.places.len());
            let allowed = sensor.places.len() - more;
            let why = "one for each file that does not name its place itself";
            Err(Failure::Usage(must_be(given, format_args!("{allowed}: {why}"))))
        }
    }
}

/// Reads the file of the current through the drive; place and kind of a sensor are irrelevant for it.
pub(super) fn current_of(
    plate: &Plate,
    path: &Path,
    sensor: &SensorArgument,
) -> Result<(Measurement, Vec<FileReadAnswer>), Failure> {
    let opened = read(path, sensor, 0, 1)?;
    let mut files_read = FilesRead { plate, sensor, recordings: (0, 1), understood: Vec::new() };
    let measured = files_read.measured(path, opened, |_| Ok((0.0, Some(SensorKind::Displacement))))?;
    Ok((measured, files_read.understood))
}

/// The files that are read for a plate, with what was understood of those by other programs.
struct FilesRead<'a> {
    plate: &'a Plate,
    sensor: &'a SensorArgument,
    /// How many recordings have been read, and how many there are.
    recordings: (usize, usize),
    understood: Vec<FileReadAnswer>,
}

impl FilesRead<'_> {
    /// The measurement of an opened file. `stated` returns the place and the kind of the sensor of a file that names no place;
    /// it is called with a noun for such a file. What is read of it is printed to stderr before it is used.
    fn measured(
        &mut self,
        path: &Path,
        opened: Opened,
        stated: impl FnOnce(&str) -> Result<(f64, Option<SensorKind>), Failure>,
    ) -> Result<Measurement, Failure> {
        let note = |note: &dyn Display| output::note(format_args!("slipline: {}: {note}", path.display()));
        match opened {
            Opened::Own(measurement) => Ok(measurement),
            Opened::Foreign(foreign) => {
                let read = foreign.read(band_hz(self.plate));
                note(&read);
                self.understood.push(FileReadAnswer { file: path.display().to_string(), read });
                let (place_m, kind) = stated("by another program")?;
                let stated =
                    ForeignMetadata { place_m, kind: kind.or(foreign.sensor), snr_db: self.sensor.snr };
                measurement(self.plate, &foreign, &stated).map_err(|error| untold(path, &error))
            }
            Opened::Recording(wav) => {
                let (number, count) = self.recordings;
                self.recordings.0 += 1;
                let (sweep, channel) = self.sensor.recording.sweep(path, number, count)?;
                let (place_m, kind) = stated("a recording")?;
                let (measurement, notes) =
                    recorded(self.plate, &wav, &sweep, &RecordingMetadata { place_m, kind, channel })
                        .map_err(|error| untold(path, &error))?;
                notes.iter().for_each(|it| note(it));
                Ok(measurement)
            }
        }
    }
}

/// Opens file `number` of `count`.
fn read(path: &Path, sensor: &SensorArgument, number: usize, count: usize) -> Result<Opened, Failure> {
    let columns = RecordingArgument::of("--columns", &sensor.columns, number, count)?;
    let columns = columns.map_or(&[][..], |columns| &columns.0);
    Opened::read(bytes_of(path, BYTES_MAX)?, columns).map_err(|error| {
        let OpenError::File(FileError::Columns(unclear)) = error else {
            return Failure::of_file(path, error);
        };
        let how = "say what they are with --columns, such as --columns frequency=1,level=2:dB,phase=3:deg";
        Failure::of_file(path, format_args!("{unclear}: {how}"))
    })
}

fn untold(path: &Path, error: &ForeignError) -> Failure {
    if matches!(error, ForeignError::Kind) {
        let how = "add --kind (displacement, velocity, acceleration or strain)";
        return Failure::of_file(path, format_args!("it does not state what its sensor measures: {how}"));
    }
    Failure::of_file(path, error)
}
