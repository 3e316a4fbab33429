//! Measurements by other programs: a table of frequency and level, REW's text, `.frd`, and universal files (datasets 58 and 58b).
//!
//! ```text
//! bytes -> File -+-> Own: everything is stated                  (Measurement::from_csv)
//!                +-> Foreign: frequencies and responses alone -> place, kind of sensor and noise from the user -> Measurement
//! ```
//!
//! All these forms count time as e^(+j omega t): their responses are the conjugates of ours.

mod frequency_table;
mod uff58;

use super::csv::{self, CsvError};
use super::sensor::{MeasuredPoint, Measurement, SensorKind};
use crate::calibrate::error::CalibrateError;
use crate::quantity::{OutOfRange, Range};
use crate::text_table::BadLine;
use num_complex::Complex64;
use thiserror::Error;

/// Signal over noise of a measurement that does not state it, dB: that of a careful one.
pub const SNR_DB: f64 = 40.0;
/// Range of the signal over the noise.
pub const SNR: Range = Range::new(0.0, 140.0, "dB");
/// Frequencies that a calibration uses of a foreign measurement, at most; more would only take longer.
const FREQUENCIES_MAX: usize = 400;
/// Levels that a file may have.
const LEVEL: Range = Range::new(-400.0, 400.0, "dB");

/// A file of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub enum File {
    /// In the own form, which states everything.
    Own(Measurement),
    /// By another program.
    Foreign(Foreign),
}

/// A measurement by another program: place, kind of sensor and noise are not in its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// The kind of sensor, if the file states it: a universal file does.
    pub sensor: Option<SensorKind>,
    /// Frequency in hertz, in the order of the file, and response: of phase 0 where the file has magnitudes alone.
    pub points: Vec<(f64, Complex64)>,
}

/// Why a file is no measurement.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FileError {
    /// A file in the own form with a mistake.
    #[error(transparent)]
    Own(#[from] CsvError),
    /// A line that cannot be read.
    #[error(transparent)]
    Line(#[from] BadLine),
    /// No line begins with two numbers.
    #[error(
        "no line has a frequency and a level: write one pair to a line, apart by commas, semicolons, tabs or blanks"
    )]
    Empty,
    /// A universal file without a frequency response.
    #[error("the universal file holds no dataset 58, a function at a nodal degree of freedom")]
    NoFunction,
    /// A universal file with several functions.
    #[error("the universal file holds more than one function: save the one of this sensor alone")]
    ManyFunctions,
    /// A recording.
    #[error("the file is a sound and not a table of frequencies")]
    Sound,
}

impl File {
    /// Reads a measurement in any of the forms, recognised by its content.
    ///
    /// ```
    /// use slipline_plate::calibrate::File;
    ///
    /// let text = "* Freq(Hz) SPL(dB) Phase(degrees)\n100.0 -20.0 90.0\n101.0 -19.5 80.0\n";
    /// let Ok(File::Foreign(foreign)) = File::read(text.as_bytes()) else { panic!() };
    /// let (frequency_hz, response) = foreign.points[0];
    /// assert!(frequency_hz == 100.0 && (response.norm() - 0.1).abs() < 1e-12 && response.im < 0.0);
    /// ```
    ///
    /// # Errors
    /// [`FileError`], with the line where there is one. No bytes make this function panic.
    pub fn read(bytes: &[u8]) -> Result<Self, FileError> {
        if bytes.starts_with(b"RIFF") {
            return Err(FileError::Sound);
        }
        if uff58::binary::has_one(bytes) {
            return Ok(Self::Foreign(uff58::binary::read(bytes)?));
        }
        // Names of a microphone may be in any code: only the numbers count.
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_start_matches('\u{feff}');
        if csv::is_own(text) {
            return Ok(Self::Own(Measurement::from_csv(text)?));
        }
        let foreign = if uff58::is_one(text) { uff58::read(text)? } else { frequency_table::read(text)? };
        Ok(Self::Foreign(foreign))
    }
}

impl Foreign {
    /// The measurement of a sensor at `place_m` within a band of frequencies (Hz), with noise `snr_db` (0 to 140 dB) below the
    /// root mean square of its magnitudes. Of more than 400 frequencies every second is left out, or more.
    ///
    /// # Errors
    /// [`CalibrateError`]: a number out of its range, or fewer than 8 frequencies in the band.
    pub fn measurement(
        &self,
        place_m: f64,
        sensor: SensorKind,
        snr_db: f64,
        (low_hz, high_hz): (f64, f64),
    ) -> Result<Measurement, CalibrateError> {
        OutOfRange::check("snr", snr_db, SNR)?;
        let inside = |point: &&(f64, Complex64)| (low_hz..=high_hz).contains(&point.0);
        let points: Vec<&(f64, Complex64)> = self.points.iter().filter(inside).collect();
        let points: Vec<_> = points.iter().step_by(points.len().div_ceil(FREQUENCIES_MAX).max(1)).collect();
        let square: f64 =
            points.iter().map(|point| point.1.norm_sqr()).sum::<f64>() / points.len().max(1) as f64;
        let noise = (square.sqrt() * 10_f64.powf(-snr_db / 20.0)).max(1e-30);
        let points = points.iter().map(|point| MeasuredPoint {
            frequency_hz: point.0,
            response: point.1,
            noise,
            headroom_db: None,
        });
        let measurement = Measurement::at(place_m, sensor, points.collect());
        measurement.check()?;
        Ok(measurement)
    }
}

impl Measurement {
    /// The measurement as a universal file: a frequency response in double precision, dataset 58. Frequencies have six digits
    /// in it; noise and headroom are left out.
    #[must_use]
    pub fn to_uff58(&self) -> String {
        uff58::write(self)
    }

    /// The measurement as `.frd`: lines of frequency in hertz, level in dB and phase in degrees.
    #[must_use]
    pub fn to_frd(&self) -> String {
        frequency_table::write(self)
    }

    /// The response in the sensor's unit where that is known, as e^(+j omega t) shows it.
    fn shown(&self, point: &MeasuredPoint) -> Complex64 {
        point.response.conj() * self.unit_per_response.unwrap_or(1.0)
    }
}

#[cfg(test)]
mod tests;
