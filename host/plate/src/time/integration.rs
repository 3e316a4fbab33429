//! The coefficients of the oscillators' time steps: exact integrals for a spline as the drive.

use super::analytic_signal::BSPLINE;
use super::band_plan::BandPlan;
use super::kernel::ModalStates;
use super::modal::ModalBank;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The coefficients of a step for every oscillator of the bank, with all states zero.
pub(super) fn prepare(bank: &ModalBank, plan: &BandPlan) -> ModalStates {
    let mut oscillators = ModalStates {
        re: vec![0.0; bank.pole.len()],
        im: vec![0.0; bank.pole.len()],
        ..ModalStates::default()
    };
    for pole in &bank.pole {
        let (advance, inject) = integrate(*pole, plan.centre_hz, 1.0 / plan.rate_hz());
        oscillators.advance_re.push(advance.re);
        oscillators.advance_im.push(advance.im);
        for (k, inject) in inject.into_iter().enumerate() {
            oscillators.inject_re[k].push(inject.re);
            oscillators.inject_im[k].push(inject.im);
        }
    }
    oscillators
}

/// The exact step of z' = -j (p - centre) z + j u over `step_s`, where u is the quintic spline of six coefficients: the
/// factor of z, and the factor of each coefficient.
fn integrate(pole: Complex64, centre_hz: f64, step_s: f64) -> (Complex64, [Complex64; 6]) {
    let z = Complex64::new(0.0, -1.0) * (pole - TAU * centre_hz) * step_s;
    // moment[i] = integral over the step of e^(z (1 - t)) t^i, which is i! phi_{i+1}(z).
    let phi = phi_functions(z);
    let mut factorial = 1.0;
    let mut moment = [Complex64::ZERO; 6];
    for (i, moment) in moment.iter_mut().enumerate() {
        if i > 0 {
            factorial *= i as f64;
        }
        *moment = phi[i + 1] * factorial;
    }
    let mut inject = [Complex64::ZERO; 6];
    for (inject, piece) in inject.iter_mut().zip(&BSPLINE) {
        let sum: Complex64 = piece.iter().zip(&moment).map(|(c, m)| m * *c).sum();
        *inject = Complex64::new(0.0, step_s / 120.0) * sum;
    }
    (phi[0], inject)
}

/// The phi functions of exponential integrators, 0 to 6: phi_0 = e^z, phi_{k+1} = (phi_k - 1/k!)/z.
fn phi_functions(z: Complex64) -> [Complex64; 7] {
    let mut phi = [Complex64::ZERO; 7];
    if z.norm() > 4.0 {
        phi[0] = z.exp();
        let mut factorial = 1.0;
        for k in 0..6 {
            if k > 0 {
                factorial *= k as f64;
            }
            phi[k + 1] = (phi[k] - 1.0 / factorial) / z;
        }
        return phi;
    }
    // The recurrence above loses accuracy for small z. Instead: phi_6 by its series, sum of z^n/(n + 6)!, and the
    // others from it by phi_k = z phi_{k+1} + 1/k!, which is stable here.
    let mut term = Complex64::from(1.0 / 720.0);
    let mut sum = term;
    for n in 1..40 {
        term *= z / (n + 6) as f64;
        sum += term;
    }
    phi[6] = sum;
    let mut factorial = 120.0;
    for k in (0..6).rev() {
        phi[k] = phi[k + 1] * z + 1.0 / factorial;
        factorial /= (k as f64).max(1.0);
    }
    phi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phi_functions_agree_where_the_two_ways_meet() {
        for angle in [0.1_f64, 1.5, 3.0, -1.4] {
            let direction = Complex64::cis(angle);
            let (below, above) = (phi_functions(direction * 3.999_999), phi_functions(direction * 4.000_001));
            for (a, b) in below.iter().zip(above) {
                assert!((a - b).norm() < 1e-4 * a.norm().max(1e-3), "{angle}");
            }
        }
    }
}
