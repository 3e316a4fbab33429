//! Files of measurements, and what their sensors are: for `calibrate`.

use super::Failure;
use super::argument::{self, Typed};
use clap::Args;
use slipline_model::atomic_file::{read_bytes, said};
use slipline_model::measured_file::{BYTES_MAX, Told, Untold, measurement};
use slipline_plate::Plate;
use slipline_plate::calibrate::{File, Foreign, Measurement, SNR, SNR_DB, SensorKind};
use slipline_plate::quantity::{Measure, QuantityError, Range, must_be, only, plain};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// What a file of another program does not tell.
#[derive(Debug, Args)]
pub(super) struct SensorArgument {
    /// Where the sensor stands or stood, from the driven end (30mm): twice or once with --port, and once for each file of another
    /// program, in their order. Once with --port calibrates by one place, and needs a model of the source.
    #[arg(long = "sensor", value_name = "PLACE", value_parser = argument::place, allow_hyphen_values = true)]
    pub(super) places: Vec<Typed<f64>>,
    /// What the sensor shows: displacement, velocity, acceleration or strain. Universal files tell it; with --port it is
    /// displacement unless told.
    #[arg(long, value_name = "KIND", value_parser = kind)]
    pub(super) kind: Option<SensorKind>,
    /// Signal over noise of a file that has no noise, 0 to 140 dB.
    #[arg(long, value_name = "RATIO", value_parser = argument::within(decibel, Measure::Plain("dB"), (SNR.low, SNR.high)), allow_hyphen_values = true, default_value_t = SNR_DB)]
    snr: f64,
}

fn decibel(text: &str) -> Result<f64, QuantityError> {
    plain(text, "dB")
}

/// The word for what a sensor shows.
pub(super) fn kind(text: &str) -> Result<SensorKind, String> {
    let words = SensorKind::ALL.map(SensorKind::word);
    let found = SensorKind::ALL.into_iter().find(|kind| kind.word() == text.trim());
    found.ok_or_else(|| only(format_args!("one of {}", words.join(", "))))
}

/// Reads the files of the same sensor at several places of a plate.
pub(super) fn measurements(
    plate: &Plate,
    files: &[PathBuf],
    sensor: &SensorArgument,
) -> Result<Vec<Measurement>, Failure> {
    let mut places = sensor.places.iter();
    let read = files.iter().map(|path| match read(path)? {
        File::Own(measurement) => Ok(measurement),
        File::Foreign(foreign) => {
            let place = places.next().ok_or_else(|| {
                let why = "by another program: tell where its sensor stood with --sensor PLACE";
                refused(path, why)
            })?;
            told(plate, &foreign, place, sensor, path)
        }
    });
    let read = read.collect::<Result<Vec<_>, Failure>>()?;
    match places.count() {
        0 => Ok(read),
        more => {
            let given = format_args!("{} --sensor", sensor.places.len());
            let allowed = sensor.places.len() - more;
            let why = "one for each file that does not name its place itself";
            Err(Failure::Usage(must_be(given, format_args!("{allowed}: {why}"))))
        }
    }
}

/// Reads the file of the current through the drive: its place and its kind do not count.
pub(super) fn current_of(
    plate: &Plate,
    path: &Path,
    sensor: &SensorArgument,
) -> Result<Measurement, Failure> {
    match read(path)? {
        File::Own(measurement) => Ok(measurement),
        File::Foreign(foreign) => {
            let told = Told { place_m: 0.0, kind: Some(SensorKind::Displacement), snr_db: sensor.snr };
            measurement(plate, &foreign, &told).map_err(|error| refused(path, error))
        }
    }
}

fn refused(path: &Path, why: impl Display) -> Failure {
    Failure::Usage(format!("{}: {why}", path.display()))
}

fn read(path: &Path) -> Result<File, Failure> {
    let bytes = read_bytes(path, BYTES_MAX).map_err(|error| refused(path, said(&error)))?;
    File::read(&bytes).map_err(|error| refused(path, error))
}

/// The measurement of a foreign file with what was told of it.
fn told(
    plate: &Plate,
    foreign: &Foreign,
    place: &Typed<f64>,
    sensor: &SensorArgument,
    path: &Path,
) -> Result<Measurement, Failure> {
    let on_plate = Range::new(0.0, plate.length_m(), "m");
    let place_m = place.within("--sensor", on_plate, Measure::Length, ", on the plate")?;
    let told = Told { place_m, kind: sensor.kind.or(foreign.sensor), snr_db: sensor.snr };
    measurement(plate, foreign, &told).map_err(|error| match error {
        Untold::Kind => refused(
            path,
            "it does not tell what its sensor shows: write --kind acceleration, or whichever it is",
        ),
        Untold::Place(_) | Untold::Band { .. } | Untold::Data(_) => refused(path, error),
    })
}
