//! The travel of an actuator and its limit. Without it in the plate file, the DAC alone limits the levels.

use crate::definition::error::{Origin, PlateError};
use crate::definition::limits;
use crate::quantity::Range;

/// Travel of an actuator at DAC full scale and its limit, both as a distance from rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    /// Largest distance of the moving part from rest, metres (1e-9 to 0.1): Xmax of a data sheet.
    pub peak_m: f64,
    /// Distance from rest under a constant signal at DAC full scale, metres (1e-9 to 0.1, at most 1000 times
    /// `peak_m`).
    pub static_m: f64,
}

impl Travel {
    pub(crate) fn validate(&self) -> Result<(), PlateError> {
        limits::TRAVEL.check("actuator.peak_travel_m", self.peak_m)?;
        let most_m = limits::TRAVEL_RATIO_MAX * self.peak_m;
        if most_m < limits::TRAVEL.high {
            let range = Range::new(limits::TRAVEL.low, most_m, "m");
            let origin = Origin::PeakTravel(self.peak_m);
            range.check_from(origin, "actuator.static_travel_m", self.static_m)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::actuator::Resonator;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn voice_coil(quality: f64) -> Resonator {
        let travel = Travel { peak_m: 1e-3, static_m: 2e-3 };
        Resonator { resonance_hz: 50.0, quality, travel: Some(travel) }
    }

    #[test]
    fn the_travel_below_at_and_above_the_resonance_follows_the_spring_the_damper_and_the_mass() {
        let coil = voice_coil(5.0);
        let share = |hz| coil.travel_share(hz).expect("limited");
        assert!((share(0.5) / 2.0 - 1.0).abs() < 2e-4, "{}", share(0.5));
        assert!((share(50.0) / (2.0 * 5.0) - 1.0).abs() < 1e-12, "{}", share(50.0));
        let far: f64 = 5000.0;
        assert!((share(far) / (2.0 * (50.0 / far).powi(2)) - 1.0).abs() < 2e-4, "{}", share(far));
        assert_eq!(Resonator { travel: None, ..coil }.travel_share(50.0), None);
    }

    /// Largest travel over the static one of a mass on a spring, driven by a cosine up to the steady state, by
    /// Runge-Kutta.
    fn integrated(ratio: f64, quality: f64) -> f64 {
        let omega = TAU * ratio;
        let force = |t: f64| (1.0 - (-t / (3.0 * quality.max(1.0))).exp()) * (omega * t).cos();
        let slope = |t: f64, x: f64, v: f64| (v, TAU * TAU * (force(t) - x) - TAU / quality * v);
        let step = 1.0 / (200.0 * ratio.max(1.0));
        let settled = 40.0 * quality.max(1.0);
        let (mut t, mut x, mut v, mut largest) = (0.0, 0.0, 0.0, 0.0_f64);
        while t < settled + 2.0 / ratio.min(1.0) {
            let (x1, v1) = slope(t, x, v);
            let (x2, v2) = slope(t + step / 2.0, x + step / 2.0 * x1, v + step / 2.0 * v1);
            let (x3, v3) = slope(t + step / 2.0, x + step / 2.0 * x2, v + step / 2.0 * v2);
            let (x4, v4) = slope(t + step, x + step * x3, v + step * v3);
            x += step / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4);
            v += step / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
            t += step;
            if t > settled {
                largest = largest.max(x.abs());
            }
        }
        largest
    }

    #[test]
    fn a_mass_on_a_spring_integrated_in_time_travels_as_far_as_the_law_says() {
        for quality in [0.4, 0.8, 3.0] {
            for ratio in [0.05, 0.6, 0.95, 1.0, 1.4, 6.0] {
                let law = voice_coil(quality).travel_share(50.0 * ratio).expect("limited") / 2.0;
                let found = integrated(ratio, quality);
                assert!((found / law - 1.0).abs() < 2e-3, "{quality} {ratio}: {found} {law}");
            }
        }
    }

    proptest! {
        #[test]
        fn no_frequency_between_two_moves_the_actuator_farther_than_the_largest(
            quality in 0.1..50.0, from in 1.0..300.0, to in 1.0..300.0, between in 0.0..=1.0,
        ) {
            let coil = voice_coil(quality);
            let largest = coil.largest_travel_share(from, to).expect("limited");
            let share = coil.travel_share(from + between * (to - from)).expect("limited");
            prop_assert!(share <= largest * (1.0 + 1e-12), "{share} {largest}");
        }
    }

    #[test]
    fn the_largest_travel_is_reached_at_the_peak_and_not_only_at_the_ends() {
        let coil = voice_coil(5.0);
        let top = 2.0 * 5.0 / (1.0 - 1.0 / 100.0_f64).sqrt();
        let largest = coil.largest_travel_share(90.0, 10.0).expect("limited");
        assert!((largest / top - 1.0).abs() < 1e-12, "{largest} {top}");
        // Without a resonance peak the lowest frequency gives the largest travel.
        let damped = voice_coil(0.5);
        assert_eq!(damped.largest_travel_share(10.0, 90.0), damped.travel_share(10.0));
    }
}
