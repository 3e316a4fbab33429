//! Files of measurements by other programs: the missing metadata, and the measurement once the user has
//! stated it.
//!
//! ```text
//! bytes -> Opened -+-> Own: complete
//!                  +-> Foreign: frequencies and responses   -- place, kind, noise --------> Measurement
//!                  +-> Recording: of the sweep, lossless    -- place, kind, channel,
//!                                                              description of the sweep --> Measurement, notes
//! ```

mod recorded;

pub use recorded::{RecordingMetadata, recorded};

use crate::measure::HeardError;
use slipline_model::content::Content;
use slipline_model::wav::{Wav, WavError};
use slipline_plate::Plate;
use slipline_plate::calibrate::{
    CalibrateError, File, FileError, Foreign, Measurement, POINTS, SNR_DB, SensorKind, band_hz,
};
use slipline_plate::quantity::{OutOfRange, Range, show_frequency};
use slipline_plate::text_table::Chosen;
use thiserror::Error;

/// Largest size of a measurement's file, bytes: a recording of some minutes, or a universal file of millions
/// of points.
pub const BYTES_MAX: usize = slipline_model::wav::BYTES_MAX;

/// A file of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub enum Opened {
    /// In Slipline's own format, which is complete.
    Own(Measurement),
    /// By another program.
    Foreign(Foreign),
    /// A recording of the sweep.
    Recording(Wav),
}

/// Why a file is not a measurement.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OpenError {
    /// It is not a table of frequencies.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is not a recording.
    #[error(transparent)]
    Wav(#[from] WavError),
    /// It is a recording of this format, which a browser does not read.
    #[error("it is a recording as {0}; here: WAV")]
    NotHere(&'static str),
    /// It is of another kind: what it is, and what to do.
    #[error("{0}")]
    Foreign(&'static str),
}

impl Opened {
    /// Reads a measurement in any of the formats, recognized by the file's content. The columns of a table are those that
    /// its head names, or those that are chosen.
    ///
    /// # Errors
    /// [`OpenError`]: what is wrong, and the allowed values. No bytes make this function panic.
    pub fn read(bytes: Vec<u8>, columns: &[Chosen]) -> Result<Self, OpenError> {
        match Content::of(&bytes) {
            Content::Wav => return Ok(Self::Recording(Wav::read(bytes)?)),
            #[cfg(feature = "native")]
            Content::Lossless(name) => return Ok(Self::Recording(Wav::read_lossless(name, bytes)?)),
            #[cfg(not(feature = "native"))]
            Content::Lossless(name) => return Err(OpenError::NotHere(name)),
            Content::Foreign(what) => return Err(OpenError::Foreign(what)),
            Content::Other => {}
        }
        Ok(match File::read(&bytes, columns)? {
            File::Own(measurement) => Self::Own(measurement),
            File::Foreign(foreign) => Self::Foreign(foreign),
        })
    }
}

/// Metadata of a measurement by another program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForeignMetadata {
    /// Sensor place, metres from the driven end.
    pub place_m: f64,
    /// The quantity that the sensor shows; `None` while it is not stated.
    pub kind: Option<SensorKind>,
    /// Signal over noise, dB (0 to 140).
    pub snr_db: f64,
}

impl ForeignMetadata {
    /// The metadata in the file itself, with this place as proposal.
    #[must_use]
    pub const fn by(foreign: &Foreign, place_m: f64) -> Self {
        Self { place_m, kind: foreign.sensor, snr_db: SNR_DB }
    }
}

/// Why a file with its metadata is not a measurement of a plate.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ForeignError {
    /// The place is not on the plate.
    #[error("{0}, on the plate")]
    Place(OutOfRange),
    /// The sensor's quantity is not stated.
    #[error("the file does not state what its sensor shows")]
    Kind,
    /// Too few of the file's frequencies are in the plate's band.
    #[error(
        "{count} of its frequencies are between {} and {}, where this plate is measured: at least {} are needed",
        show_frequency(.band_hz.0), show_frequency(.band_hz.1), POINTS.least
    )]
    Band {
        /// Number of frequencies in the band.
        count: usize,
        /// The band, Hz.
        band_hz: (f64, f64),
    },
    /// The recording's channel cannot be read.
    #[error(transparent)]
    Wav(#[from] WavError),
    /// No response can be computed from the recording.
    #[error(transparent)]
    Heard(#[from] HeardError),
    /// The numbers are not a valid measurement.
    #[error(transparent)]
    Data(#[from] CalibrateError),
    /// A row of the file cannot be used.
    #[error(transparent)]
    File(#[from] FileError),
}

/// Refuses a place outside the plate, and a sensor whose quantity is not stated.
fn sensor(plate: &Plate, place_m: f64, kind: Option<SensorKind>) -> Result<SensorKind, ForeignError> {
    let on_plate = Range::new(0.0, plate.length_m(), "m");
    OutOfRange::check("sensor", place_m, on_plate).map_err(ForeignError::Place)?;
    kind.ok_or(ForeignError::Kind)
}

/// Refuses a file with too few frequencies in the plate's band for a calibration; returns that band, Hz.
fn band(plate: &Plate, frequencies_hz: impl Iterator<Item = f64>) -> Result<(f64, f64), ForeignError> {
    let band_hz = band_hz(plate);
    let count = frequencies_hz.filter(|hz| (band_hz.0..=band_hz.1).contains(hz)).count();
    if count < POINTS.least { Err(ForeignError::Band { count, band_hz }) } else { Ok(band_hz) }
}

/// The measurement of a foreign file, within the frequencies that a calibration of `plate` uses.
///
/// # Errors
/// [`ForeignError`]: what is missing or out of its range.
pub fn measurement(
    plate: &Plate,
    foreign: &Foreign,
    metadata: &ForeignMetadata,
) -> Result<Measurement, ForeignError> {
    let kind = sensor(plate, metadata.place_m, metadata.kind)?;
    let band_hz = band(plate, foreign.points.iter().map(|point| point.frequency_hz))?;
    Ok(foreign.measurement(metadata.place_m, kind, metadata.snr_db, band_hz)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::calibrate::ForeignPoint;

    #[test]
    fn a_foreign_file_is_a_measurement_once_its_place_and_kind_are_stated() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let lines: String = (60..300).map(|hz| format!("{hz} -20.0 10.0\n")).collect();
        let Ok(File::Foreign(foreign)) = File::read(lines.as_bytes(), &[]) else { panic!("a table") };
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
        let point = ForeignPoint { frequency_hz: 40e3, ..foreign.points[0] };
        let high = Foreign { points: vec![point; 40], ..foreign.clone() };
        let words = measurement(&plate, &high, &metadata).unwrap_err().to_string();
        assert!(
            words.starts_with("0 of its frequencies are between") && words.contains("at least 8"),
            "{words}"
        );
        assert!(
            refused(ForeignMetadata { snr_db: 150.0, ..metadata }).contains("snr = 150"),
            "the noise is checked as well"
        );
    }
}
