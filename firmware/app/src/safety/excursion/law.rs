//! Travel of a mass on a spring under a tone, as a share of the allowed travel.
//!
//! ```text
//! share(r) = static_share / sqrt((1 - r^2)^2 + (r / Q)^2),   r = f / f0
//! ```
//! In 32-bit floats, which every machine computes alike. The square root is by Newton's method, because the estimate of
//! `micromath` is off by some per cent. All that is rounded is far below [`SAFE`], by which the share is too large.

use micromath::F32Ext;
use slipline_protocol::command::TravelLimit;

/// Steps of a turn: what a phase step counts.
const TURN: f32 = 4_294_967_296.0;
/// The share is larger than the truth by this factor at least: near a sharp resonance (Q = 1000) the rounded ratio of
/// the frequencies alone makes an error of some 1e-4.
const SAFE: f32 = 1.001;

/// A limit, prepared for phase steps of one sample rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law {
    /// The ratio r of one phase step (Q0.32).
    ratio_per_step: f32,
    /// 1/Q.
    damping: f32,
    /// The share of a frequency far below the resonance.
    static_share: f32,
    /// The frequency ratio r at which the share of the allowed travel is largest; `None` if the share falls with r.
    peak: Option<f32>,
}

impl Law {
    pub(super) fn new(limit: &TravelLimit, sample_rate_hz: u32) -> Self {
        let resonance_hz = limit.resonance_uhz as f32 * 1e-6;
        let damping = 1000.0 / limit.quality_per_mille as f32;
        let square = 1.0 - 0.5 * damping * damping;
        Self {
            ratio_per_step: sample_rate_hz as f32 / (TURN * resonance_hz),
            damping,
            static_share: SAFE * 1e-6 * limit.static_ppm as f32,
            peak: (square > 0.0).then(|| root(square)),
        }
    }

    /// The share of a tone of full scale with this phase step (Q0.32).
    pub(super) fn share(&self, step: u32) -> f32 {
        self.at_ratio(self.ratio(step))
    }

    /// The largest share of all phase steps from one to another, in either order.
    pub(super) fn largest(&self, from: u32, to: u32) -> f32 {
        let (from, to) = (self.ratio(from), self.ratio(to));
        let at_ends = self.at_ratio(from).max(self.at_ratio(to));
        match self.peak {
            Some(peak) if from.min(to) < peak && peak < from.max(to) => at_ends.max(self.at_ratio(peak)),
            _ => at_ends,
        }
    }

    fn ratio(&self, step: u32) -> f32 {
        step as f32 * self.ratio_per_step
    }

    fn at_ratio(&self, ratio: f32) -> f32 {
        // As a product, which avoids cancellation near the resonance.
        let spring = (1.0 - ratio) * (1.0 + ratio);
        let damper = ratio * self.damping;
        let share = self.static_share / root(spring * spring + damper * damper);
        if share.is_nan() { f32::INFINITY } else { share }
    }
}

/// The square root of a number above 0, to a few units of its last place.
fn root(square: f32) -> f32 {
    // The estimate is off by 6 % at most; each step squares the error and halves it.
    let mut root = F32Ext::sqrt(square);
    for _ in 0..3 {
        root = 0.5 * (root + square / root);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RATE: u32 = 400_000;

    fn limit(resonance_hz: f64, quality: f64, static_share: f64) -> TravelLimit {
        TravelLimit {
            resonance_uhz: (resonance_hz * 1e6) as u64,
            quality_per_mille: (quality * 1e3) as u32,
            static_ppm: (static_share * 1e6) as u32,
        }
    }

    fn step(hz: f64) -> u32 {
        (hz / f64::from(RATE) * 4_294_967_296.0) as u32
    }

    #[test]
    fn the_share_below_at_and_above_the_resonance_is_the_springs_the_dampers_and_the_masss() {
        let law = Law::new(&limit(50.0, 8.0, 0.25), RATE);
        for (hz, want) in [(0.5, 0.25), (50.0, 0.25 * 8.0), (50_000.0, 0.25 * 1e-6)] {
            let share = f64::from(law.share(step(hz)));
            assert!((1.0..1.0025).contains(&(share / want)), "{hz} Hz: {share} {want}");
        }
    }

    #[test]
    fn the_square_root_is_within_3e_7_of_the_exact_one() {
        for square in [1e-30_f32, 1e-9, 0.3, 1.0, 2.0, 7.7e11, 1e30] {
            let error = f64::from(root(square)) / f64::from(square).sqrt() - 1.0;
            assert!(error.abs() < 3e-7, "{square}: {error}");
        }
    }

    proptest! {
        #[test]
        fn the_share_is_never_below_the_truth_and_hardly_above_it(
            resonance_hz in 1.0..100_000.0,
            quality in 0.1..1000.0,
            ratio in prop_oneof![0.01..3.0, 0.99..1.01],
        ) {
            let step = step(resonance_hz * ratio).clamp(1, u32::MAX / 2);
            let law = Law::new(&limit(resonance_hz, quality, 0.5), RATE);
            // The numbers in the wire's units and the step's.
            let quality = f64::from((quality * 1e3) as u32) / 1e3;
            let ratio = f64::from(step) * f64::from(RATE) / 4_294_967_296.0 / ((resonance_hz * 1e6) as u64 as f64 * 1e-6);
            let truth = 0.5 / ((1.0 - ratio * ratio).powi(2) + (ratio / quality).powi(2)).sqrt();
            let found = f64::from(law.share(step)) / truth;
            prop_assert!((1.0..1.002).contains(&found), "{found}");
        }

        #[test]
        fn no_step_between_two_has_a_larger_share_than_the_largest(
            quality in 0.1..1000.0,
            from in 1.0..200.0,
            to in 1.0..200.0,
            part in 0.0..=1.0,
        ) {
            let law = Law::new(&limit(50.0, quality, 0.5), RATE);
            let largest = law.largest(step(from), step(to));
            let share = law.share(step(from + part * (to - from)));
            // The share that is computed at the peak may be the last place of one beside it.
            prop_assert!(share <= largest * 1.0005, "{share} {largest}");
        }
    }
}
