//! The air at a distance: what the law of the air along a membrane ([`crate::definition::air_along`]) leaves out.
//!
//! In a baffle a moving volume presses on the whole plate, with 1/distance: most of it is the last half-wave before the turning
//! point, and the pressure reaches the sensors. With the kernel of the first width mode, the mean over both widths of the
//! Rayleigh integral of an incompressible air,
//!
//! ```text
//! k(x, x') = w h(|x - x'|/w),   w^2 = W W',   h(r) = (1/pi) integral 0..2 of C(t)/sqrt(r^2 + t^2) dt
//! C(t) = (1 - t/2) cos(pi t/2) + sin(pi t/2)/pi
//! ```
//! the wave p of the law is wrong by p_1 to first order, by p_2 of p_1 to the second and so on,
//!
//! ```text
//! L p_1 = -(1 + j eta) omega^2 (faces rho integral k p dx' - mu W p)/(T W) - j eta K^2 (1 - 1/Omega) p
//!         + (Omega'/Omega) v'/sqrt W + (sqrt Omega)''/sqrt Omega p,   v = sqrt W p
//! ```
//! with the operator L of the amplitude equation: the first term is the integral's part beside the law's mass; the
//! others remove the law's part of the air's power and loss, which the integral contains itself. What p_1 adds of p
//! itself does not matter: the driven end's condition scales both together. A share of it counts: all in a baffle, next
//! to nothing where the air goes round the edges. Of a film T is T + 2 D K^2, its stiffness against a wave that
//! changes.

use crate::definition::air::Air;
use crate::definition::air_along::AirAlong;
use crate::definition::loss_law::LossLaw;
use crate::definition::model::Model;
use crate::definition::plate::Plate;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::LazyLock;

/// Radians of the wave per step of the integral along the plate: the pressure is smooth.
const RADIANS: f64 = 0.3;
/// Points of the table of h's integral, per factor of e of r, and its ends.
const PER_E: f64 = 40.0;
const NEAREST: f64 = 1e-4;
const FARTHEST: f64 = 200.0;
/// Orders of the correction.
const ORDERS: usize = 3;
/// Steps of the integral over t.
const ACROSS: usize = 400;

/// The integral of h from 0, over ln r.
static REACH: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let overlap = |t: f64| (1.0 - 0.5 * t) * (FRAC_PI_2 * t).cos() + (FRAC_PI_2 * t).sin() / PI;
    let t = |i: usize| 2.0 * i as f64 / ACROSS as f64;
    // C is smooth, 1/sqrt is integrated.
    let h = |r: f64| -> f64 {
        let part = |i: usize| {
            let middle = 0.5 * (t(i) + t(i + 1));
            overlap(middle) * ((t(i + 1) / r).asinh() - (t(i) / r).asinh())
        };
        (0..ACROSS).map(part).sum::<f64>() / PI
    };
    let at = |i: usize| NEAREST * (i as f64 / PER_E).exp();
    let count = (PER_E * (FARTHEST / NEAREST).ln()).ceil() as usize;
    // Before the first point h is proportional to -ln r.
    let mut sums = vec![NEAREST * (h(NEAREST) + 1.0 / PI)];
    for i in 1..=count {
        let (from, to) = (at(i - 1), at(i));
        sums.push(sums[i - 1] + (to - from) * h((from * to).sqrt()));
    }
    sums
});

/// The integral of h from 0 to `r`; odd in r.
fn reach(r: f64) -> f64 {
    let place = ((r.abs() / NEAREST).ln() * PER_E).max(0.0);
    let (index, share) = (place as usize, place.fract());
    let table = &*REACH;
    let last = table.len() - 1;
    let value = if index >= last {
        table[last]
    } else if r.abs() < NEAREST {
        table[0] * r.abs() / NEAREST
    } else {
        table[index] + share * (table[index + 1] - table[index])
    };
    value.copysign(r)
}

/// The correction on a grid along a membrane in air.
#[derive(Debug, Clone)]
pub(crate) struct FarAir {
    share: f64,
    step_m: f64,
    /// Grid points from one place of the integral to the next.
    stride: usize,
    /// faces rho k over a stride, at each pair of places, over T W0.
    kernel: Vec<f64>,
    places: usize,
    /// sigma/T, and eta.
    slowness_squared: f64,
    loss: LossLaw,
    /// D/T of a film, m^2; 0 of an ideal membrane.
    film_square: f64,
}

/// A wave on the grid, whose point -1 has the index 0, and Q there: g'' + Q g = 0, f = g/sqrt(Omega W/W0).
pub(crate) struct OnGrid<'a> {
    pub(crate) g: &'a mut [Complex64],
    pub(crate) q: &'a [Complex64],
    /// (q/s)^2.
    pub(crate) width_square: &'a [f64],
    /// 1/sqrt(W/W0) on the plate.
    pub(crate) scale: &'a [f64],
}

impl FarAir {
    /// On `points` from the driven end to the plate's end. `None` where the plate is no membrane in air, or where the share is 0.
    pub(crate) fn of(plate: &Plate, points: usize) -> Option<Self> {
        let spec = plate.spec();
        let (
            Some(air @ Air::Around { gas, mounting, .. }),
            Model::Membrane { wave_speed_m_per_s: speed, .. },
        ) = (&spec.air, &spec.model)
        else {
            return None;
        };
        let share = air.distant();
        let surface_density = spec.model.surface_density("[air]").ok().filter(|_| share != 0.0)?;
        let density = mounting.coefficient().1.count() * gas.density_kg_per_m3();
        let step_m = plate.length_m() / (points - 1) as f64;
        let shortest = plate.wavenumber_squared(plate.band_hz().1).sqrt();
        let stride = ((RADIANS / (shortest * step_m)) as usize).clamp(1, points - 1);
        let half_width_m = |i: usize| plate.swinging_half_width_m(i as f64 * step_m);
        let start_m = half_width_m(0);
        let wide: Vec<f64> = (0..points).step_by(stride).map(half_width_m).collect();
        let apart_m = stride as f64 * step_m;
        let over_tension = density / (surface_density * speed * speed * start_m);
        let mut kernel = Vec::with_capacity(wide.len() * wide.len());
        for (i, here) in wide.iter().enumerate() {
            for (j, there) in wide.iter().enumerate() {
                let width_m = (here * there).sqrt();
                let distance = i.abs_diff(j) as f64 * apart_m;
                let [near, far] =
                    [distance - 0.5 * apart_m, distance + 0.5 * apart_m].map(|it| reach(it / width_m));
                kernel.push(over_tension * width_m * width_m * (far - near));
            }
        }
        let slowness_squared = (speed * speed).recip();
        let (places, loss) = (wide.len(), plate.loss_law());
        let film_square = spec.model.film_square().unwrap_or(0.0);
        Some(Self { share, step_m, stride, kernel, places, slowness_squared, loss, film_square })
    }

    /// Adds the correction to the wave of the law at this frequency; what it adds to the slope of g at the driven end.
    pub(crate) fn add(&self, air: &AirAlong, frequency_hz: f64, wave: OnGrid<'_>) -> Complex64 {
        let OnGrid { g, q, width_square, scale } = wave;
        // The wave is 0 beyond.
        let count = q.len().min(scale.len()) - 1;
        let places = self.places(air, frequency_hz, (&width_square[1..=count], &scale[..count]));
        let law = g[..=count].to_vec();
        let squares: f64 = law.iter().map(Complex64::norm_sqr).sum();
        let pushed = Pushed::new(&q[..=count], self.step_m);
        let h2 = pushed.h2;
        let (mut of_order, mut slope) = (law.clone(), Complex64::ZERO);
        for _ in 0..ORDERS {
            let r = self.push(&places, &of_order);
            of_order = pushed.by(&r);
            // It has no share of the wave itself, which would count against the rest.
            let products = law.iter().zip(&of_order).map(|(law, g)| law.conj() * g);
            let of_wave = products.sum::<Complex64>() / squares;
            for ((g, law), whole) in of_order.iter_mut().zip(&law).zip(&mut *g) {
                *g -= of_wave * law;
                *whole += *g;
            }
            // g''' = r' - (Q g)'.
            let side = |i: usize| of_order[i] * (1.0 + 2.0 * h2 * q[i]) - 2.0 * h2 * r[i];
            slope += (side(2) - side(0)) / (2.0 * self.step_m);
        }
        slope
    }

    /// What is the same for all orders at one frequency, at the points on the plate.
    fn places(
        &self,
        air: &AirAlong,
        frequency_hz: f64,
        (width_square, scale): (&[f64], &[f64]),
    ) -> (Vec<Place>, Complex64) {
        let omega_squared = (TAU * frequency_hz).powi(2);
        let bent = |squared: f64| 1.0 + self.film_square * squared;
        let loss = self.loss.at(frequency_hz);
        let h = self.step_m;
        let omega = |(i, square): (usize, &f64)| air.weight_from_end(*square, i as f64 * h);
        let roots: Vec<f64> = width_square.iter().enumerate().map(|it| omega(it).sqrt()).collect();
        let last = roots.len() - 1;
        let place = |(i, (square, scale)): (usize, (&f64, &f64))| {
            let here = air.at(*square);
            let squared = here.wavenumber_squared;
            // Omega is even about the driven end.
            let [y_before, root, y_after] = [i.abs_diff(1).min(last), i, (i + 1).min(last)].map(|i| roots[i]);
            Place {
                scale: *scale,
                root,
                growth: if 0 < i && i < last { (y_after - y_before) / (root * h) } else { 0.0 },
                bend: if i < last { (y_after - 2.0 * root + y_before) / (root * h * h) } else { 0.0 },
                mass: squared * bent(squared) - omega_squared * self.slowness_squared,
                // The integral itself contains the air's power and loss, which the law has, too.
                lost: squared * loss * (air.stiffness - here.loss_share),
                far: omega_squared * scale,
            }
        };
        let places = width_square.iter().zip(scale).enumerate().map(place).collect();
        let stiffer = bent(air.turning) / air.stiffness;
        (places, Complex64::new(1.0, loss * air.stiffness) / stiffer)
    }

    /// r of the next order, from point -1 on, by g of this one.
    fn push(&self, (places, lossy): &(Vec<Place>, Complex64), g: &[Complex64]) -> Vec<Complex64> {
        // v = sqrt(W/W0) f.
        let v: Vec<Complex64> = g[1..].iter().zip(places).map(|(g, place)| g / place.root).collect();
        let at_places = v.iter().zip(places).map(|(v, place)| v * place.scale).step_by(self.stride);
        // The kernel is symmetric: a place's row has its share of the pressure at all places, which are added side by side.
        let mut pressures = vec![Complex64::ZERO; self.places];
        for (f, row) in at_places.zip(self.kernel.chunks_exact(self.places)) {
            pressures.iter_mut().zip(row).for_each(|(pressure, k)| *pressure += f * k);
        }
        let last = v.len() - 1;
        let push = |i: usize| {
            let (index, share) = (i / self.stride, (i % self.stride) as f64 / self.stride as f64);
            let next = pressures[(index + 1).min(self.places - 1)];
            let far = pressures[index] + (next - pressures[index]) * share;
            let place = &places[i];
            let of_air = (far * place.far - v[i] * place.mass) * lossy;
            let (before, after) = (i.abs_diff(1).min(last), (i + 1).min(last));
            let rise = (v[after] - v[before]) / (2.0 * self.step_m);
            let own = v[i] * Complex64::new(-place.bend, place.lost) - rise * place.growth;
            (of_air + own) * (-self.share * place.root)
        };
        // At point -1 that of point 0.
        std::iter::once(0).chain(0..v.len()).map(push).collect()
    }
}

/// What is the same for all orders at one frequency and point.
struct Place {
    /// 1/sqrt(W/W0), and that times omega^2.
    scale: f64,
    far: f64,
    /// y = sqrt Omega, 2 y'/y in 1/m, and y''/y in 1/m^2.
    root: f64,
    growth: f64,
    bend: f64,
    /// What the law's air carries, and what it loses, 1/m^2.
    mass: f64,
    lost: f64,
}

/// g'' + Q g = r for waves that leave the driven end and follow r in the tail, by Numerov's method: its equations are solved from the
/// driven end to the tail once, for every r.
struct Pushed<'a> {
    /// Q, and h^2/12.
    squared: &'a [Complex64],
    h2: f64,
    /// What is left on the diagonal, what stands after it, and the share of each equation that is taken from the next one.
    diagonal: Vec<Complex64>,
    above: Vec<Complex64>,
    share: Vec<Complex64>,
}

impl<'a> Pushed<'a> {
    fn new(squared: &'a [Complex64], step_m: f64) -> Self {
        let last = squared.len() - 1;
        let h2 = step_m * step_m / 12.0;
        let factor = |i: usize| 1.0 + h2 * squared[i];
        let [mut diagonal, mut above] = [Complex64::ONE, Complex64::ZERO].map(|it| vec![it; last + 1]);
        let mut share = vec![Complex64::ZERO; last + 1];
        let away = (squared[0].sqrt() * step_m * Complex64::new(0.0, -1.0)).exp();
        (diagonal[0], above[0]) = (away, -Complex64::ONE);
        for i in 1..last {
            diagonal[i] = 10.0 * factor(i) - 12.0;
            above[i] = factor(i + 1);
            share[i] = factor(i - 1) / diagonal[i - 1];
            diagonal[i] -= share[i] * above[i - 1];
        }
        Self { squared, h2, diagonal, above, share }
    }

    /// The wave of this r.
    fn by(&self, push: &[Complex64]) -> Vec<Complex64> {
        let last = self.squared.len() - 1;
        let mut found = vec![Complex64::ZERO; last + 1];
        for i in 1..last {
            let right = self.h2 * (push[i - 1] + 10.0 * push[i] + push[i + 1]);
            found[i] = right - self.share[i] * found[i - 1];
        }
        found[last] = push[last] / self.squared[last];
        for i in (0..last).rev() {
            found[i] = (found[i] - self.above[i] * found[i + 1]) / self.diagonal[i];
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_matches_its_limits_near_and_far() {
        // Far away the width's volume is at a point: h = (8/pi^3)/r.
        let far = (reach(100.0) - reach(50.0)) / std::f64::consts::LN_2;
        assert!((far / (8.0 / PI.powi(3)) - 1.0).abs() < 1e-3, "{far}");
        // Beside it h = (ln(1/r) + a)/pi: three doublings of r give it.
        let h = |r: f64| (reach(1.01 * r) - reach(0.99 * r)) / (0.02 * r);
        for r in [1e-3, 4e-3] {
            let rise = (h(r) - h(2.0 * r)) / std::f64::consts::LN_2;
            assert!((rise * PI - 1.0).abs() < 0.05, "{r}: {rise}");
        }
        assert_eq!(reach(-0.3), -reach(0.3));
    }

    /// A wave far from its turning point on a strip of one width has the mass of the strip's spectrum at k = 1 and 2 q/W: 1.128 and
    /// 1.026 (an integral of cos^2(pi s/2)/((1 - s^2)^2 sqrt(k^2 + s^2)) of its own).
    #[test]
    fn a_wave_on_a_strip_has_the_mass_of_its_spectrum() {
        let step = 0.01;
        for (number, wanted) in [(1.0, 1.128), (2.0, 1.026)] {
            let k = number * FRAC_PI_2;
            let of = |i: i32| {
                (reach((f64::from(i) + 0.5) * step) - reach((f64::from(i) - 0.5) * step))
                    * (k * f64::from(i) * step).cos()
            };
            let integral: f64 = (-6000..=6000).map(of).sum();
            let alpha = integral * k.hypot(FRAC_PI_2);
            assert!((alpha / wanted - 1.0).abs() < 3e-3, "{number}: {alpha}");
        }
    }
}
