//! Round numbers along an axis, and their labels.

/// The nearest 1, 2 or 5 times a power of ten at or above `at_least`.
#[must_use]
pub fn round_step(at_least: f64) -> f64 {
    if !(at_least > 0.0 && at_least.is_finite()) {
        return 1.0;
    }
    let decade = 10f64.powf(at_least.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|step| step * decade >= at_least * (1.0 - 1e-9));
    step.unwrap_or(10.0) * decade
}

/// Labelled places of an axis: whole multiples of a round step.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// Distance of two places.
    pub step: f64,
    /// The places, in rising order.
    pub places: Vec<f64>,
}

/// Largest number of places.
const MOST: usize = 200;
/// An axis with fewer labels than this shows no scale.
const LEAST: usize = 2;

impl Ticks {
    /// The places from `low` to `high` in round steps of at least `spacing`; smaller steps where there would be fewer
    /// than two places. None where the axis has no extent.
    #[must_use]
    pub fn between(low: f64, high: f64, spacing: f64) -> Self {
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Self { step: 1.0, places: Vec::new() };
        }
        let mut step = round_step(spacing.max((high - low) / MOST as f64));
        loop {
            let (first, last) = ((low / step - 1e-6).ceil(), (high / step + 1e-6).floor());
            let count = (last - first + 1.0).max(0.0) as usize;
            if count >= LEAST {
                let places = (0..count.min(MOST + 1)).map(|i| (first + i as f64) * step).collect();
                return Self { step, places };
            }
            // The next smaller of 1, 2 and 5 times a power of ten: at most half the step.
            step = round_step(0.4 * step);
        }
    }

    /// Label of a place, with the number of decimals of the step.
    #[must_use]
    pub fn label(&self, place: f64) -> String {
        label(place, self.step)
    }
}

/// A multiple of `step` with the number of decimals of the step; never `-0`.
#[must_use]
pub fn label(place: f64, step: f64) -> String {
    let decimals = if step > 0.0 { (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize } else { 0 };
    // Replaces -0 by 0.
    let whole = if (place / step).abs() < 0.5 { 0.0 } else { place };
    format!("{whole:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_numbers() {
        assert_eq!(round_step(0.013), 0.02);
        assert_eq!(round_step(3.0), 5.0);
        assert_eq!(round_step(f64::NAN), 1.0);
    }

    #[test]
    fn an_axis_of_any_extent_has_at_least_two_ticks() {
        for (low, high) in
            [(0.0, 640.0), (0.0, 1.0), (3.17, 3.19), (-1.0, 1.0), (0.0, 9.9e-7), (990.0, 1010.0)]
        {
            for spacing in [0.01, 0.3, 1.0, 7.0] {
                let ticks = Ticks::between(low, high, spacing * (high - low));
                assert!(ticks.places.len() >= 2, "{low} to {high}, {spacing}: {ticks:?}");
                let inside =
                    |place: &f64| (low - 1e-6 * ticks.step..=high + 1e-6 * ticks.step).contains(place);
                assert!(ticks.places.iter().all(inside), "{ticks:?}");
                let labels: Vec<String> = ticks.places.iter().map(|place| ticks.label(*place)).collect();
                assert!(labels.windows(2).all(|pair| pair[0] != pair[1]), "{labels:?}");
            }
        }
        for (low, high) in [(0.0, 0.0), (1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(Ticks::between(low, high, 1.0).places.is_empty());
        }
        assert!(Ticks::between(0.0, 1e9, 1.0).places.len() <= MOST + 1);
    }

    #[test]
    fn labels_have_the_decimals_of_the_step_and_no_minus_before_zero() {
        assert_eq!([label(-0.0, 0.5), label(-1e-17, 0.1), label(0.02, 0.02)], ["0.0", "0.0", "0.02"]);
        assert_eq!([label(-120.0, 20.0), label(100.0, 100.0), label(2.0, 1.0)], ["-120", "100", "2"]);
    }
}
