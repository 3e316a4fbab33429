//! The other waves at the driven end of a plate in bending: evanescent ones, and higher width modes that run there.

use super::turning_wave::{ModeLaw, TurningWave};
use num_complex::Complex64;

/// Exponents of decay after which a near wave is left out: e^-21 = 1e-9, the solver's own error.
const EXPONENTS_MAX: f64 = 21.0;
/// Points from one evaluation of a near wave to the next; between them its logarithm goes linearly.
const STRIDE: usize = 8;

/// The waves beside the propagating one p that start at the driven end, each with
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
    /// How it goes on along the plate.
    pub(crate) course: Course,
}

/// How a wave goes on along the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Course {
    /// It dies out: e(x) = e(0) sqrt(W0 gamma0/(W gamma)) exp(-integral of gamma).
    DiesOut(Decay),
    /// It runs, turns where the plate is narrower and comes back: a [`TurningWave`].
    Turns(ModeLaw),
}

/// The rate of a wave along the plate, gamma^2 = `axial` + `across` (W0/W)^2, 1/m^2. gamma = -jk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Decay {
    /// What is the same everywhere: K^2 between supported edges.
    pub(crate) axial: Complex64,
    /// What the width adds at x = 0: (q/W0)^2 between supported edges.
    pub(crate) across: Complex64,
}

impl NearField {
    /// Adds the near field to `field`, which holds p at positions uniform in steps of `step_m` from 0 on; `scale` is
    /// sqrt(W0/W) there, `value` is p(0) and `slope` p'(0).
    pub(crate) fn add(
        &self,
        field: &mut [Complex64],
        scale: &[f64],
        step_m: f64,
        value: Complex64,
        slope: Complex64,
    ) {
        let Some(last) = scale.len().min(field.len()).checked_sub(1) else { return };
        for wave in &self.waves {
            let at_end = wave.per_value * value + wave.per_slope * slope;
            match wave.course {
                Course::DiesOut(decay) => decay.add(field, &scale[..=last], step_m, at_end),
                Course::Turns(law) => {
                    let turning = TurningWave::on(&law, &scale[..=last], step_m);
                    for (f, shape) in field.iter_mut().zip(turning.shape) {
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

    /// Adds a wave that dies out and is `now` at x = 0.
    fn add(self, field: &mut [Complex64], scale: &[f64], step_m: f64, mut now: Complex64) {
        let (first, last) = (self.rate(scale[0]), scale.len() - 1);
        // Of the point `from`: ln of the wave over its value at 0, gamma, and the integral of gamma.
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
}
