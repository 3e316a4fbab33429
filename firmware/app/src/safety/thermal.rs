//! The coil's temperature, computed from what is sent to it.
//!
//! The temperature rise, 1 = its limit, is the sum of two first-order parts, winding and body:
//! ```text
//! T = (w + b) / 2,   dw/dt = (P - w) / 8 s,   db/dt = (P - b) / 120 s,   P = 1.3 (mean square / that of a full sine)
//! ```
//! so from cold a full-scale sine may sound for half a minute, but not for ever. Between [`WARN`] and the limit the
//! amplitude is folded back linearly to a half; a half of full scale can sound for ever (`P` = 0.33). The constants
//! are starting values for a voice coil of some tens of grams, on the safe side; the profile of a board's actuator changes them.

use micromath::F32Ext;
use slipline_dds::bank::code;
use slipline_protocol::profile::CoilHeat;
use slipline_protocol::units::SampleIndex;

/// The winding's time constant, in seconds.
pub const WINDING_S: f32 = 8.0;
/// The body's time constant, in seconds.
pub const BODY_S: f32 = 120.0;
/// The temperature rise that a full-scale sine would reach, 1 = the limit.
pub const FULL_SINE: f32 = 1.3;
/// Temperature rise above which the amplitude is folded back, 1 = the limit.
pub const WARN: f32 = 0.8;
/// Factor on the amplitude at the limit.
pub const FLOOR: f32 = 0.5;

/// The constants of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoilConstants {
    winding_s: f32,
    body_s: f32,
    full_sine: f32,
}

impl CoilConstants {
    /// The numbers of a device without a profile.
    pub const DEFAULT: Self = Self { winding_s: WINDING_S, body_s: BODY_S, full_sine: FULL_SINE };

    /// The numbers of a profile.
    #[must_use]
    pub fn of(heat: &CoilHeat) -> Self {
        Self {
            winding_s: heat.winding_ms as f32 / 1000.0,
            body_s: heat.body_ms as f32 / 1000.0,
            full_sine: f32::from(heat.full_sine_per_mille) / 1000.0,
        }
    }
}

/// What is known about the coil's temperature at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heat {
    /// It is cold: a simulated one.
    Cold,
    /// It may be at its limit: a reset must not make the model cooler than the coil. At rest this folds the amplitude
    /// back for some seconds only, because the winding cools quickly.
    AssumedHot,
}

/// The model's state.
#[derive(Clone, Copy, Debug)]
pub struct Thermal {
    constants: CoilConstants,
    winding: f32,
    body: f32,
    /// When it was last advanced; `None` before the first time.
    at: Option<SampleIndex>,
    energy: u64,
}

impl Thermal {
    /// A coil at the start.
    #[must_use]
    pub const fn new(heat: Heat) -> Self {
        let rise = match heat {
            Heat::Cold => 0.0,
            Heat::AssumedHot => 1.0,
        };
        Self { constants: CoilConstants::DEFAULT, winding: rise, body: rise, at: None, energy: 0 }
    }

    /// Goes on with these constants; the rise stays.
    pub const fn set_constants(&mut self, constants: CoilConstants) {
        self.constants = constants;
    }

    /// Goes on to `now`, up to which the squares of all codes' distances from mid-scale add up to `energy`.
    ///
    /// That may be less than last time: a stop that begins in a counted block removes the heat of the samples that
    /// it silences. The temperature falls with it.
    pub fn advance(&mut self, now: SampleIndex, energy: u64, sample_rate_hz: u32) {
        let samples = now.saturating_sub(*self.at.get_or_insert(now));
        if samples == 0 || sample_rate_hz == 0 {
            return;
        }
        const FULL_SINE_SQUARE: f32 = {
            let swing = (code::MAX_CODE - code::MID_SCALE) as f32;
            swing * swing / 2.0
        };
        let mean_square = energy.wrapping_sub(self.energy).cast_signed() as f32 / samples as f32;
        let CoilConstants { winding_s, body_s, full_sine } = self.constants;
        let power = full_sine * mean_square / FULL_SINE_SQUARE;
        let seconds = samples as f32 / sample_rate_hz as f32;
        self.winding += share(seconds / winding_s) * (power - self.winding);
        self.body += share(seconds / body_s) * (power - self.body);
        self.at = Some(now);
        self.energy = energy;
    }

    /// The temperature rise, 1 = its limit.
    #[must_use]
    pub fn rise(&self) -> f32 {
        f32::midpoint(self.winding, self.body)
    }

    /// Whether the limit is passed: the fold-back has failed to hold it.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.is_above(1.0)
    }

    /// Whether the coil is warm enough to fold back.
    #[must_use]
    pub fn is_warm(&self) -> bool {
        self.is_above(WARN)
    }

    /// Whether the rise is above a threshold. A NaN is above all: it must count as hot.
    fn is_above(&self, threshold: f32) -> bool {
        self.rise().is_nan() || self.rise() > threshold
    }

    /// Factor of the fold-back on the amplitude, per mille. The status carries this very number, so a mirror has the exact
    /// limit.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "lies in FLOOR..1, times 1000")]
    pub fn limit_per_mille(&self) -> u16 {
        if !self.is_warm() {
            return 1000;
        }
        let over = ((self.rise() - WARN) / (1.0 - WARN)).clamp(0.0, 1.0);
        let left = 1.0 - over * (1.0 - FLOOR);
        // A NaN becomes 0: nothing is left.
        (left * 1000.0) as u16
    }

    /// The temperature rise in per mille of its limit.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "the cast saturates")]
    pub fn per_mille(&self) -> u16 {
        (self.rise() * 1000.0) as u16
    }
}

/// `1 - e^-x`, without the cancellation that would stop slow time constants at fast ticks.
fn share(x: f32) -> f32 {
    if x < 0.01 { x - x * x / 2.0 + x * x * x / 6.0 } else { 1.0 - F32Ext::exp(-x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: u32 = 400_000;
    const FULL_SQUARE: u64 = 2047 * 2047 / 2;

    /// Drives with a full sine times `limit` where `obey` says so, for whole ticks of 1024 samples.
    fn run(thermal: &mut Thermal, seconds: f64, on: bool, obey: bool) {
        thermal.advance(0, 0, RATE);
        let ticks = (seconds * f64::from(RATE) / 1024.0) as u64;
        for _ in 0..ticks {
            let limit = if obey { f64::from(thermal.limit_per_mille()) / 1000.0 } else { 1.0 };
            let square = if on { (FULL_SQUARE as f64 * limit * limit) as u64 } else { 0 };
            let (at, energy) = (thermal.at.unwrap_or(0) + 1024, thermal.energy.wrapping_add(square * 1024));
            thermal.advance(at, energy, RATE);
        }
    }

    fn analytic(t: f64) -> f64 {
        1.3 * (1.0 - 0.5 * (-t / 8.0).exp() - 0.5 * (-t / 120.0).exp())
    }

    #[test]
    fn a_stop_within_a_counted_block_takes_its_heat_back() {
        let (mut stopped, mut shorter) = (Thermal::new(Heat::Cold), Thermal::new(Heat::Cold));
        for thermal in [&mut stopped, &mut shorter] {
            thermal.advance(0, 0, RATE);
        }
        stopped.advance(1024, 1024 * FULL_SQUARE, RATE);
        // A tenth of the last block is played, and then nothing.
        let played = 1024 * FULL_SQUARE - 128 * FULL_SQUARE * 9 / 10;
        stopped.advance(2048, played, RATE);
        shorter.advance(2048, played, RATE);
        assert!(!stopped.is_warm() && (stopped.rise() - shorter.rise()).abs() < 1e-6, "{}", stopped.rise());
    }

    #[test]
    fn a_full_sine_heats_as_the_two_time_constants_say() {
        let mut thermal = Thermal::new(Heat::Cold);
        for second in 1..=60 {
            run(&mut thermal, 1.0, true, false);
            let want = analytic(f64::from(second));
            assert!(
                (f64::from(thermal.rise()) / want - 1.0).abs() < 0.01,
                "{second} s: {} {want}",
                thermal.rise()
            );
        }
    }

    #[test]
    fn one_long_step_heats_as_many_short_ones() {
        for seconds in [1u32, 10, 60] {
            let mut thermal = Thermal::new(Heat::Cold);
            thermal.advance(0, 0, RATE);
            let samples = u64::from(seconds) * u64::from(RATE);
            thermal.advance(samples, FULL_SQUARE * samples, RATE);
            let want = analytic(f64::from(seconds));
            assert!((f64::from(thermal.rise()) / want - 1.0).abs() < 0.02, "{seconds} s: {thermal:?} {want}");
            assert_eq!(thermal.per_mille(), (thermal.rise() * 1000.0) as u16);
            assert!(thermal.per_mille() > 50);
        }
    }

    #[test]
    fn the_foldback_is_linear_from_warm_to_the_limit() {
        for (rise, left) in [(0.5, 1000), (0.79, 1000), (0.85, 875), (0.9, 750), (1.0, 500), (2.0, 500)] {
            let thermal = Thermal { winding: rise, body: rise, ..Thermal::new(Heat::Cold) };
            assert!(thermal.limit_per_mille().abs_diff(left) <= 1, "{rise}: {}", thermal.limit_per_mille());
            assert_eq!(thermal.is_warm(), rise > WARN);
        }
    }

    #[test]
    fn a_coil_that_is_assumed_hot_is_folded_back_for_less_than_4_seconds_of_rest() {
        for (seconds, is_warm) in [(3.5, true), (4.0, false)] {
            let mut thermal = Thermal::new(Heat::AssumedHot);
            thermal.advance(0, 0, RATE);
            for step in 1..=100 {
                thermal.advance((f64::from(step) / 100.0 * seconds * f64::from(RATE)) as u64, 0, RATE);
            }
            assert_eq!(thermal.is_warm(), is_warm, "{seconds} s: {}", thermal.rise());
        }
    }

    #[test]
    fn the_foldback_alone_holds_the_limit_for_ever() {
        let mut thermal = Thermal::new(Heat::Cold);
        for _ in 0..3600 {
            run(&mut thermal, 1.0, true, true);
            assert!(!thermal.is_over());
        }
        assert!(thermal.is_warm());
    }

    #[test]
    fn a_drive_that_ignores_the_foldback_is_over_the_limit() {
        let mut thermal = Thermal::new(Heat::Cold);
        run(&mut thermal, 300.0, true, false);
        assert!(thermal.is_over());
    }

    #[test]
    fn a_coil_that_is_assumed_hot_is_folded_back_to_the_floor_and_cools_at_rest() {
        let mut thermal = Thermal::new(Heat::AssumedHot);
        assert!(!thermal.is_over());
        assert_eq!(thermal.limit_per_mille(), 500);
        run(&mut thermal, 10.0, false, true);
        assert_eq!(thermal.limit_per_mille(), 1000);
    }

    #[test]
    fn a_temperature_that_is_no_number_counts_as_hot() {
        let thermal = Thermal { winding: f32::NAN, ..Thermal::new(Heat::Cold) };
        assert!(thermal.is_over() && thermal.is_warm());
        assert_eq!(thermal.limit_per_mille(), 0);
    }
}
