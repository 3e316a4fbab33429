//! An exponential sweep: its band, its time, and what of the answer to it is taken.

use super::super::error::MeasureError;
use super::super::plan::{HIGHEST, SETTLED, Wanted, time_constant_s};
use super::deconvolution::Gate;
use slipline_link::{BLOCK, DeviceTable};
use slipline_plate::Plate;
use slipline_plate::quantity::{OutOfRange, Range};

/// The plate's time constants in the gate.
const RINGS: f64 = SETTLED;
/// Shortest and longest time to ring, seconds.
pub(super) const RING_S: (f64, f64) = (2e-3, 5.0);
/// What the sweep covers beside the measured band, over the inverse of the time to ring: what the gate spreads stays there.
const MARGIN: f64 = 12.0;
/// Share of the lowest frequency that the margin may be.
const MARGIN_MOST: f64 = 0.5;
/// Highest measured frequency over the sample rate.
const SWEPT_HIGHEST: f64 = 0.4;
/// Length of the gate after the ring, and before the sweep's own time, over the time to ring.
const GATE_AFTER: f64 = 0.25;
/// Times the sweep is slower than the device's fastest, 2^-10 turns a sample in a block of 128.
const SLOWER: f64 = 2.0;
const FASTEST_TURNS: f64 = 1.0 / 1024.0;
/// Least product of the sweep's time and band: below, it is a click rather than a sweep.
const CYCLES: f64 = 100.0;
/// Periods of a limited actuator's resonance that a glide must last.
const RESONANCE_PERIODS: f64 = 2.0;
/// Where W begins and ends to rise, as shares of the margin from the sweep's end: where the sweep is nearly as loud as in the
/// band.
const WEIGHED: (f64, f64) = (0.3, 0.7);

/// One tone that glides exponentially through a band.
#[derive(Debug, Clone, PartialEq)]
pub struct Chirp {
    /// The device's sample rate, Hz.
    pub rate_hz: f64,
    /// What is measured, and how loud.
    pub wanted: Wanted,
    /// The sweep's first and last frequency, Hz.
    pub ends_hz: (f64, f64),
    /// The time in which the plate rings on, seconds.
    pub ring_s: f64,
    /// From the first to the last frequency, samples.
    pub samples: u64,
}

impl Chirp {
    /// The sweep over a plate's band; how long it takes is not decided yet: no samples.
    pub(super) fn over(plate: &Plate, wanted: &Wanted, rate_hz: f64) -> Result<Self, MeasureError> {
        wanted.check(rate_hz)?;
        let highest = Range::new(1.01 * wanted.low_hz, SWEPT_HIGHEST * rate_hz, "Hz");
        OutOfRange::check("to", wanted.high_hz, highest)?;
        let ring_s = (RINGS * time_constant_s(plate, wanted.low_hz)).clamp(RING_S.0, RING_S.1);
        let ring_s = ring_s.max(MARGIN / (MARGIN_MOST * wanted.low_hz));
        let margin_hz = MARGIN / ring_s;
        let ends_hz = (wanted.low_hz - margin_hz, (wanted.high_hz + margin_hz).min(HIGHEST * rate_hz));
        Ok(Self { rate_hz, wanted: *wanted, ends_hz, ring_s, samples: 0 })
    }

    /// The sample that many seconds after another, at the beginning of a block.
    pub(super) fn after(&self, at: u64, seconds: f64) -> u64 {
        at.saturating_add((seconds * self.rate_hz) as u64).next_multiple_of(BLOCK as u64)
    }

    /// The shortest time in which the device can play it, seconds. `glide_s` is what the actuator's travel asks for.
    pub(super) fn shortest_s(&self, glide_s: f64) -> f64 {
        let (first, last) = self.ends_hz;
        let steepest = last * (last / first).ln() * BLOCK as f64 / (self.rate_hz * self.rate_hz);
        (SLOWER * steepest / FASTEST_TURNS).max(CYCLES / (last - first)).max(glide_s)
    }

    /// The same sweep in so many seconds.
    pub(super) fn lasting(mut self, seconds: f64) -> Self {
        self.samples = (seconds * self.rate_hz).floor() as u64;
        self
    }

    /// The time after the sweep's end in which the plate's answer is taken, seconds.
    pub(super) fn tail_s(&self) -> f64 {
        // The block after the sweep's end is silent only where the gain has reached its last knot.
        (1.0 + GATE_AFTER) * self.ring_s + BLOCK as f64 / self.rate_hz
    }

    /// The frequency that is played so many samples after the sweep's beginning, Hz.
    #[must_use]
    pub fn frequency_hz(&self, samples: f64) -> f64 {
        let (first, last) = self.ends_hz;
        first * (last / first).powf((samples / self.samples as f64).clamp(0.0, 1.0))
    }

    /// The frequencies that are measured, Hz.
    #[must_use]
    pub fn measured_hz(&self) -> Vec<f64> {
        (0..self.wanted.points).map(|point| self.wanted.frequency_hz(point)).collect()
    }

    /// What the sweep covers below and above the measured band, Hz.
    pub(super) fn margins_hz(&self) -> (f64, f64) {
        (self.wanted.low_hz - self.ends_hz.0, self.ends_hz.1 - self.wanted.high_hz)
    }

    /// What is taken of the spectrum and of the impulse response.
    pub(super) fn gate(&self) -> Gate {
        let ((first, last), (below, above)) = (self.ends_hz, self.margins_hz());
        Gate {
            rises_hz: (first + WEIGHED.0 * below, first + WEIGHED.1 * below),
            falls_hz: (last - WEIGHED.1 * above, last - WEIGHED.0 * above),
            ring_s: self.ring_s,
            fade_s: GATE_AFTER * self.ring_s,
        }
    }
}

/// How long a glide must be for the actuator's travel, seconds.
pub(super) fn glide_s(table: &DeviceTable) -> f64 {
    table.travel_limit().map_or(0.0, |limit| RESONANCE_PERIODS * 1e6 / limit.resonance_uhz as f64)
}
