//! The evanescent waves at the driven end of a plate in bending.

use num_complex::Complex64;

/// Exponents of decay after which a near wave is left out: e^-21 = 1e-9, the solver's own error.
const EXPONENTS_MAX: f64 = 21.0;
/// Points from one evaluation of a near wave to the next; between them its logarithm goes linearly.
const STRIDE: usize = 8;

/// The evanescent waves that start at the driven end.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct NearField {
    pub(crate) waves: Vec<NearWave>,
}

/// One evanescent wave: e(0) = `per_value` p(0) + `per_slope` p'(0), and on the plate
/// e(x) = e(0) sqrt(W0 gamma0/(W gamma)) exp(-integral of gamma) with gamma^2 = `axial` + `across` (W0/W)^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearWave {
    pub(crate) per_value: Complex64,
    pub(crate) per_slope: Complex64,
    /// K^2 of the plate, 1/m^2.
    pub(crate) axial: Complex64,
    /// What the width adds to gamma^2 at x = 0, 1/m^2: (q/W0)^2 between supported edges.
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
        let (Some(&start), last) = (scale.first(), scale.len().min(field.len()).saturating_sub(1)) else {
            return;
        };
        for wave in &self.waves {
            let first = wave.decay(start);
            let mut now = wave.per_value * value + wave.per_slope * slope;
            // Of the point `from`: ln of the wave over its value at 0, gamma, and the integral of gamma.
            let (mut from, mut log, mut decay, mut exponent) = (0, Complex64::ZERO, first, Complex64::ZERO);
            while from < last && exponent.re <= EXPONENTS_MAX {
                let to = (from + STRIDE).min(last);
                let steps = (to - from) as f64;
                let next_decay = wave.decay(scale[to]);
                exponent += 0.5 * step_m * steps * (decay + next_decay);
                let next_log = 0.5 * (first / next_decay).ln() + scale[to].ln() - exponent;
                let ratio = ((next_log - log) / steps).exp();
                for field in &mut field[from..to] {
                    *field += now;
                    now *= ratio;
                }
                (from, log, decay) = (to, next_log, next_decay);
            }
            if from == last && exponent.re <= EXPONENTS_MAX {
                field[last] += now;
            }
        }
    }
}

impl NearWave {
    /// gamma where sqrt(W0/W) is `scale`, 1/m.
    fn decay(&self, scale: f64) -> Complex64 {
        (self.axial + self.across * scale.powi(4)).sqrt()
    }
}
