//! Two measurements of one plate paired by frequency, and the residual of their ratio.

use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement};
use crate::definition::Model;
use crate::quantity::Range;

/// Relative error of the one-mode equation: smaller differences carry no information on the plate. Against plates in
/// two dimensions it is 1 to 3 % (`tests/calibration`).
pub(crate) const MODEL_ERROR: f64 = 0.015;
/// The same between clamped edges beyond the turning point, as a share of the wave before it: by the strip's law the wave decays too
/// slowly there. Where it is a hundredth of the peak, plates in two dimensions have 0.87 of it.
const CLAMPED_TAIL_ERROR: f64 = 0.003;
/// Share of the frequencies on each side over which a signal's mean square is taken: a node is no tail.
const BESIDE: f64 = 0.06;
/// Median of |H|^2 over the noise's variance, for noise alone: 2 ln 2.
const NOISE_MEDIAN: f64 = 2.0 * std::f64::consts::LN_2;
/// Two frequencies with a smaller relative difference are the same: a universal file has six digits of them.
pub(crate) const SAME: f64 = 6e-6;

/// Magnitudes and variances of both sensors' responses at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    pub(crate) frequency_hz: f64,
    /// Signed root of |H|^2 minus its median for noise alone. The plain magnitude is biased by noise; this one, for a
    /// response of noise alone, is as likely negative as positive.
    pub(crate) magnitude: [f64; 2],
    pub(crate) variance: [f64; 2],
    /// Headroom of the fuller input below its full scale, dB.
    pub(crate) headroom_db: Option<f64>,
}

impl Pair {
    fn of(here: &MeasuredPoint, there: &MeasuredPoint) -> Self {
        let both = [here, there];
        Self {
            frequency_hz: here.frequency_hz,
            magnitude: both.map(unbiased_magnitude),
            variance: both.map(|point| point.noise * point.noise),
            headroom_db: both.iter().filter_map(|point| point.headroom_db).reduce(f64::min),
        }
    }

    /// The most likely source amplitude for both magnitudes where the wave has the magnitudes `p`, and its variance.
    pub(crate) fn source(&self, p: &[f64], model_error: f64) -> (f64, f64) {
        let weights = [0, 1].map(|i| p[i] / self.variance_with(i, model_error));
        let weight: f64 = weights.iter().zip(p).map(|(weight, p)| weight * p).sum();
        let sum: f64 = weights.iter().zip(self.magnitude).map(|(weight, magnitude)| weight * magnitude).sum();
        (sum / weight, weight.recip())
    }

    /// The variance of a magnitude by noise and model error.
    fn variance_with(&self, i: usize, model_error: f64) -> f64 {
        self.variance[i] + (model_error * self.magnitude[i]).powi(2)
    }

    /// The residual of the ratio where the wave has the magnitudes `p`: see [`super::ratio`].
    pub(crate) fn residual(&self, p: &[f64], model_error: f64) -> f64 {
        let variance = [0, 1].map(|i| self.variance_with(i, model_error));
        let spread = variance[0] * p[1] * p[1] + variance[1] * p[0] * p[0];
        (self.magnitude[0] * p[1] - self.magnitude[1] * p[0]) / spread.sqrt()
    }
}

/// Signed root of |H|^2 minus its median for noise alone.
pub(crate) fn unbiased_magnitude(point: &MeasuredPoint) -> f64 {
    let square = point.response.norm_sqr() - NOISE_MEDIAN * point.noise * point.noise;
    square.abs().sqrt().copysign(square)
}

/// Error of the one-mode equation on a plate beyond its turning point, as a share of the wave before it.
pub(crate) const fn tail_error(model: &Model) -> f64 {
    match model {
        Model::BendingClamped(_) => CLAMPED_TAIL_ERROR,
        _ => 0.0,
    }
}

/// The variance of this error, where both sensors show `magnitudes` at each frequency.
pub(crate) fn tail_variances(magnitudes: impl Iterator<Item = [f64; 2]>, tail_error: f64) -> Vec<f64> {
    let squares: Vec<f64> = magnitudes.map(|[a, b]| a * a + b * b).collect();
    if tail_error == 0.0 {
        return vec![0.0; squares.len()];
    }
    means_beside(&squares).map(|square| tail_error * tail_error * square).collect()
}

/// The mean of each value and those beside it.
pub(crate) fn means_beside(values: &[f64]) -> impl Iterator<Item = f64> {
    let beside = (BESIDE * values.len() as f64).ceil() as usize;
    (0..values.len()).map(move |i| {
        let near = &values[i.saturating_sub(beside)..(i + beside + 1).min(values.len())];
        near.iter().sum::<f64>() / near.len() as f64
    })
}

/// The frequencies in `allowed` at which both sensors measured.
pub(crate) fn pairs([a, b]: [&Measurement; 2], allowed: Range) -> Vec<Pair> {
    let mut others = b.points.iter().peekable();
    let mut found = Vec::with_capacity(a.points.len());
    for here in a.points.iter().filter(|point| allowed.contains(point.frequency_hz)) {
        let before = |other: &&MeasuredPoint| other.frequency_hz < here.frequency_hz * (1.0 - SAME);
        while others.next_if(before).is_some() {}
        let same = |other: &&&MeasuredPoint| other.frequency_hz <= here.frequency_hz * (1.0 + SAME);
        if let Some(there) = others.peek().filter(same) {
            found.push(Pair::of(here, there));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::measurement::sensor::SensorKind;
    use num_complex::Complex64;

    fn point(frequency_hz: f64, magnitude: f64) -> MeasuredPoint {
        let response = Complex64::from_polar(magnitude, 0.7);
        MeasuredPoint { frequency_hz, response, noise: 0.01, headroom_db: None }
    }

    #[test]
    fn only_frequencies_that_both_measured_and_that_are_allowed_count() {
        let of = |frequencies: &[f64]| {
            let points = frequencies.iter().map(|&hz| point(hz, hz / 100.0)).collect();
            Measurement::at(0.1, SensorKind::Velocity, points)
        };
        let (a, b) =
            (of(&[90.0, 100.0, 110.0, 130.0, 150.0]), of(&[95.0, 100.0, 120.0, 130.0 + 1e-6, 150.0]));
        let found = pairs([&a, &b], Range::new(50.0, 140.0, "Hz"));
        let frequencies: Vec<f64> = found.iter().map(|pair| pair.frequency_hz).collect();
        assert_eq!(frequencies, [100.0, 130.0]);
        let without_noise = (1.0 - 2.0 * 2_f64.ln() * 1e-4_f64).sqrt();
        assert!((found[0].magnitude[1] - without_noise).abs() < 1e-12);
        assert!((Pair::of(&point(1.0, 0.0), &point(1.0, 1.0)).magnitude[0] + 0.01177).abs() < 1e-5);
    }

    #[test]
    fn the_residual_remains_with_the_best_source() {
        let pair =
            Pair { frequency_hz: 100.0, magnitude: [0.9, 2.3], variance: [0.04, 0.09], headroom_db: None };
        for p in [[1.0, 2.0], [0.0, 2.0], [3.0, 0.1]] {
            let left = |source: f64| -> f64 {
                (0..2).map(|i| (pair.magnitude[i] - source * p[i]).powi(2) / pair.variance[i]).sum()
            };
            let (source, variance) = pair.source(&p, 0.0);
            assert!((pair.residual(&p, 0.0).powi(2) - left(source)).abs() < 1e-12);
            // chi^2 of least squares rises by 1 within one standard deviation.
            let rise = left(source + variance.sqrt()) - left(source);
            assert!((rise - 1.0).abs() < 1e-9, "{rise}");
        }
    }
}
