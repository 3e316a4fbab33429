//! Files of measurements by other programs: what such a file does not tell, and the measurement when a person does.
//!
//! ```text
//! bytes -> Opened -+-> Own: everything is told
//!                  +-> Foreign: frequencies and responses   -- place, kind, noise --------> Measurement
//!                  +-> Recording: a WAV file of the sweep   -- place, kind, channel,
//!                                                              description of the sweep --> Measurement, notes
//! ```

mod recorded;

pub use recorded::{RecordingMetadata, recorded};

use crate::measure::HeardError;
use slipline_model::wav::{Wav, WavError};
use slipline_plate::Plate;
use slipline_plate::calibrate::{
    CalibrateError, File, FileError, Foreign, Measurement, POINTS, SNR_DB, SensorKind, band_hz,
};
use slipline_plate::quantity::{OutOfRange, Range, show_frequency};
use thiserror::Error;

/// Bytes of a file of a measurement, at most: a recording of some minutes, or a universal file of millions of points.
pub const BYTES_MAX: usize = slipline_model::wav::BYTES_MAX;

/// A file of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub enum Opened {
    /// In the own form, which tells everything.
    Own(Measurement),
    /// By another program.
    Foreign(Foreign),
    /// A recording of the sweep.
    Recording(Wav),
}

/// Why a file is no measurement.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OpenError {
    /// No table of frequencies.
    #[error(transparent)]
    File(#[from] FileError),
    /// No recording.
    #[error(transparent)]
    Wav(#[from] WavError),
}

impl Opened {
    /// Reads a measurement in any of the forms, which is told from what is in the file.
    ///
    /// # Errors
    /// [`OpenError`]: what is wrong, and what is allowed. No bytes make this function panic.
    pub fn read(bytes: Vec<u8>) -> Result<Self, OpenError> {
        if Wav::is_one(&bytes) {
            return Ok(Self::Recording(Wav::read(bytes)?));
        }
        Ok(match File::read(&bytes)? {
            File::Own(measurement) => Self::Own(measurement),
            File::Foreign(foreign) => Self::Foreign(foreign),
        })
    }
}

/// What a person tells of a measurement by another program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForeignMetadata {
    /// Where the sensor stood, metres from the driven end.
    pub place_m: f64,
    /// What it showed; `None` while nobody has said.
    pub kind: Option<SensorKind>,
    /// Signal over noise, dB (0 to 140).
    pub snr_db: f64,
}

impl ForeignMetadata {
    /// What the file itself tells, with the place that is offered.
    #[must_use]
    pub const fn by(foreign: &Foreign, place_m: f64) -> Self {
        Self { place_m, kind: foreign.sensor, snr_db: SNR_DB }
    }
}

/// Why a file with what was told of it is no measurement of a plate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ForeignError {
    /// The place is not on the plate.
    #[error("{0}, on the plate")]
    Place(OutOfRange),
    /// Nobody has said what the sensor shows.
    #[error("the file does not state what its sensor shows")]
    Kind,
    /// The file is of other frequencies.
    #[error(
        "{count} of its frequencies are between {} and {}, where this plate is measured: at least {} are needed",
        show_frequency(.band_hz.0), show_frequency(.band_hz.1), POINTS.least
    )]
    Band {
        /// How many are of use.
        count: usize,
        /// The frequencies that are, Hz.
        band_hz: (f64, f64),
    },
    /// The recording's channel cannot be read.
    #[error(transparent)]
    Wav(#[from] WavError),
    /// The recording does not tell a response.
    #[error(transparent)]
    Heard(#[from] HeardError),
    /// The numbers are no measurement.
    #[error(transparent)]
    Data(#[from] CalibrateError),
}

/// Refuses a place that is not on the plate, and a sensor of which nobody has said what it shows.
fn sensor(plate: &Plate, place_m: f64, kind: Option<SensorKind>) -> Result<SensorKind, ForeignError> {
    let on_plate = Range::new(0.0, plate.length_m(), "m");
    OutOfRange::check("sensor", place_m, on_plate).map_err(ForeignError::Place)?;
    kind.ok_or(ForeignError::Kind)
}

/// Refuses frequencies of which too few calibrate a plate; the band in which they do.
fn band(plate: &Plate, frequencies_hz: impl Iterator<Item = f64>) -> Result<(f64, f64), ForeignError> {
    let band_hz = band_hz(plate);
    let count = frequencies_hz.filter(|hz| (band_hz.0..=band_hz.1).contains(hz)).count();
    if count < POINTS.least { Err(ForeignError::Band { count, band_hz }) } else { Ok(band_hz) }
}

/// The measurement of a foreign file, within the frequencies that a calibration of `plate` uses.
///
/// # Errors
/// [`Untold`]: what is missing or out of its range.
pub fn measurement(
    plate: &Plate,
    foreign: &Foreign,
    metadata: &ForeignMetadata,
) -> Result<Measurement, ForeignError> {
    let kind = sensor(plate, metadata.place_m, metadata.kind)?;
    let band_hz = band(plate, foreign.points.iter().map(|point| point.0))?;
    Ok(foreign.measurement(metadata.place_m, kind, metadata.snr_db, band_hz)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foreign_file_is_a_measurement_once_its_place_and_kind_are_told() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let lines: String = (60..300).map(|hz| format!("{hz} -20.0 10.0\n")).collect();
        let Ok(File::Foreign(foreign)) = File::read(lines.as_bytes()) else { panic!("a table") };
        let metadata = ForeignMetadata::by(&foreign, 0.05);
        assert_eq!(measurement(&plate, &foreign, &metadata), Err(ForeignError::Kind));
        let metadata = ForeignMetadata { kind: Some(SensorKind::Velocity), ..metadata };
        let found = measurement(&plate, &foreign, &metadata).unwrap();
        assert_eq!((found.place_m, found.sensor), (0.05, SensorKind::Velocity));
        let (low, high) = band_hz(&plate);
        assert!(found.points.iter().all(|point| (low..=high).contains(&point.frequency_hz)));
        let refused =
            |metadata: ForeignMetadata| measurement(&plate, &foreign, &metadata).unwrap_err().to_string();
        assert!(refused(ForeignMetadata { place_m: 0.5, ..metadata }).contains("0 to 0.32 m, on the plate"));
        let high = Foreign { points: vec![(40e3, foreign.points[0].1); 40], sensor: None };
        let words = measurement(&plate, &high, &metadata).unwrap_err().to_string();
        assert!(
            words.starts_with("0 of its frequencies are between") && words.contains("at least 8"),
            "{words}"
        );
        assert!(
            refused(ForeignMetadata { snr_db: 150.0, ..metadata }).contains("snr = 150"),
            "the noise is checked, too"
        );
    }
}
