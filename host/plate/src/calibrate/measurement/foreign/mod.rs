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
use crate::quantity::{OutOfRange, Range, from_decibels, show_frequency};
use crate::text_table::{BadLine, Chosen, ColumnRead, UnclearColumns, text_of, understood, wrong};
use num_complex::Complex64;
use std::fmt;
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
    /// The kind of sensor, if the file states it.
    pub sensor: Option<SensorKind>,
    /// Its rows, in the order of the file.
    pub points: Vec<ForeignPoint>,
    /// Its columns, and what was understood of them.
    pub columns: Vec<ColumnRead>,
    /// Whether other columns can be chosen: a universal file states them.
    pub is_table: bool,
}

/// A row of a file by another program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForeignPoint {
    /// Its line in the file, from 1.
    pub line: usize,
    /// Frequency, hertz.
    pub frequency_hz: f64,
    /// Response; its phase is 0 where the file has magnitudes alone. `None` where the file has no number.
    pub response: Option<Complex64>,
}

/// What was read of a file by another program.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ForeignRead {
    /// Number of its rows.
    // JSON, count: Rows of the table
    pub rows: usize,
    /// Number of rows in the band of the plate.
    // JSON, count: Its rows at frequencies where the plate is measured; the others do not matter
    pub rows_in_band: usize,
    /// Lowest frequency above 0, hertz.
    // JSON: Lowest frequency of the file
    pub low_hz: f64,
    /// Highest frequency, hertz.
    // JSON: Highest frequency of the file
    pub high_hz: f64,
    /// Its columns.
    pub columns: Vec<ColumnRead>,
}

impl ForeignRead {
    /// What the columns were read as, and how many rows cannot matter, in words.
    #[must_use]
    pub fn understood(&self) -> String {
        let text = understood(&self.columns);
        match self.rows - self.rows_in_band {
            0 => text,
            1 => text + "; 1 row outside the plate's band left out",
            rows => text + &format!("; {rows} rows outside the plate's band left out"),
        }
    }
}

impl fmt::Display for ForeignRead {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (low, high) = (show_frequency(self.low_hz), show_frequency(self.high_hz));
        write!(f, "{} rows, {low} to {high}; {}", self.rows, self.understood())
    }
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
    /// Columns whose meaning is not clear.
    #[error(transparent)]
    Columns(#[from] UnclearColumns),
    /// A number is out of its range.
    #[error(transparent)]
    Value(#[from] CalibrateError),
    /// No line begins with two numbers.
    #[error(
        "no line has a frequency and a level: write one pair on each line, separated by commas, semicolons, tabs or blanks"
    )]
    Empty,
    /// A universal file without a frequency response.
    #[error(
        "the universal file holds no dataset 58, a function at a nodal degree of freedom, but {others}: export the frequency response as dataset 58"
    )]
    NoFunction {
        /// The numbers of its datasets.
        others: String,
    },
    /// A universal file with several functions.
    #[error("the universal file holds more than one function: save the one of this sensor alone")]
    ManyFunctions,
    /// Columns were chosen of a file that states them.
    #[error("the file's format states its columns: only those of a table can be chosen")]
    Stated,
    /// Bytes that are no text.
    #[error("the file is no text: save the table as CSV")]
    NoText,
}

impl File {
    /// Reads a measurement in any of the formats, recognised by its content. The columns of a table are those that its
    /// head names, unless `columns` names them.
    ///
    /// ```
    /// use slipline_plate::calibrate::File;
    ///
    /// let text = "* Freq(Hz) SPL(dB) Phase(degrees)\n100.0 -20.0 90.0\n101.0 -19.5 80.0\n";
    /// let Ok(File::Foreign(foreign)) = File::read(text.as_bytes(), &[]) else { panic!() };
    /// let response = foreign.points[0].response.unwrap();
    /// assert!((response.norm() - 0.1).abs() < 1e-12 && response.im < 0.0);
    /// assert_eq!(foreign.columns[1].quantity, Some("level"));
    /// ```
    ///
    /// # Errors
    /// [`FileError`], with the line where there is one. No bytes make this function panic.
    pub fn read(bytes: &[u8], columns: &[Chosen]) -> Result<Self, FileError> {
        let is_stated = || if columns.is_empty() { Ok(()) } else { Err(FileError::Stated) };
        if uff58::is_one(bytes) {
            is_stated()?;
            return Ok(Self::Foreign(uff58::read(bytes)?));
        }
        let text = text_of(bytes);
        if text.contains('\0') {
            return Err(FileError::NoText);
        }
        if csv::is_own(&text) {
            is_stated()?;
            return Ok(Self::Own(Measurement::from_csv(&text)?));
        }
        Ok(Self::Foreign(frequency_table::read(&text, columns)?))
    }
}

impl Foreign {
    /// What was read, for a plate that is measured within a band of frequencies (Hz).
    #[must_use]
    pub fn read(&self, (low_hz, high_hz): (f64, f64)) -> ForeignRead {
        let frequencies = || self.points.iter().map(|point| point.frequency_hz).filter(|hz| *hz > 0.0);
        ForeignRead {
            rows: self.points.len(),
            rows_in_band: frequencies().filter(|hz| (low_hz..=high_hz).contains(hz)).count(),
            low_hz: frequencies().fold(f64::INFINITY, f64::min),
            high_hz: frequencies().fold(0.0, f64::max),
            columns: self.columns.clone(),
        }
    }

    /// The rows within a band, in rising frequency.
    ///
    /// # Errors
    /// The line of a row without a response, of a repeated frequency, or of one out of order.
    fn rising(&self, (low_hz, high_hz): (f64, f64)) -> Result<Vec<(f64, Complex64)>, BadLine> {
        let inside = || self.points.iter().filter(|point| (low_hz..=high_hz).contains(&point.frequency_hz));
        let falls = inside().is_sorted_by(|a, b| a.frequency_hz > b.frequency_hz);
        let mut before = None;
        for point in inside().filter(|_| !falls) {
            let hz = point.frequency_hz;
            match before.replace(hz) {
                Some(other) if other == hz => {
                    return Err(wrong(point.line, format!("the frequency {hz} Hz has two rows: keep one")));
                }
                Some(other) if other > hz => {
                    let why = format!("the frequency {hz} Hz follows {other} Hz: sort the rows by frequency");
                    return Err(wrong(point.line, why));
                }
                _ => {}
            }
        }
        let number = |point: &ForeignPoint| {
            let missing =
                || wrong(point.line, "no finite number for the response: remove the row, or correct it");
            Ok((point.frequency_hz, point.response.ok_or_else(missing)?))
        };
        let mut points = inside().map(number).collect::<Result<Vec<_>, BadLine>>()?;
        if falls {
            points.reverse();
        }
        Ok(points)
    }

    /// The measurement of a sensor at `place_m` within a band of frequencies (Hz), with noise `snr_db` (0 to 140 dB)
    /// below the root mean square of its magnitudes. More than 400 frequencies are thinned to every second, or fewer.
    ///
    /// # Errors
    /// [`FileError`]: a row of the band that cannot be used, a number out of its range, or fewer than 8 frequencies in the
    /// band.
    pub fn measurement(
        &self,
        place_m: f64,
        sensor: SensorKind,
        snr_db: f64,
        band_hz: (f64, f64),
    ) -> Result<Measurement, FileError> {
        OutOfRange::check("snr", snr_db, SNR).map_err(CalibrateError::from)?;
        let points = self.rising(band_hz)?;
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
