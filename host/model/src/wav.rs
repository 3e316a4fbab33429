//! Recordings: WAV files and, on this computer, lossless files of other formats; and the values of one channel.

mod head;
#[cfg(feature = "native")]
mod lossless;

use head::{Encoding, Format};
use slipline_plate::quantity::{OutOfRange, Range, must_be};
use std::ops::Range as Bytes;
use thiserror::Error;

/// Largest size of a recording, bytes: some minutes of any common format.
pub const BYTES_MAX: usize = 256 << 20;
/// Allowed values per second.
pub const RATE: Range = Range::new(8e3, 384e3, "Hz");
/// Allowed number of values of a channel; the largest is 5 minutes at 48 kHz.
const FRAMES: Range = Range::new(1.0, 16_777_216.0, "");

/// A recording. A channel's values are read on request.
#[derive(Clone, PartialEq, Eq)]
pub struct Wav {
    bytes: Vec<u8>,
    format: Format,
    /// Where the values are.
    values: Bytes<usize>,
}

impl std::fmt::Debug for Wav {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wav")
            .field("format", &self.format)
            .field("values", &self.values)
            .finish_non_exhaustive()
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
    /// It cannot be read as a lossless file of another format, which is named.
    #[error("the {0} file cannot be read: {1}")]
    Lossless(&'static str, String),
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

impl Wav {
    /// Reads a WAV file: integers of 8, 16, 24 or 32 bits or floating point of 32 or 64, with any number of channels, at 8
    /// to 384 kHz.
    ///
    /// # Errors
    /// [`WavError`]: what is wrong, and the allowed values. No bytes make this function panic.
    pub fn read(bytes: Vec<u8>) -> Result<Self, WavError> {
        let (mut format, values) = head::read(&bytes)?;
        if (format.bytes, format.bits) == (4, Some(24)) && is_at_the_lower_end(&bytes[values.clone()]) {
            format.encoding = Encoding::Signed24;
        }
        Self { bytes, format, values }.checked()
    }

    /// Reads a lossless file of the format `name`, which is not WAV.
    ///
    /// # Errors
    /// As [`Wav::read`].
    #[cfg(feature = "native")]
    pub fn read_lossless(name: &'static str, bytes: Vec<u8>) -> Result<Self, WavError> {
        lossless::read(name, bytes)?.checked()
    }

    fn checked(self) -> Result<Self, WavError> {
        OutOfRange::check("rate", self.rate_hz(), RATE)?;
        OutOfRange::check("values of a channel", self.frames() as f64, FRAMES)?;
        Ok(self)
    }

    /// Number of channels.
    #[must_use]
    pub const fn channels(&self) -> usize {
        self.format.channels
    }

    /// Values per second, as stated by the recorder.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        f64::from(self.format.rate_hz)
    }

    /// Its duration, in seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.frames() as f64 / self.rate_hz()
    }

    fn frames(&self) -> usize {
        self.values.len() / self.format.frame()
    }

    /// The values of a channel; channels are numbered from 1.
    ///
    /// # Errors
    /// [`WavError`]: there is no such channel, or a value is not a number.
    pub fn channel(&self, number: usize) -> Result<Sound, WavError> {
        if !(1..=self.channels()).contains(&number) {
            let allowed = format_args!("1 to {}, the channels of the file", self.channels());
            return Err(WavError::Channel(must_be(format_args!("channel {number}"), allowed)));
        }
        let Format { encoding, bytes, bits, .. } = self.format;
        let frames = self.bytes[self.values.clone()].chunks_exact(self.format.frame());
        let begin = (number - 1) * bytes;
        let values: Vec<f64> = frames.map(|frame| encoding.value(&frame[begin..begin + bytes])).collect();
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            return Err(WavError::Form(must_be(format_args!("value {}", place + 1), "a finite number")));
        }
        // Full scale is one step beyond the last positive value.
        let step = bits.map(|bits| 0.5_f64.powi(bits as i32 - 1));
        let end = step.map(|step| 1.0 - step);
        Ok(Sound { rate_hz: self.rate_hz(), values, end, step: step.unwrap_or(0.0) })
    }
}

/// Whether values of 24 bits in four bytes are at the lower end of these: the low bytes are used, and the high ones repeat the sign.
fn is_at_the_lower_end(values: &[u8]) -> bool {
    let mut values = values.as_chunks::<4>().0.iter();
    values.clone().any(|value| value[0] != 0)
        && values.all(|value| value[3] == if value[2] < 0x80 { 0 } else { 0xff })
}

#[cfg(test)]
mod tests;
