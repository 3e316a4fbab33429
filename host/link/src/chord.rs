//! A chord in shares and seconds, its conversion to the device's units, and with the feature `mirror` its peak by the device's
//! own computation.

#[cfg(feature = "mirror")]
mod peak;

#[cfg(feature = "mirror")]
pub use self::peak::extent;
use crate::drive::{self, DriveError};
use crate::harmonic::{HarmonicRequest, harmonics};
use crate::out_of_range::OutOfRange;
use slipline_protocol::command::{Apply, Chord, ChordTone, TravelLimit};
use slipline_protocol::event::Identity;
use slipline_protocol::limits::{CHORD_PERIOD_LOG2, MAX_HARMONIC};

/// Tones that are multiples of the base frequency `rate / 2^period_log2`, so that they repeat exactly. They
/// begin in silence. Their sum is limited by its peak, which the device computes before it accepts the chord.
///
/// ```
/// use slipline_link::{ChordRequest, DeviceTable, HarmonicRequest, Request, Sounding};
/// use slipline_link::simulator::loopback::Loopback;
/// use std::sync::Arc;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut loopback = Loopback::connect(400_000)?;
/// let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
/// let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6)?;
/// loopback.perform(Request::Upload(Arc::new(table)), |_| ())?;
/// // 21.5, 22.3 and 23 kHz: multiples of 400 kHz / 4096. Their levels add up to 1.2, their peak is less.
/// let tone = |harmonic, phase_turns| HarmonicRequest { harmonic, level: 0.4, phase_turns };
/// let chord = ChordRequest::of(12, vec![tone(220, 0.0), tone(228, 0.25), tone(236, 0.0)]);
/// let mut highest = 0;
/// loopback.perform(Request::Play(Sounding::Chord(chord)), |_| ())?;
/// loopback.pass(20_000, |codes| highest = codes.iter().copied().max().unwrap_or(0).max(highest));
/// assert!(highest > 3500 && highest <= 4095);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ChordRequest {
    /// The binary logarithm of the period in samples, 7..=14.
    pub period_log2: u8,
    /// The tones, 1 to 16.
    pub tones: Vec<HarmonicRequest>,
    /// Master level of all tones, in dB, -96..=0.
    pub master_db: f64,
    /// Rise time from silence, in seconds; rounded to the nearest time that the device supports.
    pub glide_s: f64,
    /// When the chord begins.
    pub apply: Apply,
}

impl ChordRequest {
    /// A chord at full master level that begins at once and rises in 20 ms.
    #[must_use]
    pub const fn of(period_log2: u8, tones: Vec<HarmonicRequest>) -> Self {
        Self { period_log2, tones, master_db: 0.0, glide_s: 0.02, apply: Apply::Next }
    }

    /// Converts the chord to the device's units. A travel limit extends the rise to the time that the
    /// actuator needs to follow.
    ///
    /// # Errors
    /// [`DriveError`], naming the value and its range. The device checks that the multiples rise, that they
    /// lie within the table's frequencies, and that the peak fits.
    pub fn for_device(&self, identity: &Identity, travel: Option<&TravelLimit>) -> Result<Chord, DriveError> {
        let (shortest, longest) = CHORD_PERIOD_LOG2;
        let (least, most) = (shortest.into(), longest.into());
        OutOfRange::check("chord's period (log2 of samples)", self.period_log2.into(), least, most)?;
        let tone = |harmonic, level, phase| ChordTone { harmonic, level, phase };
        Ok(Chord {
            period_log2: self.period_log2,
            tones: harmonics(&self.tones, MAX_HARMONIC.into(), identity, tone)?,
            master: drive::master(self.master_db)?,
            glide: drive::glide(self.glide_s, identity, travel)?,
            apply: self.apply,
        })
    }
}
