//! The description of a played sweep as a TOML file.

use super::super::chirp::{Chirp, RING_S};
use super::super::table::INTERVALS;
use super::{PlayedSweep, SWEEP_S};
use crate::measure::plan::{HIGHEST, Wanted};
use serde::{Deserialize, Serialize};
use slipline_link::BLOCK;
use slipline_plate::quantity::{OutOfRange, Range, must_be};
use thiserror::Error;

/// Largest size of a description, bytes.
pub const PLAYED_BYTES_MAX: usize = 256 << 10;
/// Version of the format.
const VERSION: i64 = 1;
/// Allowed sample rates of a device.
const RATE_HZ: Range = Range::new(8e3, 1e6, "Hz");
/// Allowed times between tones and sweeps, seconds.
const PAUSE_S: Range = Range::new(0.0, 60.0, "s");

const HEAD: &str = "\
# A sweep that a Slipline device played twice, the second time at half the level. It belongs to the recordings of it:
# slipline calibrate --data a.wav --data b.wav --played THIS_FILE ...
";

/// Why a file is not a description of a sweep.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlayedFileError {
    /// It is not such a TOML file.
    #[error("not a description of a sweep, as slipline sweep writes it: {0}")]
    Text(String),
    /// A number is outside its range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// A newer or older format.
    #[error("{0}")]
    Version(String),
    /// Inconsistent numbers.
    #[error("{0}")]
    Unlike(String),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlayedText {
    slipline_sweep: i64,
    sample_rate_hz: f64,
    from_hz: f64,
    to_hz: f64,
    points: usize,
    level: f64,
    first_hz: f64,
    last_hz: f64,
    ring_s: f64,
    sweep_samples: u64,
    lead_samples: u64,
    pause_samples: u64,
    apart_samples: u64,
    gain: Vec<f64>,
}

impl PlayedSweep {
    /// The description as TOML: numbers in hertz, seconds and samples of the device.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let Chirp { rate_hz, wanted, ends_hz, ring_s, samples } = self.chirp;
        let text = PlayedText {
            slipline_sweep: VERSION,
            sample_rate_hz: rate_hz,
            from_hz: wanted.low_hz,
            to_hz: wanted.high_hz,
            points: wanted.points,
            level: self.level,
            first_hz: ends_hz.0,
            last_hz: ends_hz.1,
            ring_s,
            sweep_samples: samples,
            lead_samples: self.lead,
            pause_samples: self.pause,
            apart_samples: self.apart,
            gain: self.gains.clone(),
        };
        // Numbers and a list of numbers can always be written as TOML.
        format!("{HEAD}{}", toml::to_string(&text).unwrap_or_default())
    }

    /// Whether a text has the form of a description.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        text.lines().any(|line| line.trim_start().starts_with("slipline_sweep"))
    }

    /// Reads a description.
    ///
    /// # Errors
    /// [`PlayedFileError`], with the field and the range if there is one. No text makes this function panic.
    pub fn from_toml(text: &str) -> Result<Self, PlayedFileError> {
        let no_file = |error: toml::de::Error| PlayedFileError::Text(error.message().to_owned());
        let text: PlayedText = toml::from_str(text).map_err(no_file)?;
        if text.slipline_sweep != VERSION {
            let given = format_args!("slipline_sweep = {}", text.slipline_sweep);
            return Err(PlayedFileError::Version(must_be(given, VERSION)));
        }
        let check =
            |field, value, low, high, unit| OutOfRange::check(field, value, Range::new(low, high, unit));
        let rate_hz = text.sample_rate_hz;
        OutOfRange::check("sample_rate_hz", rate_hz, RATE_HZ)?;
        let wanted =
            Wanted { low_hz: text.from_hz, high_hz: text.to_hz, points: text.points, level: text.level };
        wanted.check(rate_hz)?;
        check("first_hz", text.first_hz, 0.01 * text.from_hz, text.from_hz, "Hz")?;
        check("last_hz", text.last_hz, text.to_hz, HIGHEST * rate_hz, "Hz")?;
        check("ring_s", text.ring_s, RING_S.0, 100.0 * RING_S.1, "s")?;
        let seconds = |samples: u64| samples as f64 / rate_hz;
        OutOfRange::check("sweep_samples / sample_rate_hz", seconds(text.sweep_samples), SWEEP_S)?;
        OutOfRange::check("lead_samples / sample_rate_hz", seconds(text.lead_samples), PAUSE_S)?;
        OutOfRange::check("pause_samples / sample_rate_hz", seconds(text.pause_samples), PAUSE_S)?;
        for gain in &text.gain {
            check("gain", *gain, 0.0, 1.0, "")?;
        }
        let unlike = |given: String, allowed: String| Err(PlayedFileError::Unlike(must_be(given, allowed)));
        if text.gain.len() != INTERVALS as usize + 1 {
            return unlike(format!("gain has {} numbers", text.gain.len()), format!("{}", INTERVALS + 1));
        }
        let chirp = Chirp {
            rate_hz,
            wanted,
            ends_hz: (text.first_hz, text.last_hz),
            ring_s: text.ring_s,
            samples: text.sweep_samples,
        };
        let (lead, pause, apart) = (text.lead_samples, text.pause_samples, text.apart_samples);
        if [lead, apart, chirp.samples + pause].iter().any(|samples| samples % BLOCK as u64 != 0) {
            let given = "lead_samples, apart_samples, and sweep_samples with pause_samples";
            return unlike(given.to_owned(), format!("multiples of {BLOCK}"));
        }
        let sweep = Self { level: text.level, chirp, lead, pause, apart, gains: text.gain };
        let (all, least) = (sweep.chirp.samples + pause + lead, sweep.least_apart());
        if apart != all {
            let allowed = format!("{all}, sweep_samples + pause_samples + lead_samples");
            return unlike(format!("apart_samples = {apart}"), allowed);
        }
        if apart < least {
            return unlike(
                format!("apart_samples = {apart}"),
                format!("at least {least}, the sweep, its ring and silence"),
            );
        }
        Ok(sweep)
    }
}
