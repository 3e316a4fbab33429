//! Measurements by other programs: a table of frequency and level, REW's text, `.frd`, and universal files (datasets 58 and 58b).
//!
//! ```text
//! bytes -> File -+-> Own: everything is stated                  (Measurement::from_csv)
//!                +-> Foreign: frequencies and responses alone -> place, kind of sensor and noise from the user -> Measurement
//! ```
//!
//! All these formats use e^(+j omega t): their responses are the complex conjugates of this crate's.

mod frequency_table;
mod uff58;

use super::csv::{self, CsvError};
use super::sensor::{MeasuredPoint, Measurement, SensorKind};
use crate::calibrate::error::CalibrateError;
use crate::quantity::{OutOfRange, Range, from_decibels};
use crate::text_table::BadLine;
use num_complex::Complex64;
use std::borrow::Cow;
use thiserror::Error;

/// Signal-to-noise ratio assumed where a file does not state it, dB: that of a careful measurement.
pub const SNR_DB: f64 = 40.0;
/// Range of the signal-to-noise ratio.
pub const SNR: Range = Range::new(0.0, 140.0, "dB");
/// Largest number of frequencies used of a foreign measurement; more would only take longer.
const FREQUENCIES_MAX: usize = 400;
/// Range of the levels in a file.
const LEVEL: Range = Range::new(-400.0, 400.0, "dB");

/// A file of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub enum File {
    /// In this program's own format, which states everything.
    Own(Measurement),
    /// By another program.
    Foreign(Foreign),
}

/// A measurement by another program: place, kind of sensor and noise are not in its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// The kind of sensor, if the file states it: a universal file does.
    pub sensor: Option<SensorKind>,
    /// Frequency in hertz, in the order of the file, and response; the phase is 0 where the file has magnitudes
    /// alone.
    pub points: Vec<(f64, Complex64)>,
}

/// Why a file is no measurement.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FileError {
    /// A mistake in a file of this program's own format.
    #[error(transparent)]
    Own(#[from] CsvError),
    /// A line that cannot be read.
    #[error(transparent)]
    Line(#[from] BadLine),
    /// No line begins with two numbers.
    #[error(
        "no line has a frequency and a level: write one pair on each line, separated by commas, semicolons, tabs or blanks"
    )]
    Empty,
    /// A universal file without a frequency response.
    #[error("the universal file holds no dataset 58, a function at a nodal degree of freedom")]
    NoFunction,
    /// A universal file with several functions.
    #[error("the universal file holds more than one function: save the one of this sensor alone")]
    ManyFunctions,
    /// A sound file.
    #[error("the file is a sound and not a table of frequencies")]
    Sound,
}

impl File {
    /// Reads a measurement in any of the formats, recognised by its content.
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
        let text = text_of(bytes);
        let text = text.trim_start_matches('\u{feff}');
        if csv::is_own(text) {
            return Ok(Self::Own(Measurement::from_csv(text)?));
        }
        let foreign = if uff58::is_one(text) { uff58::read(text)? } else { frequency_table::read(text)? };
        Ok(Self::Foreign(foreign))
    }
}

/// The text of a file: UTF-16 where its mark says so, as spreadsheets write it, else UTF-8. A microphone's name may be in
/// any encoding; only the numbers matter.
fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    let from: fn([u8; 2]) -> u16 = match bytes {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return String::from_utf8_lossy(bytes),
    };
    let units = bytes[2..].chunks_exact(2).map(|pair| from([pair[0], pair[1]]));
    char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

impl Foreign {
    /// The measurement of a sensor at `place_m` within a band of frequencies (Hz), with noise `snr_db` (0 to 140 dB)
    /// below the root mean square of its magnitudes. More than 400 frequencies are thinned to every second, or fewer.
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
        let noise = (square.sqrt() * from_decibels(-snr_db)).max(1e-30);
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
    /// The measurement as a universal file: dataset 58, a frequency response in double precision. Frequencies are
    /// written with six digits; noise and headroom are left out.
    #[must_use]
    pub fn to_uff58(&self) -> String {
        uff58::write(self)
    }

    /// The measurement as `.frd`: frequency in hertz, level in dB and phase in degrees, one line for each point.
    #[must_use]
    pub fn to_frd(&self) -> String {
        frequency_table::write(self)
    }

    /// The response in the sensor's unit where that is known, in the convention e^(+j omega t).
    fn shown(&self, point: &MeasuredPoint) -> Complex64 {
        point.response.conj() * self.unit_per_response.unwrap_or(1.0)
    }
}

#[cfg(test)]
mod tests;
