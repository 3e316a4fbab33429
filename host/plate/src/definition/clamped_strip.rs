//! The exact law of a strip in bending between clamped edges: wavenumber and power of its first width mode.
//!
//! The wave w = phi(z) e^(jkx) of a strip of half-width W, clamped at z = +-W, has
//! phi = cos(p b)/cos p - cosh(r b)/cosh r with b = z/W and p^2, r^2 = W^2 (K^2 -+ k^2), and satisfies the edge
//! conditions when
//!
//! p tan p + r tanh r = 0.
//!
//! So s = (W k)^2 is a function of t = (W K)^2 alone, analytic through the cut-off t = q^2, s = 0, where its slope is a.
//! Both terms of the law are one function: with A(u) = sqrt(u) tan sqrt(u) it reads A(t - s) = A(-t - s). Call that value
//! T. Then dA/du = (1 + (T + T^2)/u)/2 gives the derivatives of s.
//!
//! A wave of amplitude 1 on the centre line carries the power (1/2) rho h omega^2 v_g W I with I the integral of phi^2
//! over b = -1..1, phi = 1 in the middle. At a fixed W the group speed v_g is proportional to k/(ds/dt), so the power
//! is proportional to W k Omega, with the weight Omega = I/(ds/dt). By the law the mixed term of the integral
//! vanishes, the rest of it cancels against the numerator of ds/dt, and
//!
//! Omega = (T + T^2) (1/p^2 + 1/r^2) / (1/cos p - 1/cosh r)^2.
//!
//! Loss makes t complex, t (1 + j eta); all formulas hold unchanged.
//!
//! The law has a branch point at t = 4.65, where the strip is 0.912 times as wide as at the cut-off: there the first
//! mode meets the next one and both become complex. `strip_table` states the continuation that the amplitude equation
//! uses.

use num_complex::Complex64;
use std::f64::consts::PI;

/// q: W K at the cut-off.
const CUT_OFF_ROOT: f64 = 2.365_020_372_431_352;
/// q^2: t at the cut-off.
pub(crate) const CUT_OFF: f64 = CUT_OFF_ROOT * CUT_OFF_ROOT;
/// Steps of Newton's method for edges that turn.
const TURNING_STEPS: usize = 8;
/// Newton's method ends at this relative step; the next step would be below rounding.
const STEP_LEAST: f64 = 1e-9;
const STEPS_MAX: usize = 40;

/// The law at one t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StripLaw {
    /// t = (W K)^2.
    pub(crate) t: Complex64,
    /// s = (W k)^2.
    pub(crate) s: Complex64,
    /// ds/dt.
    pub(crate) slope: Complex64,
    /// d^2 s/dt^2.
    pub(crate) bend: Complex64,
    /// Omega.
    pub(crate) weight: Complex64,
    /// d ln Omega/dt.
    pub(crate) weight_slope: Complex64,
}

/// The half-width, over W, of the clamped strip that cuts off as one of half-width W does whose edges turn against a stiffness of
/// D/(share W) per length, and the derivative of its logarithm by that share (0 or more).
///
/// Such a strip cuts off where tan p + tanh p = -2 p share: at q without a share, and at pi/2, as between supported edges, where it
/// is large.
pub(crate) fn of_turning_edges(share: f64) -> (f64, f64) {
    // p = pi - atan(tanh p + 2 p share) has no pole.
    let turned = |p: f64| {
        let tanh = p.tanh();
        let (value, slope) = (tanh + 2.0 * p * share, 1.0 - tanh * tanh + 2.0 * share);
        (value, slope, 1.0 + value * value)
    };
    let mut p = CUT_OFF_ROOT;
    for _ in 0..TURNING_STEPS {
        let (value, slope, square) = turned(p);
        p -= (p - PI + value.atan()) / (1.0 + slope / square);
    }
    let (_, slope, square) = turned(p);
    (CUT_OFF_ROOT / p, 2.0 / (square + slope))
}

impl StripLaw {
    /// The law without loss at the cut-off.
    pub(crate) fn at_cut_off() -> Self {
        Self::near(CUT_OFF.into(), Complex64::ZERO)
    }

    /// The law at `t`, not far from this point.
    pub(crate) fn step_to(&self, t: Complex64) -> Self {
        let rise = t - self.t;
        Self::near(t, self.s + rise * (self.slope + 0.5 * rise * self.bend))
    }

    /// The law far above the cut-off, where r is large and p close to pi/2: p = pi/2 + atan(p/r).
    pub(crate) fn far_above(t: Complex64) -> Self {
        let r = (2.0 * t).sqrt();
        let p = std::f64::consts::FRAC_PI_2 * r / (r - 1.0);
        Self::near(t, t - p * p)
    }

    /// Newton's method from the estimate `s`.
    fn near(t: Complex64, mut s: Complex64) -> Self {
        for _ in 0..STEPS_MAX {
            let (above, below) = (Tangent::at(t - s), Tangent::at(-t - s));
            let step = (above.value - below.value) / (above.slope - below.slope);
            s += step;
            if step.norm() < STEP_LEAST * s.norm().max(1.0) {
                break;
            }
        }
        Self::of(t, s)
    }

    fn of(t: Complex64, s: Complex64) -> Self {
        let (p2, r2) = (t - s, t + s);
        let (above, below) = (Tangent::at(p2), Tangent::at(-r2));
        // The derivatives of A(t - s) - A(-t - s) = 0.
        let difference = above.slope - below.slope;
        let slope = (above.slope + below.slope) / difference;
        let (less, more) = (1.0 - slope, 1.0 + slope);
        let bend = (above.bend * less * less - below.bend * more * more) / difference;

        let value = above.value;
        let product = value + value * value;
        // 1/cosh r as a small exponential, which cannot overflow.
        let small = (-r2.sqrt()).exp();
        let (across, along) = (1.0 / p2.sqrt().cos(), 2.0 * small / (1.0 + small * small));
        let middle = across - along;
        let weight = product * (1.0 / p2 + 1.0 / r2) / (middle * middle);
        // 1/p^2 + 1/r^2 = 2 t/(t^2 - s^2); the last term is that of phi in the middle, by tan p = T/p and
        // tanh r = -T/r.
        let weight_slope = (1.0 + 2.0 * value) * above.slope * less / product + 1.0 / t
            - 2.0 * (t - s * slope) / (p2 * r2)
            - (across * less / p2 - along * more / r2) * value / middle;
        Self { t, s, slope, bend, weight, weight_slope }
    }
}

/// A(u) = sqrt(u) tan sqrt(u) with its derivatives.
struct Tangent {
    value: Complex64,
    slope: Complex64,
    bend: Complex64,
}

impl Tangent {
    fn at(u: Complex64) -> Self {
        // A is even in the root. With a positive imaginary part the exponential is small and cannot overflow.
        let root = u.sqrt();
        let root = if root.im < 0.0 { -root } else { root };
        let turned = (2.0 * Complex64::I * root).exp();
        let value = root * Complex64::I * (1.0 - turned) / (1.0 + turned);
        let rest = (value + value * value) / u;
        let slope = 0.5 * (1.0 + rest);
        Self { value, slope, bend: 0.5 * (slope * (1.0 + 2.0 * value) - rest) / u }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The law at W/W_t = `ratio`, in steps from the cut-off.
    fn at_ratio(ratio: f64, loss: f64) -> StripLaw {
        let steps = 40;
        let lossy =
            (0..=steps).map(|i| CUT_OFF * Complex64::new(1.0, loss * f64::from(i) / f64::from(steps)));
        let entered = lossy.fold(StripLaw::at_cut_off(), |law, t| law.step_to(t));
        (1..=steps).fold(entered, |law, i| {
            law.step_to(entered.t * ratio.powf(2.0 * f64::from(i) / f64::from(steps)))
        })
    }

    #[test]
    fn edges_that_turn_widen_a_strip_from_clamped_to_supported() {
        for share in [1e-6, 0.03, 0.1, 0.5, 3.0, 100.0] {
            let (wider, rise) = of_turning_edges(share);
            let p = CUT_OFF_ROOT / wider;
            let rest = p.sin() + p.cos() * (p.tanh() + 2.0 * p * share);
            assert!(rest.abs() < 1e-13 * (1.0 + share), "{share}: {rest}");
            let step = 1e-5 * share;
            let [above, below] = [share + step, share - step].map(|at| of_turning_edges(at).0.ln());
            assert!(((above - below) / (2.0 * step) / rise - 1.0).abs() < 1e-5, "{share}: {rise}");
        }
        let (wider, rise) = of_turning_edges(0.0);
        assert!((wider - 1.0).abs() < 1e-15 && (rise - 1.0).abs() < 1e-14, "{wider} {rise}");
        // W + delta to the first order, 2.3 (delta/W)^2 less to the second.
        let second = (1.0 + 1e-3 - of_turning_edges(1e-3).0) / 1e-6;
        assert!((second - 2.3).abs() < 0.1, "{second}");
        let supported = CUT_OFF_ROOT / (0.5 * PI);
        assert!((of_turning_edges(1e6).0 / supported - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_wavenumber_is_below_that_of_the_near_cut_off_law_by_up_to_a_quarter() {
        let model = crate::preset("al-bending").expect("a preset").spec().model.clone();
        let model = crate::Model::BendingClamped(model.bending().expect("bending").clone());
        for (ratio, share) in
            [(1.005, 0.9946), (1.05, 0.9559), (1.22, 0.8795), (1.41, 0.8389), (2.0, 0.7880), (3.3, 0.7588)]
        {
            let law = at_ratio(ratio, 0.0);
            let near = model.width_slope(1) * (law.t.re - CUT_OFF);
            assert!(((law.s.re / near).sqrt() - share).abs() < 1e-4, "{ratio}: {law:?}");
            let (p, r) = ((law.t.re - law.s.re).sqrt(), (law.t.re + law.s.re).sqrt());
            assert!((p * p.tan() + r * r.tanh()).abs() < 1e-10 * r, "{ratio}: the edges are not clamped");
        }
        assert!((StripLaw::at_cut_off().slope.re - model.width_slope(1)).abs() < 1e-9);
    }

    #[test]
    fn the_weight_is_the_energy_flux_of_the_shape() {
        // In a thin strip with W = 1 and D = 1 the wave w = phi(b) e^(jkx) has the force
        // V = -(w_xxx + (2 - nu) w_xbb) and the moment M = -(w_xx + nu w_bb) per width. The power of both is
        // (omega k/2) integral of (k^2 phi^2 - (2 - nu) phi phi'') + (k^2 phi^2 - nu phi phi''),
        // proportional to k K^2 omega Omega.
        let poisson = 0.33;
        for ratio in [0.985, 1.0001, 1.3, 2.0, 5.0] {
            let law = at_ratio(ratio, 0.0);
            let (p, r) = ((law.t - law.s).sqrt(), (law.t + law.s).sqrt());
            let shape = |b: f64| (p * b).cos() / p.cos() - (r * b).cosh() / r.cosh();
            let bend = |b: f64| -p * p * (p * b).cos() / p.cos() - r * r * (r * b).cosh() / r.cosh();
            let count = 2000;
            let flux: Complex64 = (0..count)
                .map(|i| (f64::from(i) + 0.5) / f64::from(count))
                .map(|b| {
                    let (w, curved) = (shape(b), bend(b));
                    let force = law.s * w * w - (2.0 - poisson) * w * curved;
                    let moment = law.s * w * w - poisson * w * curved;
                    (force + moment) / f64::from(count)
                })
                .sum();
            let weight = flux / shape(0.0).powi(2) / law.t;
            assert!((weight / law.weight - 1.0).norm() < 1e-6, "{ratio}: {weight} against {}", law.weight);
        }
    }

    #[test]
    fn derivatives_match_the_functions() {
        for (ratio, loss) in [(0.985, 0.0), (1.0, 0.1), (1.4, 0.25), (4.0, 0.01)] {
            let law = at_ratio(ratio, loss);
            let h = 1e-4 * law.t;
            let (low, high) = (law.step_to(law.t - h), law.step_to(law.t + h));
            let slope = (high.s - low.s) / (2.0 * h);
            let bend = (high.slope - low.slope) / (2.0 * h);
            let weight = (high.weight.ln() - low.weight.ln()) / (2.0 * h);
            assert!((slope - law.slope).norm() < 1e-6, "{law:?}: {slope}");
            assert!((bend - law.bend).norm() < 1e-5, "{law:?}: {bend}");
            assert!((weight - law.weight_slope).norm() < 1e-5, "{law:?}: {weight}");
        }
    }

    #[test]
    fn far_above_the_cut_off_the_strip_is_a_beam_of_its_own_width() {
        for loss in [0.0, 0.25] {
            let stepped = at_ratio(20.0, loss);
            let direct = StripLaw::far_above(stepped.t);
            assert!((stepped.s - direct.s).norm() < 1e-9 * stepped.s.norm(), "{stepped:?} {direct:?}");
            let wide = StripLaw::far_above(1e10 * Complex64::new(1.0, loss));
            assert!(wide.s.is_finite() && wide.weight.is_finite(), "{wide:?}");
            assert!(((wide.t - wide.s).sqrt().re - std::f64::consts::FRAC_PI_2).abs() < 1e-4, "{wide:?}");
        }
    }
}
