//! All waves of a clamped strip at one frequency: the propagating one and the evanescent ones.
//!
//! Across the width a wave is a sum of polynomials with value and slope zero at the edges, p_i(b), b = z/W, orthonormal
//! over b = -1..1. With B = integral of p_i' p_j', C = integral of p_i'' p_j'' and s = (W k)^2 the plate's equation is
//!
//! (s^2 + 2 s B + C) v = t^2 v,   t = (W K)^2,
//!
//! quadratic in s. It has two solutions s per polynomial; of k = +-sqrt(s)/W one leads or decays away from an end.

use crate::order;
use nalgebra::{DMatrix, DVector, Schur};
use num_complex::Complex64;
use std::sync::LazyLock;

/// Polynomials across the width, for an error of the end's reflection of 1e-3.
pub(super) const ORDERS: usize = 5;
/// Steps of the inverse iteration for a shape; each is exact to rounding if the waves are distinct.
const SHAPE_STEPS: usize = 3;

/// The polynomials across the width and their products.
pub(super) struct Section {
    /// B, see above.
    pub(super) slope: DMatrix<f64>,
    /// C.
    bend: DMatrix<f64>,
    /// Each polynomial on the centre line.
    centre: DVector<f64>,
    /// The width mode at its cut-off, 1 on the centre line.
    pub(super) mode: DVector<f64>,
    /// The linear form that gives the component of that mode in a deflection.
    pub(super) projection: DVector<f64>,
}

/// A wave v e^(jkx).
pub(super) struct Wave {
    /// k of the wave that leads or decays toward positive x, 1/m.
    pub(super) wavenumber: Complex64,
    /// Its component on each polynomial.
    pub(super) shape: DVector<Complex64>,
    /// Its value on the centre line.
    pub(super) centre: Complex64,
    /// ds/dt.
    pub(super) slope: Complex64,
}

/// A polynomial in b, constant term first.
#[derive(Clone)]
struct Polynomial(Vec<f64>);

impl Polynomial {
    fn derivative(&self) -> Self {
        Self(self.0.iter().enumerate().skip(1).map(|(power, term)| power as f64 * term).collect())
    }

    /// Integral over b = -1..1 of the product of two polynomials.
    fn product(&self, other: &Self) -> f64 {
        let terms = self.0.iter().enumerate().flat_map(|(i, a)| {
            other
                .0
                .iter()
                .enumerate()
                .filter(move |(j, _)| (i + j) % 2 == 0)
                .map(move |(j, b)| (i + j, a * b))
        });
        terms.map(|(power, term)| 2.0 * term / (power + 1) as f64).sum()
    }

    fn less(&self, share: f64, other: &Self) -> Self {
        let size = self.0.len().max(other.0.len());
        let at = |terms: &[f64], i: usize| terms.get(i).copied().unwrap_or(0.0);
        Self((0..size).map(|i| at(&self.0, i) - share * at(&other.0, i)).collect())
    }
}

/// (1 - b^2)^2 b^(2m), orthonormalised in order.
fn polynomials() -> Vec<Polynomial> {
    let mut found: Vec<Polynomial> = Vec::with_capacity(ORDERS);
    for order in 0..ORDERS {
        let mut terms = vec![0.0; 2 * order];
        terms.extend([1.0, 0.0, -2.0, 0.0, 1.0]);
        let mut next = Polynomial(terms);
        // Twice: the second pass removes the components that rounding leaves in the first.
        for _ in 0..2 {
            next = found.iter().fold(next, |next, other| next.less(next.product(other), other));
        }
        let norm = next.product(&next).sqrt();
        found.push(Polynomial(next.0.iter().map(|term| term / norm).collect()));
    }
    found
}

/// The section, computed once.
pub(super) fn section() -> &'static Section {
    static SECTION: LazyLock<Section> = LazyLock::new(|| {
        let value = polynomials();
        let slope: Vec<Polynomial> = value.iter().map(Polynomial::derivative).collect();
        let bend: Vec<Polynomial> = slope.iter().map(Polynomial::derivative).collect();
        let products = |all: &[Polynomial]| DMatrix::from_fn(ORDERS, ORDERS, |i, j| all[i].product(&all[j]));
        let centre = DVector::from_fn(ORDERS, |i, _| value[i].0[0]);
        let (slope, bend) = (products(&slope), products(&bend));
        // At the cut-off s = 0, so the mode is the lowest eigenvector of C.
        let eigen = bend.clone().symmetric_eigen();
        let lowest = eigen.eigenvalues.imin();
        let mode: DVector<f64> = eigen.eigenvectors.column(lowest).into();
        let mode = &mode / mode.dot(&centre);
        let projection = &mode / mode.norm_squared();
        Section { slope, bend, centre, mode, projection }
    });
    &SECTION
}

impl Section {
    /// The waves at t = `t` in a strip of half-width `half_width_m`, the one with s nearest to `propagating` first.
    pub(super) fn waves(&self, t: Complex64, half_width_m: f64, propagating: Complex64) -> Vec<Wave> {
        let complex = |value: f64| Complex64::from(value);
        let still = self.bend.map(complex) - DMatrix::identity(ORDERS, ORDERS) * (t * t);
        // s v = u, s u = -2 B u - (C - t^2) v.
        let mut companion = DMatrix::<Complex64>::zeros(2 * ORDERS, 2 * ORDERS);
        for i in 0..ORDERS {
            companion[(i, ORDERS + i)] = Complex64::ONE;
            for j in 0..ORDERS {
                companion[(ORDERS + i, j)] = -still[(i, j)];
                companion[(ORDERS + i, ORDERS + j)] = complex(-2.0 * self.slope[(i, j)]);
            }
        }
        let triangle = Schur::new(companion).unpack().1;
        let mut squares: Vec<Complex64> = (0..2 * ORDERS).map(|i| triangle[(i, i)]).collect();
        order::sort_by(&mut squares, |a, b| (a - propagating).norm().total_cmp(&(b - propagating).norm()));
        squares.into_iter().map(|square| self.wave(t, square, &still, half_width_m)).collect()
    }

    fn wave(&self, t: Complex64, square: Complex64, still: &DMatrix<Complex64>, half_width_m: f64) -> Wave {
        // Slightly off the eigenvalue, so that the matrix can be factored.
        let near = square * (1.0 + 1e-11);
        let matrix = still
            + self.slope.map(|value| 2.0 * near * value)
            + DMatrix::identity(ORDERS, ORDERS) * (near * near);
        let factors = matrix.lu();
        let mut shape = DVector::from_fn(ORDERS, |i, _| Complex64::new(1.0, 0.1 * i as f64));
        for _ in 0..SHAPE_STEPS {
            shape = factors.solve(&shape).unwrap_or(shape);
            shape /= Complex64::from(shape.norm());
        }
        let root = square.sqrt();
        // Decaying, or without loss leading, toward positive x.
        let root = if root.im < 0.0 { -root } else { root };
        let centre = shape.iter().zip(&self.centre).map(|(share, centre)| share * centre).sum();
        // From v (s^2 + 2 s B + C - t^2) v = 0, whose matrix is symmetric.
        let product =
            |other: DVector<Complex64>| shape.iter().zip(&other).map(|(a, b)| a * b).sum::<Complex64>();
        let bent = self.slope.map(Complex64::from) * &shape + &shape * square;
        let slope = t * product(shape.clone()) / product(bent);
        Wave { wavenumber: root / half_width_m, shape, centre, slope }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::clamped_strip::{CUT_OFF, StripLaw};

    #[test]
    fn the_propagating_wave_matches_the_exact_law() {
        for (ratio, loss, allowed) in [(1.02_f64, 0.0, 1e-6), (1.5, 0.05, 1e-6), (3.0, 0.0, 1e-4)] {
            let steps = 40;
            let law = (1..=steps).fold(StripLaw::at_cut_off(), |law, i| {
                let part = f64::from(i) / f64::from(steps);
                law.step_to(CUT_OFF * ratio.powf(2.0 * part) * Complex64::new(1.0, loss * part))
            });
            let waves = section().waves(law.t, 0.02, law.s);
            assert_eq!(waves.len(), 2 * ORDERS);
            let s = (waves[0].wavenumber * 0.02).powi(2);
            assert!((s - law.s).norm() < allowed * law.s.norm(), "{ratio}: {s} for {}", law.s);
            assert!(waves.iter().all(|wave| wave.wavenumber.im >= -1e-9), "a wave grows away from the end");
        }
    }

    #[test]
    fn each_wave_meets_the_plates_equation() {
        let section = section();
        let t = 9.0 * Complex64::new(1.0, 0.02);
        for wave in section.waves(t, 1.0, Complex64::from(4.6)) {
            let s = wave.wavenumber * wave.wavenumber;
            let forces = (section.slope.map(Complex64::from) * &wave.shape) * (2.0 * s)
                + section.bend.map(Complex64::from) * &wave.shape
                + &wave.shape * (s * s - t * t);
            assert!(forces.norm() < 1e-7 * s.norm_sqr().max(1.0), "{s}: {}", forces.norm());
        }
    }

    #[test]
    fn the_mode_at_the_cut_off_equals_the_clamped_beams() {
        let section = section();
        // Mean square of the mode that is 1 on the centre line: 0.793/2.
        assert!((section.mode.norm_squared() - 0.792_97).abs() < 1e-4, "{}", section.mode.norm_squared());
        assert!((section.projection.dot(&section.mode) - 1.0).abs() < 1e-12);
        let energy = (&section.bend * &section.mode).dot(&section.mode) / section.mode.norm_squared();
        assert!((energy / (CUT_OFF * CUT_OFF) - 1.0).abs() < 1e-9, "{energy}");
    }
}
