//! A sweep that is played twice for a separate recorder, and its description.
//!
//! ```text
//! tone 1   |silent|<--- sweep, level ---->|ring ... silence|                                          slot 0
//! tone 2                                         |  silent |<--- sweep, half the level ---->|ring|    slot 1
//!          0      lead                           |        lead + apart
//!                                                lead + samples + pause
//! ```
//! Each tone and sweep begins at the first sample of a block, and the description contains all times, so it
//! determines every code. The recorder's clock follows from the time between the two sweeps, its gain from
//! the ratio of their levels, and its noise from the silence between them.

mod file;

pub use file::{PLAYED_BYTES_MAX, PlayedFileError};

use super::chirp::{self, Chirp};
use super::plan::LONGEST_S;
use super::table;
use crate::measure::answers::CODES;
use crate::measure::error::MeasureError;
use crate::measure::plan::Wanted;
use slipline_link::mirror::Mirror;
use slipline_link::protocol::command::{Apply, Drive, Tone};
use slipline_link::protocol::limits::MIN_GLIDE_MS;
use slipline_link::protocol::units::{CentiDecibel, Phase, Position};
use slipline_link::{BLOCK, DeviceTable, DriveRequest, Request, Sounding, ToneRequest};
use slipline_plate::Plate;
use slipline_plate::quantity::{OutOfRange, Range};

/// Level of the second sweep over that of the first.
pub const QUIETER: f64 = 0.5;
/// Allowed duration of one sweep, seconds.
pub const SWEEP_S: Range = Range::new(0.01, LONGEST_S, "s");
/// Silence between the first sweep's ring and the second sweep, seconds: the noise is measured in it.
const SILENCE_S: f64 = 1.0;
/// Time from a silent tone to its glide, seconds; the host sends a request within it.
const LEAD_S: f64 = 0.5;
/// Peak stated in a table whose peak is not used, metres.
const ANY_PEAK_M: f64 = 1e-6;

/// One sweep, played twice: the second time at half the level.
///
/// ```
/// use slipline_instrument::measure::{PlayedSweep, Wanted};
/// use slipline_model::field::simulation::table_for;
///
/// let plate = slipline_plate::preset("al-bending").unwrap();
/// let (_, table) = table_for(&plate, 400_000).unwrap();
/// let sweep = PlayedSweep::new(&plate, &table, &Wanted::of(&plate), 400e3, 0.1).unwrap();
/// let read = PlayedSweep::from_toml(&sweep.to_toml()).unwrap();
/// assert_eq!(read, sweep);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PlayedSweep {
    /// The sweep.
    pub(super) chirp: Chirp,
    /// Level of the first sweep, as a share of the table's full scale.
    pub(super) level: f64,
    /// Samples from a silent tone to its glide.
    pub(super) lead: u64,
    /// Samples from the first sweep's end to the second tone.
    pub(super) pause: u64,
    /// Samples from the first sweep's beginning to the second one's.
    pub(super) apart: u64,
    /// Gain of the sweep at each knot of its table, over the level.
    pub(super) gains: Vec<f64>,
}

/// Codes of both sweeps at the DAC, over its full scale, each from the sweep's beginning.
pub(super) struct Codes {
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
}

impl PlayedSweep {
    /// The sweep over a plate's band with this duration, seconds.
    ///
    /// # Errors
    /// [`MeasureError::OutOfRange`]: a number is out of its range; [`MeasureError::Rings`] if the sweep is
    /// too slow for the device.
    pub fn new(
        plate: &Plate,
        table: &DeviceTable,
        wanted: &Wanted,
        rate_hz: f64,
        seconds: f64,
    ) -> Result<Self, MeasureError> {
        let chirp = Chirp::over(plate, wanted, rate_hz)?;
        let glide_s = chirp::glide_s(table);
        let shortest_s = chirp.shortest_s(glide_s);
        if shortest_s > LONGEST_S {
            return Err(MeasureError::Rings { seconds: chirp.ring_s });
        }
        OutOfRange::check("time", seconds, Range { low: shortest_s.max(SWEEP_S.low), ..SWEEP_S })?;
        let chirp = chirp.lasting(seconds);
        let gains = table::gains(&chirp, table);
        let sweep = Self { level: wanted.level, chirp, lead: 0, pause: 0, apart: 0, gains };
        Ok(sweep.with_lead(LEAD_S + glide_s))
    }

    /// The shortest time from the first sweep to the second one, samples.
    fn least_apart(&self) -> u64 {
        // A recorder knows a sweep's beginning to within a ring, and its window fades.
        let silence = (self.chirp.tail_s() + 1.5 * self.chirp.ring_s + SILENCE_S) * self.chirp.rate_hz;
        self.chirp.samples + silence as u64
    }

    /// The same with another time from the silent tones to their glides, seconds.
    pub(super) fn with_lead(mut self, lead_s: f64) -> Self {
        let blocks = |seconds: f64| ((seconds * self.chirp.rate_hz) as u64).next_multiple_of(BLOCK as u64);
        let requests = self.chirp.samples + blocks(2.0 * lead_s);
        (self.lead, self.apart) =
            (blocks(lead_s), self.least_apart().max(requests).next_multiple_of(BLOCK as u64));
        self.pause = self.apart - self.lead - self.chirp.samples;
        self
    }

    /// The sweep.
    #[must_use]
    pub const fn chirp(&self) -> &Chirp {
        &self.chirp
    }

    /// Level of the first sweep, as a share of the table's full scale.
    #[must_use]
    pub const fn level(&self) -> f64 {
        self.level
    }

    /// Time from the first sweep's beginning to the second one's, seconds.
    #[must_use]
    pub fn apart_s(&self) -> f64 {
        self.apart as f64 / self.chirp.rate_hz
    }

    /// Time from the first tone to the end of the ring after the second sweep, seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.end() as f64 / self.chirp.rate_hz
    }

    /// Gain of the sweep at a frequency, over its level; interpolated between knots as in the device.
    pub(super) fn gain(&self, frequency_hz: f64) -> f64 {
        let (first, last) = self.chirp.ends_hz;
        let knots = self.gains.len() - 1;
        let place = knots as f64 * ((frequency_hz / first).ln() / (last / first).ln()).clamp(0.0, 1.0);
        let below = (place as usize).min(knots - 1);
        let share = place - below as f64;
        self.gains[below] * (1.0 - share) + self.gains[below + 1] * share
    }

    /// The sample at which the plate has stopped ringing.
    pub(super) fn end(&self) -> u64 {
        let tail = (self.chirp.tail_s() * self.chirp.rate_hz).ceil() as u64;
        (self.lead + self.apart + self.chirp.samples + tail).next_multiple_of(BLOCK as u64)
    }

    /// The drives of both tones and both glides.
    pub(super) fn score(&self) -> [Move; 4] {
        let tone = |slot: u8, at: u64, level: f64| {
            let (first, last) = table::ENDS_M;
            [
                Move { at, slot, level, to_m: first, glide: 0 },
                Move { at: at + self.lead, slot, level, to_m: last, glide: self.chirp.samples },
            ]
        };
        let second = self.lead + self.chirp.samples + self.pause;
        let [[a, b], [c, d]] = [tone(0, 0, self.level), tone(1, second, QUIETER * self.level)];
        [a, b, c, d]
    }

    /// All codes from the first tone to the end, as the device application generates them.
    pub(super) fn rendered(&self) -> Result<Vec<u16>, MeasureError> {
        let table = table::with_gains(&self.chirp, &self.gains, ANY_PEAK_M)?;
        // The table is in force some blocks before the first tone.
        let begin = 64 * BLOCK as u64;
        let mut mirror = Mirror::new(self.chirp.rate_hz as u32, 0);
        let known = mirror.acknowledge_table(table.knots().into(), 0);
        let mut known = known.is_ok();
        for step in self.score() {
            known &= mirror.acknowledge_play(step.drive(&table), begin + step.at).is_ok();
        }
        let mut codes = Vec::with_capacity(self.end() as usize);
        mirror.render(begin + self.end(), |first, block| {
            if first >= begin {
                codes.extend_from_slice(block);
            }
        });
        if known && mirror.is_true() { Ok(codes) } else { Err(MeasureError::Unknown) }
    }

    /// The codes of both sweeps.
    pub(super) fn codes(&self) -> Result<Codes, MeasureError> {
        let all = self.rendered()?;
        let length = (self.chirp.samples as usize).next_multiple_of(BLOCK) + BLOCK;
        let from = |begin: u64| {
            let codes = all.iter().skip(begin as usize).take(length);
            codes.map(|&code| f64::from(code) / CODES - 1.0).collect()
        };
        Ok(Codes { first: from(self.lead), second: from(self.lead + self.apart) })
    }
}

/// A drive of the sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Move {
    /// Start, samples after the first tone.
    pub(super) at: u64,
    pub(super) slot: u8,
    pub(super) level: f64,
    /// Target: an end of the table, metres.
    pub(super) to_m: f64,
    /// Duration of the glide, samples.
    pub(super) glide: u64,
}

impl Move {
    /// The request, where the first tone begins at sample `from`.
    pub(super) fn request(&self, rate_hz: f64, from: u64) -> Request {
        let tone =
            ToneRequest { slot: self.slot, boundary_m: self.to_m, level: self.level, phase_turns: 0.0 };
        let (glide_s, apply) = (self.glide as f64 / rate_hz, Apply::At(from + self.at));
        Request::Play(Sounding::Drive(DriveRequest { glide_s, apply, ..DriveRequest::of(vec![tone]) }))
    }

    /// The drive in the device's units.
    fn drive(&self, table: &DeviceTable) -> Drive {
        let position = table.position(self.to_m).unwrap_or(Position(0));
        let level = slipline_link::level(self.level).unwrap_or_default();
        let tone = Tone { slot: self.slot, position, level, phase: Phase(0) };
        let shortest = u64::from(table.header().sample_rate_hz) * u64::from(MIN_GLIDE_MS) / 1000;
        Drive {
            tones: [tone].into_iter().collect(),
            master: CentiDecibel(0),
            glide: u32::try_from(self.glide.max(shortest)).unwrap_or(u32::MAX),
            apply: Apply::Next,
        }
    }
}

#[cfg(test)]
mod tests;
