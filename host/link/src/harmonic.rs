//! One multiple of a base frequency, in shares and turns, and its conversion to the device's units.

use crate::drive::{self, DriveError};
use crate::out_of_range::OutOfRange;
use slipline_protocol::event::Identity;
use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::units::{Level, Phase};

/// One tone of a chord or a comb.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HarmonicRequest {
    /// The multiple of the base frequency; multiples rise from tone to tone.
    pub harmonic: u16,
    /// Its peak relative to the table's full scale, 0..=1. Beyond an end of the table it is relative to that end's gain.
    pub level: f64,
    /// Phase at its start, in turns.
    pub phase_turns: f64,
}

/// Multiples of a base frequency in a device's units, each converted to its command's type by `tone`.
/// `highest` is the largest multiple.
pub(crate) fn harmonics<T>(
    requests: &[HarmonicRequest],
    highest: f64,
    identity: &Identity,
    tone: impl Fn(u16, Level, Phase) -> T,
) -> Result<heapless::Vec<T, MAX_TONES>, DriveError> {
    let too_many = || DriveError::TooManyTones { got: requests.len(), max: identity.tones };
    if requests.len() > usize::from(identity.tones) {
        return Err(too_many());
    }
    let mut tones = heapless::Vec::new();
    for (slot, request) in (0..).zip(requests) {
        let refuse = |value| DriveError::Tone { slot, value };
        let harmonic = f64::from(request.harmonic);
        OutOfRange::check("multiple of the base frequency", harmonic, 1.0, highest).map_err(refuse)?;
        let level = drive::level(request.level).map_err(refuse)?;
        let phase = drive::phase(request.phase_turns).map_err(refuse)?;
        tones.push(tone(request.harmonic, level, phase)).map_err(|_| too_many())?;
    }
    Ok(tones)
}
