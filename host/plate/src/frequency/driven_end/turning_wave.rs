//! A higher width mode that propagates at the driven end of a clamped plate, turns on the plate and returns.
//!
//! Between clamped edges the driven end excites every even width mode. The second one propagates where the plate is
//! more than 2.32 times as wide as where the first one turns. It follows its own equation: with k^2 = s/W^2 at the
//! local half-width W, g = e sqrt(W/W0) solves g'' + k^2 g = 0 and decays beyond its turning point. The coupling of
//! the two by the taper is neglected. Against two dimensions, the error of the field before that point is then up to
//! 0.06 of the peak for |W'| up to 0.1 (`tests/bending_truth`); as a wave that does not return it was 0.2.

use crate::definition::plate::Plate;
use num_complex::Complex64;

/// Decay beyond the turning point, in nepers, after which the wave is neglected.
const EXPONENTS_MAX: f64 = 30.0;
/// Steps of its own grid per radian at the driven end, for an error of the slope there of 1e-5.
const STEPS_PER_RADIAN: f64 = 20.0;
/// Fewest and most steps of that grid.
const STEPS: (f64, f64) = (128.0, 20_000.0);

/// s = (W k)^2 of a width mode over t = (W K)^2: t - s is the cubic in v = t^(-1/2) = 1/(W K) with the mode's values
/// and slopes at the driven end and at the cut-off, continued by the tangent beyond the cut-off. (Far above it t - s
/// is nearly linear in v.)
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModeLaw {
    /// 1/W^2 at the driven end, 1/m^2.
    inverse_square: f64,
    /// t at the driven end.
    t: Complex64,
    /// t at the cut-off.
    cut_off: f64,
    /// ds/dt at the cut-off.
    slope: f64,
    /// Coefficients of u, u^2 and u^3 in t - s; u rises from 0 at the cut-off to 1 at the driven end as v falls.
    across: [Complex64; 3],
}

impl ModeLaw {
    /// The law of width mode `number` of `plate`. At the driven end it has the values `s` and ds/dt = `slope` at `t`,
    /// and 1/W^2 is `inverse_square`.
    pub(super) fn new(
        plate: &Plate,
        number: u32,
        inverse_square: f64,
        t: Complex64,
        [s, slope]: [Complex64; 2],
    ) -> Self {
        let model = &plate.spec().model;
        let (q, slope_at_cut_off) = (model.width_number(number), model.width_slope(number));
        let cut_off = q * q;
        let root = t.sqrt();
        let way = root.inv() - q.recip();
        // d(t - s)/du, with dt/dv = -2 t^(3/2).
        let first = (slope_at_cut_off - 1.0) * 2.0 * q.powi(3) * way;
        let last = (slope - 1.0) * 2.0 * t * root * way;
        let rise = t - s - cut_off;
        let across = [first, 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise];
        Self { inverse_square, t, cut_off, slope: slope_at_cut_off, across }
    }

    /// gamma^2 = -k^2 where sqrt(W0/W) is `scale`, 1/m^2.
    fn decay_squared(&self, scale: f64) -> Complex64 {
        let narrower = scale.powi(4);
        -self.s(self.t / narrower) * (self.inverse_square * narrower)
    }

    fn s(&self, t: Complex64) -> Complex64 {
        let above = t - self.cut_off;
        if above.re <= 0.0 {
            return self.slope * above;
        }
        let v = |t: Complex64| t.sqrt().inv() - self.cut_off.sqrt().recip();
        let u = v(t) / v(self.t);
        let [c1, c2, c3] = self.across;
        above - u * (c1 + u * (c2 + u * c3))
    }
}

/// The wave on a grid.
pub(super) struct TurningWave {
    /// e over its value at x = 0, at the points where it is not 0.
    pub(super) shape: Vec<Complex64>,
    /// g'/g at x = 0, 1/m.
    slope_per_m: Complex64,
}

impl TurningWave {
    /// e'/e at x = 0 on `plate`, 1/m.
    pub(super) fn slope_per_m(law: &ModeLaw, plate: &Plate) -> Complex64 {
        let start = plate.width.at(0.0);
        let radians = law.decay_squared(1.0).norm().sqrt() * plate.length_m();
        let steps = (STEPS_PER_RADIAN * radians).clamp(STEPS.0, STEPS.1).ceil();
        let step_m = plate.length_m() / steps;
        let scale = |i: usize| (0.5 * (start.value - plate.width.at(i as f64 * step_m).value)).exp();
        let scale: Vec<f64> = (0..=steps as usize).map(scale).collect();
        Self::on(law, &scale, step_m).slope_per_m - 0.5 * start.slope
    }

    /// The wave on points in steps of `step_m` from x = 0, where sqrt(W0/W) is `scale`, by Numerov's method from
    /// beyond the turning point, or from the last point.
    pub(super) fn on(law: &ModeLaw, scale: &[f64], step_m: f64) -> Self {
        let mut exponents = 0.0;
        let mut squared: Vec<Complex64> = Vec::with_capacity(scale.len());
        for &scale in scale {
            let here = law.decay_squared(scale);
            squared.push(here);
            // Where the wave propagates, its amplitude falls by loss alone.
            exponents += if here.re > 0.0 { here.sqrt().re * step_m } else { 0.0 };
            if exponents > EXPONENTS_MAX {
                break;
            }
        }
        let Some(last) = squared.len().checked_sub(1) else {
            return Self { shape: Vec::new(), slope_per_m: Complex64::ZERO };
        };
        // y = (1 - h^2/12 gamma^2) g, starting from the wave that leads or decays away from the last point.
        let weight = |i: usize| 1.0 - step_m * step_m / 12.0 * squared[i];
        let mut g = vec![Complex64::ZERO; squared.len()];
        let mut next = Complex64::from(1e-20);
        let mut y = next * (leading_away(squared[last]) * step_m).exp();
        g[last] = y / weight(last);
        for i in (0..last).rev() {
            let before = (12.0 / weight(i + 1) - 10.0) * y - next;
            (next, y) = (y, before);
            g[i] = y / weight(i);
        }
        // g1 = g0 + h g0' + h^2 (g0''/3 + g1''/6), to the fourth order.
        let (first, second, near) = (g[0], g[last.min(1)], squared[last.min(1)]);
        let rise = (second - first) / step_m - step_m * (squared[0] * first / 3.0 + near * second / 6.0);
        let shape = g.iter().zip(scale).map(|(g, scale)| g / first * *scale).collect();
        Self { shape, slope_per_m: rise / first }
    }
}

/// gamma of the wave that leads or decays toward the narrow end.
fn leading_away(squared: Complex64) -> Complex64 {
    let root = squared.sqrt();
    // Without loss the root of a negative number has the wrong sign.
    if root.re <= 1e-12 * root.im { -root } else { root }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::model::Model;
    use crate::definition::presets::preset;
    use crate::special::airy;

    fn clamped() -> Plate {
        let mut spec = preset("al-bending-displacement").expect("a preset").spec().clone();
        spec.model = Model::BendingClamped(spec.model.bending().expect("bending").clone());
        (spec.span_start_m, spec.span_end_m) = (0.1, 0.25);
        Plate::new(spec).expect("valid")
    }

    #[test]
    fn between_the_end_and_the_cut_off_the_cubic_is_the_exact_law() {
        // p tan p + r tanh r = 0 with p^2, r^2 = t -+ s, by bisection in s between two poles of the tangent.
        let exact = |t: f64| {
            let residual = |s: f64| {
                let (p, r) = ((t - s).sqrt(), (t + s).sqrt());
                p * p.sin() + r * r.tanh() * p.cos()
            };
            // p of the second even mode lies in 3 pi/2 .. 2 pi.
            let pi = std::f64::consts::PI;
            let (mut low, mut high) = (t - (2.0 * pi).powi(2), t - (1.5 * pi).powi(2));
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if residual(low) * residual(middle) > 0.0 { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        };
        let t = 100.0;
        let slope = (exact(t + 1e-3) - exact(t - 1e-3)) / 2e-3;
        let law = ModeLaw::new(&clamped(), 3, 1.0, t.into(), [exact(t).into(), slope.into()]);
        for t in [100.0, 80.0, 60.0, 45.0, 31.0, 30.3] {
            let found = law.s(t.into()).re;
            assert!((found - exact(t)).abs() < 0.03, "{t}: {found} for {}", exact(t));
        }
        assert!(law.s(law.cut_off.into()).norm() < 1e-12);
    }

    #[test]
    fn the_wave_turns_as_an_airy_function_does() {
        // gamma^2 = c (x - x0) on 0..2 x0, by the scale that the law has there.
        let (rate, turning_m) = (40.0_f64, 0.3);
        let law = ModeLaw {
            inverse_square: 1.0,
            t: Complex64::from(rate.powi(3) * turning_m + 7.0),
            cut_off: 7.0,
            slope: 1.0,
            across: [Complex64::ZERO; 3],
        };
        // gamma^2 = cut_off n - t with n = scale^4.
        let scale_at = |x: f64| (1.0 + rate.powi(3) * x / 7.0).powf(0.25);
        let step_m = 2e-4;
        let scale: Vec<f64> = (0..=2000).map(|i| scale_at(f64::from(i) * step_m)).collect();
        let wave = TurningWave::on(&law, &scale, step_m);
        let airy = |x: f64| airy::ai(rate * (x - turning_m)) / airy::ai(-rate * turning_m);
        for i in [0, 300, 900, 1500, 1700] {
            let x = f64::from(i) * step_m;
            let found = wave.shape[i as usize] / scale[i as usize];
            assert!((found - airy(x)).norm() < 1e-5, "{x}: {found} for {}", airy(x));
        }
        let slope = (airy(1e-5) - airy(-1e-5)) / 2e-5;
        assert!((wave.slope_per_m - slope).norm() < 1e-4 * slope.abs(), "{} for {slope}", wave.slope_per_m);
    }

    #[test]
    fn a_wave_that_reaches_the_last_point_runs_on() {
        let law = ModeLaw {
            inverse_square: 1.0,
            t: Complex64::from(2500.0),
            cut_off: 1e-9,
            slope: 1.0,
            across: [Complex64::ZERO; 3],
        };
        let wave = TurningWave::on(&law, &[1.0; 400], 1e-3);
        assert!((wave.slope_per_m - 50.0 * Complex64::I).norm() < 1e-3, "{}", wave.slope_per_m);
        assert!(wave.shape.iter().all(|e| (e.norm() - 1.0).abs() < 1e-3));
    }
}
