//! An exponential sweep: its band, its duration, and the gate of its response.

use super::super::error::MeasureError;
use super::super::plan::{HIGHEST, SETTLED, Wanted, time_constant_s};
use super::deconvolution::Gate;
use slipline_link::{BLOCK, DeviceTable};
use slipline_plate::Plate;
use slipline_plate::quantity::{OutOfRange, Range};

/// Time constants of the plate within the gate.
const RINGS: f64 = SETTLED;
/// Shortest and longest time to ring, seconds.
pub(super) const RING_S: (f64, f64) = (2e-3, 5.0);
/// Extra bandwidth of the sweep beside the measured band, times the ring time: spectral spread of the gate
/// stays within it.
const MARGIN: f64 = 12.0;
/// Largest margin as a share of the lowest frequency.
const MARGIN_MOST: f64 = 0.5;
/// Highest measured frequency over the sample rate.
const SWEPT_HIGHEST: f64 = 0.4;
/// Length of the gate after the ring, and before the sweep's own time, over the time to ring.
const GATE_AFTER: f64 = 0.25;
/// Factor by which the sweep is slower than the device's fastest, 2^-10 turns per sample in a block of 128.
const SLOWER: f64 = 2.0;
const FASTEST_TURNS: f64 = 1.0 / 1024.0;
/// Smallest product of the sweep's duration and bandwidth: below, it is a click rather than a sweep.
const CYCLES: f64 = 100.0;
/// Shortest glide in periods of a limited actuator's resonance.
const RESONANCE_PERIODS: f64 = 2.0;
/// Begin and end of W's rise, as shares of the margin from the sweep's end: there the sweep is nearly as loud
/// as in the band.
const WEIGHED: (f64, f64) = (0.3, 0.7);

/// One tone that glides exponentially through a band.
#[derive(Debug, Clone, PartialEq)]
pub struct Chirp {
    /// The device's sample rate, Hz.
    pub rate_hz: f64,
    /// The measured band and level.
    pub wanted: Wanted,
    /// The sweep's first and last frequency, Hz.
    pub ends_hz: (f64, f64),
    /// The ring time of the plate, seconds.
    pub ring_s: f64,
    /// Samples from the first to the last frequency.
    pub samples: u64,
}

impl Chirp {
    /// The sweep over a plate's band; its duration is not yet chosen, so it has no samples.
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

    /// The first sample of the block that begins `seconds` after `at`, or later.
    pub(super) fn after(&self, at: u64, seconds: f64) -> u64 {
        at.saturating_add((seconds * self.rate_hz) as u64).next_multiple_of(BLOCK as u64)
    }

    /// The shortest duration in which the device can play it, seconds. `glide_s` is the shortest for the
    /// actuator's travel.
    pub(super) fn shortest_s(&self, glide_s: f64) -> f64 {
        let (first, last) = self.ends_hz;
        let steepest = last * (last / first).ln() * BLOCK as f64 / (self.rate_hz * self.rate_hz);
        (SLOWER * steepest / FASTEST_TURNS).max(CYCLES / (last - first)).max(glide_s)
    }

    /// The same sweep with this duration, seconds.
    pub(super) fn lasting(mut self, seconds: f64) -> Self {
        self.samples = (seconds * self.rate_hz).floor() as u64;
        self
    }

    /// Duration of the capture after the sweep's end, seconds.
    pub(super) fn tail_s(&self) -> f64 {
        // The block after the sweep's end is silent only where the gain has reached its last knot.
        (1.0 + GATE_AFTER) * self.ring_s + BLOCK as f64 / self.rate_hz
    }

    /// The frequency played at this number of samples after the sweep's beginning, Hz.
    #[must_use]
    pub fn frequency_hz(&self, samples: f64) -> f64 {
        let (first, last) = self.ends_hz;
        first * (last / first).powf((samples / self.samples as f64).clamp(0.0, 1.0))
    }

    /// The frequencies that are measured, Hz. No tone rests at the hum of the mains, which the gate spreads over its own width.
    #[must_use]
    pub fn measured_hz(&self) -> Vec<f64> {
        let Wanted { low_hz, high_hz, points, .. } = self.wanted;
        (0..points)
            .map(|point| low_hz * (high_hz / low_hz).powf(point as f64 / (points - 1) as f64))
            .collect()
    }

    /// The width of the sweep's margins below and above the measured band, Hz.
    pub(super) fn margins_hz(&self) -> (f64, f64) {
        (self.wanted.low_hz - self.ends_hz.0, self.ends_hz.1 - self.wanted.high_hz)
    }

    /// The gate in frequency and time.
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

/// Shortest glide for the actuator's travel, seconds.
pub(super) fn glide_s(table: &DeviceTable) -> f64 {
    table.travel_limit().map_or(0.0, |limit| RESONANCE_PERIODS * 1e6 / limit.resonance_uhz as f64)
}
