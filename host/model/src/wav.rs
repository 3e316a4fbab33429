//! WAV files: their format, and the values of one channel.

use hound::{SampleFormat, WavReader, WavSpec};
use slipline_plate::quantity::{OutOfRange, Range, must_be};
use std::io::Cursor;
use thiserror::Error;

/// Largest size of a WAV file, bytes: some minutes of any common format.
pub const BYTES_MAX: usize = 256 << 20;
/// Allowed values per second.
pub const RATE: Range = Range::new(8e3, 384e3, "Hz");
/// Allowed number of values of a channel; the largest is 5 minutes at 48 kHz.
const FRAMES: Range = Range::new(1.0, 16_777_216.0, "");

/// A WAV file. A channel's values are read on request.
#[derive(Clone, PartialEq, Eq)]
pub struct Wav {
    bytes: Vec<u8>,
    spec: WavSpec,
    frames: u32,
}

impl std::fmt::Debug for Wav {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wav").field("spec", &self.spec).field("frames", &self.frames).finish_non_exhaustive()
    }
}

/// One channel of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Sound {
    /// Values per second, as stated by the recorder.
    pub rate_hz: f64,
    /// The values; 1 is the file's full scale.
    pub values: Vec<f64>,
    /// The largest magnitude of values; `None` for floating point, which has no limit.
    pub end: Option<f64>,
    /// The step between values, as stored in the file.
    pub step: f64,
}

/// Why a file is not a recording.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum WavError {
    /// It cannot be read as WAV.
    #[error("the WAV file cannot be read: {0}")]
    Form(String),
    /// An unsupported format of values.
    #[error("{0}")]
    Values(String),
    /// A number is outside its range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// It has no such channel.
    #[error("{0}")]
    Channel(String),
}

fn form(error: &hound::Error) -> WavError {
    WavError::Form(match error {
        // The system's text is "failed to fill whole buffer".
        hound::Error::IoError(_) => "it ends before the values that it announces".to_owned(),
        error => error.to_string(),
    })
}

impl Wav {
    /// Whether bytes are those of a WAV file of any format.
    #[must_use]
    pub fn is_one(bytes: &[u8]) -> bool {
        [b"RIFF", b"RF64", b"RIFX"].iter().any(|name| bytes.starts_with(*name))
    }

    /// Reads a file: integers of 16, 24 or 32 bits or floating point of 32, with any number of channels, at 8
    /// to 384 kHz.
    ///
    /// # Errors
    /// [`WavError`]: what is wrong, and the allowed values. No bytes make this function panic.
    pub fn read(bytes: Vec<u8>) -> Result<Self, WavError> {
        let reader = WavReader::new(Cursor::new(&bytes)).map_err(|error| form(&error))?;
        let (spec, frames) = (reader.spec(), reader.duration());
        OutOfRange::check("rate", f64::from(spec.sample_rate), RATE)?;
        let is_read = match spec.sample_format {
            SampleFormat::Int => [16, 24, 32].contains(&spec.bits_per_sample),
            SampleFormat::Float => spec.bits_per_sample == 32,
        };
        if !is_read {
            let kind = if spec.sample_format == SampleFormat::Int { "integers" } else { "floating point" };
            let given = format_args!("{kind} of {} bits", spec.bits_per_sample);
            let allowed = "integers of 16, 24 or 32 bits, or floating point of 32";
            return Err(WavError::Values(must_be(given, allowed)));
        }
        OutOfRange::check("values of a channel", f64::from(frames), FRAMES)?;
        Ok(Self { spec, frames, bytes })
    }

    /// Number of channels.
    #[must_use]
    pub const fn channels(&self) -> usize {
        self.spec.channels as usize
    }

    /// Values per second, as stated by the recorder.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        f64::from(self.spec.sample_rate)
    }

    /// Its duration, in seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        f64::from(self.frames) / self.rate_hz()
    }

    /// The values of a channel; channels are numbered from 1.
    ///
    /// # Errors
    /// [`WavError`]: there is no such channel, the file ends too early, or a value is not a number.
    pub fn channel(&self, number: usize) -> Result<Sound, WavError> {
        if !(1..=self.channels()).contains(&number) {
            let allowed = format_args!("1 to {}, the channels of the file", self.channels());
            return Err(WavError::Channel(must_be(format_args!("channel {number}"), allowed)));
        }
        let step = 0.5_f64.powi(i32::from(self.spec.bits_per_sample) - 1);
        let (values, end, step) = match self.spec.sample_format {
            SampleFormat::Float => (self.picked::<f32>(number, 1.0)?, None, 0.0),
            // Full scale is one step beyond the last positive value.
            SampleFormat::Int => (self.picked::<i32>(number, step)?, Some(1.0 - step), step),
        };
        match values.iter().position(|value| !value.is_finite()) {
            Some(place) => {
                Err(WavError::Form(must_be(format_args!("value {}", place + 1), "a finite number")))
            }
            None => Ok(Sound { rate_hz: self.rate_hz(), values, end, step }),
        }
    }

    /// The values of a channel times a scale.
    fn picked<S: hound::Sample + Into<f64>>(&self, number: usize, scale: f64) -> Result<Vec<f64>, WavError> {
        let mut reader = WavReader::new(Cursor::new(&self.bytes)).map_err(|error| form(&error))?;
        let mut picked = Vec::with_capacity(self.frames as usize);
        for (place, value) in reader.samples::<S>().enumerate() {
            // A file that ends too early is detected in any channel.
            let value: f64 = value.map_err(|error| form(&error))?.into();
            if place % self.channels() == number - 1 {
                picked.push(value * scale);
            }
        }
        Ok(picked)
    }
}

#[cfg(test)]
mod tests;
