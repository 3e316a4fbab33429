//! The evanescent waves at the driven end of a plate in bending.

use crate::spec::plate::Plate;
use num_complex::Complex64;

/// Exponents of decay after which a near wave is left out: e^-40 of the displacement.
const EXPONENTS_MAX: f64 = 40.0;

/// The evanescent waves that start at the driven end.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct NearField {
    pub(crate) waves: Vec<NearWave>,
}

/// One evanescent wave: e(0) = `per_value` p(0) + `per_slope` p'(0), and on the plate
/// e(x) = e(0) sqrt(W0 gamma0/(W gamma)) exp(-integral of gamma) with gamma^2 = `axial` + `width_number`^2/W^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearWave {
    pub(crate) per_value: Complex64,
    pub(crate) per_slope: Complex64,
    /// K^2 of the plate, 1/m^2.
    pub(crate) axial: Complex64,
    /// q of the width mode.
    pub(crate) width_number: f64,
}

impl NearField {
    /// Adds the near field to `field`, which holds p at positions uniform in steps of `step_m` from 0 on, where
    /// `value` is p(0) and `slope` is p'(0).
    pub(crate) fn add(
        &self,
        field: &mut [Complex64],
        plate: &Plate,
        step_m: f64,
        value: Complex64,
        slope: Complex64,
    ) {
        for wave in &self.waves {
            let start = wave.per_value * value + wave.per_slope * slope;
            let first = wave.decay(plate, 0.0);
            let (mut before, mut exponent) = (first, Complex64::ZERO);
            let wide = plate.width.at(0.0).value;
            for (index, field) in field.iter_mut().enumerate() {
                let x = index as f64 * step_m;
                let here = wave.decay(plate, x);
                if index > 0 {
                    exponent += 0.5 * step_m * (before + here);
                }
                if exponent.re > EXPONENTS_MAX {
                    break;
                }
                let widening = Complex64::from((wide - plate.width.at(x).value).exp());
                *field += start * (widening * first / here).sqrt() * (-exponent).exp();
                before = here;
            }
        }
    }
}

impl NearWave {
    /// gamma at `x`, 1/m.
    fn decay(&self, plate: &Plate, x: f64) -> Complex64 {
        let across = self.width_number * (-plate.width.at(x).value).exp();
        (self.axial + across * across).sqrt()
    }
}
