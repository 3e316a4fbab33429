//! The other waves at the driven end of a plate in bending: evanescent waves, and higher width modes that propagate
//! there.

use super::turning_wave::{ModeLaw, TurningWave};
use num_complex::Complex64;

/// Decay, in nepers, beyond which a near wave is neglected: e^-21 = 1e-9, the solver's own error.
const EXPONENTS_MAX: f64 = 21.0;
/// Points from one evaluation of a near wave to the next; between them its logarithm is linear.
const STRIDE: usize = 8;

/// The waves that start at the driven end beside the propagating wave p, each with
/// e(0) = `per_value` p(0) + `per_slope` p'(0).
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct NearField {
    pub(crate) waves: Vec<NearWave>,
}

/// One of these waves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearWave {
    pub(crate) per_value: Complex64,
    pub(crate) per_slope: Complex64,
    /// Its course along the plate.
    pub(crate) course: Course,
}

/// The course of a wave along the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Course {
    /// It decays: e(x) = e(0) sqrt(W0 gamma0/(W gamma)) exp(-integral of gamma).
    DiesOut(Decay),
    /// It propagates, turns where the plate is narrower and returns: a [`TurningWave`].
    Turns(ModeLaw),
}

/// The rate of a wave along the plate, gamma^2 = `axial` + `across` (W0/W)^2, 1/m^2. gamma = -jk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Decay {
    /// The part independent of the width: K^2 between supported edges.
    pub(crate) axial: Complex64,
    /// The part of the width at x = 0: (q/W0)^2 between supported edges.
    pub(crate) across: Complex64,
}

impl NearField {
    /// Adds the near field to `field`, which holds p at every `every`-th (1 or more) of the points in steps of
    /// `step_m` from 0; `scale` is sqrt(W0/W) at all points, `value` is p(0) and `slope` p'(0).
    pub(crate) fn add(
        &self,
        field: &mut [Complex64],
        every: usize,
        scale: &[f64],
        step_m: f64,
        value: Complex64,
        slope: Complex64,
    ) {
        let Some(last) = scale.len().min(field.len().saturating_mul(every)).checked_sub(1) else { return };
        for wave in &self.waves {
            let at_end = wave.per_value * value + wave.per_slope * slope;
            match wave.course {
                Course::DiesOut(decay) if every == 1 => decay.add(field, &scale[..=last], step_m, at_end),
                Course::DiesOut(decay) => decay.add_apart(field, every, &scale[..=last], step_m, at_end),
                Course::Turns(law) => {
                    let turning = TurningWave::on(&law, &scale[..=last], step_m);
                    for (f, shape) in field.iter_mut().zip(turning.shape.iter().step_by(every)) {
                        *f += at_end * shape;
                    }
                }
            }
        }
    }
}

impl Decay {
    /// gamma^2 where sqrt(W0/W) is `scale`, 1/m^2.
    fn square(self, scale: f64) -> Complex64 {
        self.axial + self.across * scale.powi(4)
    }

    /// gamma there, 1/m.
    fn rate(self, scale: f64) -> Complex64 {
        self.square(scale).sqrt()
    }

    /// Adds an evanescent wave that is `now` at x = 0.
    fn add(self, field: &mut [Complex64], scale: &[f64], step_m: f64, mut now: Complex64) {
        let (first, last) = (self.rate(scale[0]), scale.len() - 1);
        // At the point `from`: ln of the wave over its value at 0, gamma, and the integral of gamma.
        let (mut from, mut log, mut rate, mut exponent) = (0, Complex64::ZERO, first, Complex64::ZERO);
        while from < last && exponent.re <= EXPONENTS_MAX {
            let to = (from + STRIDE).min(last);
            let steps = (to - from) as f64;
            let next_rate = self.rate(scale[to]);
            exponent += 0.5 * step_m * steps * (rate + next_rate);
            let next_log = 0.5 * (first / next_rate).ln() + scale[to].ln() - exponent;
            let ratio = ((next_log - log) / steps).exp();
            for field in &mut field[from..to] {
                *field += now;
                now *= ratio;
            }
            (from, log, rate) = (to, next_log, next_rate);
        }
        if from == last && exponent.re <= EXPONENTS_MAX {
            field[last] += now;
        }
    }

    /// d gamma/dx at a point, where gamma is `rate`, 1/m^2.
    fn slope(self, scale: &[f64], point: usize, step_m: f64, rate: Complex64) -> Complex64 {
        let (before, after) = (point.saturating_sub(1), (point + 1).min(scale.len() - 1));
        let distance_m = (after - before).max(1) as f64 * step_m;
        let narrowing = (scale[after] - scale[before]) / (distance_m * scale[point]);
        2.0 * narrowing * self.across * scale[point].powi(4) / rate
    }

    /// As [`Decay::add`], at every `every`-th point only. These are so far apart that the integral of gamma also uses
    /// its slopes (trapezoidal rule with the first term of Euler and Maclaurin: an error of the fourth order).
    fn add_apart(self, field: &mut [Complex64], every: usize, scale: &[f64], step_m: f64, at_end: Complex64) {
        let first = self.rate(scale[0]);
        let apart_m = step_m * every as f64;
        let (mut rate, mut slope) = (first, self.slope(scale, 0, step_m, first));
        let mut exponent = Complex64::ZERO;
        for (field, point) in field.iter_mut().zip((0..scale.len()).step_by(every)) {
            if point > 0 {
                let next_rate = self.rate(scale[point]);
                let next_slope = self.slope(scale, point, step_m, next_rate);
                exponent +=
                    0.5 * apart_m * (rate + next_rate) + apart_m * apart_m / 12.0 * (slope - next_slope);
                (rate, slope) = (next_rate, next_slope);
            }
            if exponent.re > EXPONENTS_MAX {
                break;
            }
            *field += at_end * (first / rate).sqrt() * scale[point] * (-exponent).exp();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_at_places_apart_is_the_exact_one_of_an_exponential_taper() {
        let (narrowing, step_m, every) = (2.5, 2.7e-5, 63);
        let decay = Decay { axial: Complex64::new(4e4, 80.0), across: Complex64::from(6e3) };
        let scale: Vec<f64> = (0..201 * every).map(|i| (narrowing * f64::from(i) * step_m).exp()).collect();
        let wave = NearWave {
            per_value: Complex64::new(0.3, -0.2),
            per_slope: Complex64::ZERO,
            course: Course::DiesOut(decay),
        };
        let near = NearField { waves: vec![wave] };
        let mut apart = vec![Complex64::ZERO; 201];
        near.add(&mut apart, every as usize, &scale, step_m, Complex64::ONE, Complex64::ONE);
        // The integral of sqrt(a + b e^u) over u is 2 s + sqrt a ln((s - sqrt a)/(s + sqrt a)) with s that root.
        let root = decay.axial.sqrt();
        let integral = |x: f64| {
            let s = decay.rate((narrowing * x).exp());
            (2.0 * s + root * ((s - root) / (s + root)).ln()) / (4.0 * narrowing)
        };
        let exact = |x: f64| {
            let scale = (narrowing * x).exp();
            let shape = (decay.rate(1.0) / decay.rate(scale)).sqrt() * scale;
            wave.per_value * shape * (integral(0.0) - integral(x)).exp()
        };
        for (place, found) in apart.iter().enumerate() {
            let exact = exact(place as f64 * f64::from(every) * step_m);
            assert!((found - exact).norm() < 2e-9, "{place}: {found} for {exact}");
        }
    }
}
