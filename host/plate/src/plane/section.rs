//! The cross-section: integrals over the width of products of the polynomials, computed once, and the resulting energy
//! of the sheet per length along x at any place of any taper.
//!
//! With b = z/W(x), s = W'/W and w = f(x) p(b),
//!
//! ```text
//! w_x  = f' p - f s b p'                                   w_z  = f p'/W
//! w_xx = f'' p - 2 s f' b p' + f (s^2 (b^2 p'' + b p') - s' b p')
//! w_zz = f p''/W^2                                         w_xz = (f' p' - f s (b p'' + p'))/W
//! ```
//!
//! A membrane has the energy T (w_x v_x + w_z v_z), a plate
//! D ((lap w)(lap v) - (1 - nu)(w_xx v_zz + w_zz v_xx - 2 w_xz v_xz)), both per area; a film has the sum of both. T and
//! D are divided out here. Edges that turn against a rotational stiffness D/c per length have the energy
//! (D/c) (dw/dn) (dv/dn) per length of each edge, with dw/dn = sqrt(1 + W'^2) w_z because w = 0 along the edge.

use super::basis::{Edges, Jet, across};
use crate::definition::log_width::LogWidth;
use crate::special::gauss::gauss;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

/// The energy of a deflection of the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Energy {
    /// Energy of a tension or of a shear modulus, per unit of it.
    Tension,
    /// Energy of bending, per unit of bending stiffness, with this Poisson's ratio.
    Bending(f64),
    /// Sum of both, per unit of the tension.
    Film {
        /// Poisson's ratio.
        poisson_ratio: f64,
        /// s^2, the bending stiffness over the tension, m^2.
        square: f64,
    },
}

impl Energy {
    /// Inertia over modulus of a free wave with K^2 = `squared`: K^2, K^4 or K^2 (1 + s^2 K^2).
    pub(super) fn level(self, squared: f64) -> f64 {
        match self {
            Self::Tension => squared,
            Self::Bending(_) => squared * squared,
            Self::Film { square, .. } => squared * (1.0 + square * squared),
        }
    }

    /// K^2 of the free wave with this level.
    pub(super) fn squared(self, level: f64) -> f64 {
        match self {
            Self::Tension => level,
            Self::Bending(_) => level.sqrt(),
            Self::Film { square, .. } => 2.0 * level / (1.0 + (1.0 + 4.0 * square * level).sqrt()),
        }
    }
}

/// `orders` polynomials across the width and the integrals of their products.
#[derive(Debug, Clone)]
pub(super) struct Section {
    pub(super) edges: Edges,
    pub(super) energy: Energy,
    pub(super) orders: usize,
    /// Integral of p_m p_n over the width, in half-widths: `orders` rows of `orders` numbers, as all the others.
    pub(super) mass: Vec<f64>,
    products: Products,
    /// Coefficients of the polynomial nearest to the first width mode at its cut-off; 1 on the centre line.
    pub(super) mode: Vec<f64>,
    /// The linear form that projects a deflection on that mode; 1 for the mode itself.
    pub(super) projection: Vec<f64>,
    /// b p_n' as a sum of polynomials: the coefficient of p_m is at m orders + n.
    pub(super) slant: Vec<f64>,
    /// 1/c of edges that turn, 1/m; 0 for all others.
    edge_stiffness: f64,
    /// p_n' at the edge b = 1.
    edge_slopes: Vec<f64>,
}

/// Integrals over the width, in half-widths, of the products of two functions: a is p, s is b p', q is b^2 p'' + b p',
/// d is p', c is p'', t is b p'' + p'.
#[derive(Debug, Clone)]
struct Products {
    a_s: Vec<f64>,
    a_q: Vec<f64>,
    a_c: Vec<f64>,
    s_s: Vec<f64>,
    s_q: Vec<f64>,
    s_c: Vec<f64>,
    q_q: Vec<f64>,
    q_c: Vec<f64>,
    c_c: Vec<f64>,
    d_d: Vec<f64>,
    d_t: Vec<f64>,
    t_t: Vec<f64>,
}

/// The energy per length along x as a quadratic form in f, f' and f'' of every polynomial: `terms[i][j]` couples the
/// i-th derivative of the left amplitude with the j-th derivative of the right one.
#[derive(Debug, Clone)]
pub(super) struct Form {
    pub(super) terms: [[Vec<f64>; 3]; 3],
}

impl Section {
    /// `orders` polynomials, and the first width mode at its cut-off: cos(q b) between supported edges, q = pi/2;
    /// between clamped edges that of the clamped beam, q = 2.36502; in a film the clamped sum of cos(q b) and
    /// cosh(r b). The last argument is [q, r].
    pub(super) fn new(edges: Edges, energy: Energy, orders: usize, [q, r]: [f64; 2]) -> Self {
        let points: Vec<(f64, f64, Vec<Jet>)> = gauss(2 * orders + 4)
            .into_iter()
            .map(|(b, weight)| (b, weight, (0..orders).map(|m| across(edges, m, b)).collect()))
            .collect();
        let product = |left: &dyn Fn(f64, Jet) -> f64, right: &dyn Fn(f64, Jet) -> f64| {
            let mut sum = vec![0.0; orders * orders];
            for (b, weight, jets) in &points {
                for (m, p) in jets.iter().enumerate() {
                    // The integral is over half of the width, because the polynomials are even.
                    let factor = 2.0 * weight * left(*b, *p);
                    for (n, p) in jets.iter().enumerate() {
                        sum[m * orders + n] += factor * right(*b, *p);
                    }
                }
            }
            sum
        };
        let a = |_: f64, p: Jet| p.value;
        let s = |b: f64, p: Jet| b * p.slope;
        let q2 = |b: f64, p: Jet| b * (b * p.bend + p.slope);
        let d = |_: f64, p: Jet| p.slope;
        let c = |_: f64, p: Jet| p.bend;
        let t = |b: f64, p: Jet| b * p.bend + p.slope;
        let mass = product(&a, &a);
        let a_s = product(&a, &s);

        let shape = |b: f64| match (edges, energy) {
            (Edges::Supported, _) => (q * b).cos(),
            (Edges::Clamped | Edges::Turning, Energy::Film { .. }) => {
                // cosh(r b)/cosh(r); cosh alone would overflow.
                let bent =
                    |b: f64| (r * (b - 1.0)).exp() * (1.0 + (-2.0 * r * b).exp()) / (1.0 + (-2.0 * r).exp());
                ((q * b).cos() - q.cos() * bent(b)) / (1.0 - q.cos() * bent(0.0))
            }
            (Edges::Clamped | Edges::Turning, Energy::Tension | Energy::Bending(_)) => {
                let (cosine, cosh) = (q.cos(), q.cosh());
                ((q * b).cos() * cosh - (q * b).cosh() * cosine) / (cosh - cosine)
            }
        };
        let mut overlap = DVector::zeros(orders);
        let mut norm = 0.0;
        for (b, weight, jets) in &points {
            let weighed = 2.0 * weight * shape(*b);
            norm += weighed * shape(*b);
            for (m, p) in jets.iter().enumerate() {
                overlap[m] += weighed * p.value;
            }
        }
        let gram = DMatrix::from_row_slice(orders, orders, &mass).lu();
        // The Gram matrix of independent polynomials is regular; should rounding make it singular, the fields are not
        // finite.
        let solve = |right: &DVector<f64>| {
            gram.solve(right).unwrap_or_else(|| DVector::from_element(orders, f64::NAN))
        };
        let mode = solve(&overlap);
        let mut slant = vec![0.0; orders * orders];
        for n in 0..orders {
            let column = solve(&DVector::from_fn(orders, |m, _| a_s[m * orders + n]));
            for m in 0..orders {
                slant[m * orders + n] = column[m];
            }
        }
        Self {
            edges,
            energy,
            orders,
            products: Products {
                a_q: product(&a, &q2),
                a_c: product(&a, &c),
                s_s: product(&s, &s),
                s_q: product(&s, &q2),
                s_c: product(&s, &c),
                q_q: product(&q2, &q2),
                q_c: product(&q2, &c),
                c_c: product(&c, &c),
                d_d: product(&d, &d),
                d_t: product(&d, &t),
                t_t: product(&t, &t),
                a_s,
            },
            mass,
            mode: mode.as_slice().to_vec(),
            projection: overlap.iter().map(|overlap| overlap / norm).collect(),
            slant,
            edge_stiffness: 0.0,
            edge_slopes: (0..orders).map(|m| across(edges, m, 1.0).slope).collect(),
        }
    }

    /// The same with edges that turn by a moment per length over D of 1/`compliance_m` per radian.
    pub(super) fn turning_by(self, compliance_m: f64) -> Self {
        Self { edge_stiffness: compliance_m.recip(), ..self }
    }

    /// A form of zeros of the right size, for [`Section::fill`].
    pub(super) fn form(&self) -> Form {
        let empty = || vec![0.0; self.orders * self.orders];
        Form { terms: std::array::from_fn(|_| std::array::from_fn(|_| empty())) }
    }

    /// Writes the energy per length along x at a place with this width law.
    pub(super) fn fill(&self, law: LogWidth, form: &mut Form) {
        let (width, s, ds) = (law.value.exp(), law.slope, law.curvature);
        let inverse = (width * width).recip();
        let g = &self.products;
        let orders = self.orders;
        // Of both edges, each sqrt(1 + W'^2) dx long.
        let of_edges = 2.0 * self.edge_stiffness * inverse * (1.0 + (s * width).powi(2)).powf(1.5);
        let tension = |at: usize, turned: usize| {
            [s * s * g.s_s[at] + inverse * g.d_d[at], -s * g.a_s[turned], 0.0, self.mass[at], 0.0, 0.0]
        };
        let bending = |nu: f64, at: usize, turned: usize| {
            let twist = 2.0 * (1.0 - nu) * inverse;
            // The factors of f in w_xx + nu w_zz, multiplied by p and by b p'.
            let against_a = |at: usize| s * s * g.a_q[at] - ds * g.a_s[at] + nu * inverse * g.a_c[at];
            let against_s = s * s * g.s_q[turned] - ds * g.s_s[turned] + nu * inverse * g.s_c[turned];
            let cross = s * s * (g.q_c[at] + g.q_c[turned]) - ds * (g.s_c[at] + g.s_c[turned]);
            let along = s * s * (s * s * g.q_q[at] - ds * (g.s_q[at] + g.s_q[turned])) + ds * ds * g.s_s[at];
            [
                along + inverse * (nu * cross + inverse * g.c_c[at]) + twist * s * s * g.t_t[at],
                -2.0 * s * against_s - twist * s * g.d_t[turned],
                against_a(turned),
                4.0 * s * s * g.s_s[at] + twist * g.d_d[at],
                -2.0 * s * g.a_s[turned],
                self.mass[at],
            ]
        };
        for m in 0..orders {
            for n in 0..orders {
                let (at, turned) = (m * orders + n, n * orders + m);
                let [ff, fs, fb, ss, sb, bb] = match self.energy {
                    Energy::Tension => tension(at, turned),
                    Energy::Bending(nu) => bending(nu, at, turned),
                    Energy::Film { poisson_ratio, square } => {
                        let bent = bending(poisson_ratio, at, turned);
                        let stretched = tension(at, turned);
                        std::array::from_fn(|i| stretched[i] + square * bent[i])
                    }
                };
                // `fs` couples f of p_m with f' of p_n; the transposed term couples f' of p_n with f of p_m.
                let turned_edges = of_edges * self.edge_slopes[m] * self.edge_slopes[n];
                form.terms[0][0][at] = width * ff + turned_edges;
                form.terms[0][1][at] = width * fs;
                form.terms[1][0][turned] = width * fs;
                form.terms[0][2][at] = width * fb;
                form.terms[2][0][turned] = width * fb;
                form.terms[1][1][at] = width * ss;
                form.terms[1][2][at] = width * sb;
                form.terms[2][1][turned] = width * sb;
                form.terms[2][2][at] = width * bb;
            }
        }
    }

    /// Value of every polynomial at b = z/W.
    pub(super) fn values(&self, b: f64) -> Vec<f64> {
        (0..self.orders).map(|m| across(self.edges, m, b).value).collect()
    }

    /// Integral over the width of conj(left) right, in half-widths; both functions are given by their coefficients.
    pub(super) fn product(&self, left: &[Complex64], right: &[Complex64]) -> Complex64 {
        let rows = self.mass.chunks_exact(self.orders);
        let weighed =
            rows.map(|row| row.iter().zip(right).map(|(mass, right)| right * mass).sum::<Complex64>());
        left.iter().zip(weighed).map(|(left, weighed)| left.conj() * weighed).sum()
    }

    /// Integral over |b| <= `part` of p_m p_n.
    pub(super) fn mass_within(&self, part: f64) -> Vec<f64> {
        let mut sum = vec![0.0; self.orders * self.orders];
        for (t, weight) in gauss(2 * self.orders + 4) {
            let values = self.values(part * t);
            for (m, left) in values.iter().enumerate() {
                for (n, right) in values.iter().enumerate() {
                    sum[m * self.orders + n] += 2.0 * part * weight * left * right;
                }
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the form with the energy of w(x, z), whose derivatives are finite differences in the plane, on a taper
    /// where every term contributes.
    #[test]
    fn the_form_is_the_energy_in_the_plane() {
        let width = |x: f64| 0.1 * (-4.0 * x - 9.0 * x * x).exp();
        let law = |x: f64| LogWidth { value: width(x).ln(), slope: -4.0 - 18.0 * x, curvature: -18.0 };
        let (x, step, nu) = (0.05, 1e-4, 0.3);
        let f = |x: f64| [(20.0 * x).sin(), 20.0 * (20.0 * x).cos(), -400.0 * (20.0 * x).sin()];
        let g = |x: f64| [(9.0 * x).exp(), 9.0 * (9.0 * x).exp(), 81.0 * (9.0 * x).exp()];
        for (edges, energy) in [
            (Edges::Supported, Energy::Tension),
            (Edges::Supported, Energy::Bending(nu)),
            (Edges::Clamped, Energy::Bending(nu)),
            (Edges::Clamped, Energy::Film { poisson_ratio: nu, square: 1e-4 }),
        ] {
            let section = Section::new(edges, energy, 3, [1.5; 2]);
            let mut form = section.form();
            section.fill(law(x), &mut form);
            for (m, n) in [(0, 0), (1, 2), (2, 1), (2, 2)] {
                let mut sum = 0.0;
                for (i, row) in form.terms.iter().enumerate() {
                    for (j, terms) in row.iter().enumerate() {
                        sum += f(x)[i] * g(x)[j] * terms[m * 3 + n];
                    }
                }
                let w = |x: f64, z: f64| f(x)[0] * across(edges, m, z / width(x)).value;
                let v = |x: f64, z: f64| g(x)[0] * across(edges, n, z / width(x)).value;
                let density = |z: f64| {
                    let bends = |w: &dyn Fn(f64, f64) -> f64| {
                        let (here, s) = (w(x, z), step);
                        let twist = w(x + s, z + s) - w(x + s, z - s) - w(x - s, z + s) + w(x - s, z - s);
                        [
                            (w(x + s, z) - 2.0 * here + w(x - s, z)) / (s * s),
                            (w(x, z + s) - 2.0 * here + w(x, z - s)) / (s * s),
                            twist / (4.0 * s * s),
                            (w(x + s, z) - w(x - s, z)) / (2.0 * s),
                            (w(x, z + s) - w(x, z - s)) / (2.0 * s),
                        ]
                    };
                    let ([wxx, wzz, wxz, wx, wz], [vxx, vzz, vxz, vx, vz]) = (bends(&w), bends(&v));
                    let stretched = wx * vx + wz * vz;
                    let bent =
                        (wxx + wzz) * (vxx + vzz) - (1.0 - nu) * (wxx * vzz + wzz * vxx - 2.0 * wxz * vxz);
                    match energy {
                        Energy::Tension => stretched,
                        Energy::Bending(_) => bent,
                        Energy::Film { square, .. } => stretched + square * bent,
                    }
                };
                let wanted: f64 = gauss(12)
                    .into_iter()
                    .map(|(b, weight)| 2.0 * weight * width(x) * density(b * width(x)))
                    .sum();
                let scale = sum.abs().max(1.0);
                assert!((sum - wanted).abs() < 1e-4 * scale, "{edges:?} {energy:?} {m} {n}: {sum} {wanted}");
            }
        }
    }

    #[test]
    fn the_projection_of_the_width_mode_is_one() {
        for (edges, q) in [(Edges::Supported, std::f64::consts::FRAC_PI_2), (Edges::Clamped, 2.365_020_372)] {
            let section = Section::new(edges, Energy::Bending(0.3), 7, [q; 2]);
            let projected: f64 = section.projection.iter().zip(&section.mode).map(|(a, b)| a * b).sum();
            let centre: f64 = section.values(0.0).iter().zip(&section.mode).map(|(a, b)| a * b).sum();
            assert!((projected - 1.0).abs() < 1e-9 && (centre - 1.0).abs() < 1e-6, "{projected} {centre}");
        }
    }
}
