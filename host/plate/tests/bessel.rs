//! The modified Bessel function of imaginary order: the exact amplitude of an exponential taper.
//!
//! f = A K_{i nu}(s) with s = (q/(W0 d)) e^(d x) and nu = K/d solves the paper's equation; e^(d x/2) K_{i nu'}(s)
//! with nu'^2 = nu^2 - 1/4 the corrected one (DLMF 10.45.1). Loss makes nu complex.

use slipline_plate::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// e^(pi Re(nu)/2) K_{i nu}(s) for s > 0: scaled so that large orders do not underflow.
///
/// K_{i nu}(s) = 1/2 integral over all t of e^(-s cosh t + i nu t), with the path moved to Im t = theta just below
/// pi/2, where the integrand is about as small as the result, and the trapezoidal rule (exponentially convergent
/// for this integrand). Relative error about 1e-11 away from the nodes, for |Re nu| up to 300 and s from 0.01 to 1e4.
pub(crate) fn k_imaginary_scaled(nu: Complex64, s: f64) -> Complex64 {
    let order = nu.re.abs();
    // Cancellation amplifies rounding by e^(order * delta); a larger delta makes the integrand decay sooner.
    let delta = (7.0 / order.max(1.0)).min(1.2);
    let theta = FRAC_PI_2 - delta;
    let decay = s * theta.cos();
    // End of the path: s cosh t cos(theta) exceeds its value in the middle by 42, a factor of e^-42.
    let far = ((42.0 + decay) / decay).acosh() + 0.5;
    let fastest = (s * theta.sin() * far.cosh()).max(order) + nu.im.abs() + 1.0;
    // Sixteen points per period of the fastest oscillation within the range.
    let step = (2.0 * PI / 16.0 / fastest).min(0.02);
    let count = (far / step).ceil() as i64;
    let i = Complex64::I;
    let scale = FRAC_PI_2 * nu.re.abs();
    let term = |k: i64| {
        let t = Complex64::new(k as f64 * step, theta);
        (-s * t.cosh() + i * nu * t + scale).exp()
    };
    let sum: Complex64 = (-count..=count).map(term).sum();
    sum * (0.5 * step)
}
