//! Flat panels of the sheet, and their influence on the air at a point of the sheet.
//!
//! In a rigid baffle a face that moves by w is a source, and the pressure on it is rho omega^2 times
//!
//! ```text
//! S w = integral of w(r') e^(jkR)/(2 pi R),    R = |r - r'|
//! ```
//! without a baffle the sheet is a jump phi of the potential, which is zero outside it, and moves the air along the
//! normal by
//!
//! ```text
//! H phi = finite part of the integral of -phi(r') (1 - jkR) e^(jkR)/(4 pi R^3)
//! ```
//! Both integrals over a polygon with a constant w or phi and k = 0 are sums over its edges. With h the distance of the
//! edge's line from the point (positive where the point is inside) and s1, s2 the ends along it at the distances R1, R2,
//!
//! ```text
//! integral of 1/R = sum of h (asinh(s2/|h|) - asinh(s1/|h|))    integral of -1/R^3 = sum of (s2/R2 - s1/R1)/h
//! ```
//! The remainder of the kernels for k > 0 is smooth except for the (k^2/2)/R of H, so its values at the centres
//! suffice.
//!
//! A table, a rigid wall at the distance g below, mirrors the flow: a jump has an image at 2 g below, which moves the air at the sheet by
//!
//! ```text
//! H' phi = integral of phi(r') (1 - jkR - (y/R)^2 (3 - 3jkR - (kR)^2)) e^(jkR)/(4 pi R^3),    y = 2 g,  R^2 = |r - r'|^2 + y^2
//! ```
//! An endless wave of the wavenumber K has H = K/2 and H + H' = K/2 (1 - e^(-2 K g)): coth(K g) times as much air below.

use super::outline::Outline;
use crate::special::gauss::gauss;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Distance over the panel's longest edge from which it acts as a point: the neglected second moments are below
/// (1/12)/36 of its influence.
const FAR: f64 = 6.0;
/// Distance from the line of an edge, over the edge's length, below which the point lies on the line.
const ON_LINE: f64 = 1e-9;
/// k R below which the remainders of the exponentials are computed by their series.
const SMALL: f64 = 0.02;
/// Distance of an image over the panel's longest edge from which its middle stands for it, and points along and across nearer.
const IMAGE_FAR: f64 = 4.0;
const IMAGE_POINTS: usize = 3;

/// A point of the sheet: x and z, metres.
pub(super) type Point = [f64; 2];

/// A panel on the side z > 0. It represents itself and its mirror image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    /// Counter-clockwise; two corners may coincide.
    corners: [Point; 4],
    /// Point at which the deflection and the normal velocity are evaluated.
    pub(super) centre: Point,
    /// Area weight of its value, without the mirror image's, m^2.
    pub(super) weight: f64,
    area: f64,
    centroid: Point,
    longest: f64,
}

/// The air at the edge of the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kernel {
    /// A rigid baffle: S.
    Source,
    /// No baffle: H.
    Jump,
}

impl Panel {
    /// A panel with the area `weight`, or its own area.
    pub(super) fn new(corners: [Point; 4], centre: Point, weight: Option<f64>) -> Self {
        let mut double = 0.0;
        let mut moment = [0.0; 2];
        let mut longest: f64 = 0.0;
        for (from, to) in edges(&corners) {
            let cross = from[0] * to[1] - to[0] * from[1];
            double += cross;
            moment[0] += cross * (from[0] + to[0]);
            moment[1] += cross * (from[1] + to[1]);
            longest = longest.max((to[0] - from[0]).hypot(to[1] - from[1]));
        }
        let area = 0.5 * double;
        let centroid = moment.map(|moment| moment / (3.0 * double));
        Self { corners, centre, weight: weight.unwrap_or(area), area, centroid, longest }
    }

    /// Extent along x, metres.
    pub(super) fn extent(&self) -> (f64, f64) {
        (self.corners[0][0], self.corners[1][0])
    }

    /// The integrals of 1/R and -1/R^3 over the panel, for a point of its plane.
    fn integrals(&self, point: Point) -> (f64, f64) {
        let away = (self.centroid[0] - point[0]).hypot(self.centroid[1] - point[1]);
        if away > FAR * self.longest {
            return (self.area / away, -self.area / away.powi(3));
        }
        let (mut potential, mut normal) = (0.0, 0.0);
        for (from, to) in edges(&self.corners) {
            let [a, b] = [from, to].map(|end| [end[0] - point[0], end[1] - point[1]]);
            let (dx, dz) = (b[0] - a[0], b[1] - a[1]);
            let length = dx.hypot(dz);
            let h = (a[0] * dz - a[1] * dx) / length;
            // An edge whose line contains the point contributes nothing, and neither does one of zero length, whose h
            // is NaN.
            if h.is_nan() || h.abs() <= ON_LINE * length {
                continue;
            }
            let [s1, s2] = [a, b].map(|end| (end[0] * dx + end[1] * dz) / length);
            let [r1, r2] = [a, b].map(|end| end[0].hypot(end[1]));
            potential += h * ((s2 / h.abs()).asinh() - (s1 / h.abs()).asinh());
            normal += (s2 / r2 - s1 / r1) / h;
        }
        (potential, normal)
    }

    /// What the images of a jump of 1 on the panel and its mirror image in a rigid wall at the distance `gap_m` below add to an element
    /// of H at `point`, 1/m. `places` are those of [`Panel::places`].
    pub(super) fn below(&self, places: &[(Point, f64)], point: Point, k: f64, gap_m: f64) -> Complex64 {
        let y = 2.0 * gap_m;
        let acts = |from: Point, point: Point| {
            let r = (from[0] - point[0]).hypot(from[1] - point[1]).hypot(y);
            let (x, slope) = (Complex64::new(0.0, k * r), (y / r).powi(2));
            (1.0 - x - slope * (3.0 - 3.0 * x + x * x)) * x.exp() / (4.0 * PI * r.powi(3))
        };
        let mut sum = Complex64::ZERO;
        for point in [point, [point[0], -point[1]]] {
            let away = (self.centroid[0] - point[0]).hypot(self.centroid[1] - point[1]).hypot(y);
            sum += if away > IMAGE_FAR * self.longest {
                acts(self.centroid, point) * self.area
            } else {
                places.iter().map(|(from, area)| acts(*from, point) * area).sum()
            };
        }
        sum
    }

    /// Points of the panel with their shares of its area, by Gauss's rule.
    pub(super) fn places(&self) -> Vec<(Point, f64)> {
        let rule = gauss(IMAGE_POINTS);
        let [a, b, c, d] = self.corners;
        let place = |&(u, of_u): &(f64, f64), &(v, of_v): &(f64, f64)| {
            let at = |i: usize| (1.0 - v) * ((1.0 - u) * a[i] + u * b[i]) + v * ((1.0 - u) * d[i] + u * c[i]);
            let along = |i: usize| (1.0 - v) * (b[i] - a[i]) + v * (c[i] - d[i]);
            let across = |i: usize| (1.0 - u) * (d[i] - a[i]) + u * (c[i] - b[i]);
            ([at(0), at(1)], of_u * of_v * (along(0) * across(1) - along(1) * across(0)))
        };
        rule.iter().flat_map(|u| rule.iter().map(move |v| (u, v))).map(|(u, v)| place(u, v)).collect()
    }

    /// Influence of a value of 1 on the panel and its mirror image at `point`: an element of S (metres) or H (1/m),
    /// at the air's wavenumber `k`, 1/m.
    pub(super) fn influence(&self, kernel: Kernel, point: Point, k: f64) -> Complex64 {
        let mut sum = Complex64::ZERO;
        for point in [point, [point[0], -point[1]]] {
            let (potential, normal) = self.integrals(point);
            let distance = (self.centre[0] - point[0]).hypot(self.centre[1] - point[1]);
            let x = k * distance;
            sum += match kernel {
                Kernel::Source => {
                    let smooth = if x < SMALL {
                        Complex64::new(-0.5 * k * x, k)
                    } else {
                        (Complex64::cis(x) - 1.0) / distance
                    };
                    (potential + self.area * smooth) / (2.0 * PI)
                }
                Kernel::Jump => {
                    let smooth = if x < SMALL {
                        Complex64::new(-x / 8.0, 1.0 / 3.0) * k.powi(3)
                    } else {
                        (Complex64::new(1.0, -x) * Complex64::cis(x) - 1.0 - 0.5 * x * x) / distance.powi(3)
                    };
                    (normal - 0.5 * k * k * potential - self.area * smooth) / (4.0 * PI)
                }
            };
        }
        sum
    }
}

fn edges(corners: &[Point; 4]) -> impl Iterator<Item = (Point, Point)> + '_ {
    (0..4).map(|i| (corners[i], corners[(i + 1) % 4]))
}

/// Edges and centres of the panels along a length of 1, and the weights of the centres.
pub(super) struct Division {
    pub(super) edges: Vec<f64>,
    pub(super) centres: Vec<f64>,
    pub(super) shares: Vec<f64>,
}

impl Division {
    /// `count` equal panels.
    pub(super) fn equal(count: usize) -> Self {
        let n = count as f64;
        Self {
            edges: (0..=count).map(|i| i as f64 / n).collect(),
            centres: (0..count).map(|i| (i as f64 + 0.5) / n).collect(),
            shares: vec![n.recip(); count],
        }
    }

    /// `count` equal panels whose first and last edges lie a quarter of a panel inside: for a jump that vanishes as
    /// the root of the distance, their sum is then correct to first order.
    fn inset(count: usize) -> Self {
        let step = (count as f64 + 0.5).recip();
        Self {
            edges: (0..=count).map(|i| (i as f64 + 0.25) * step).collect(),
            centres: (0..count).map(|i| (i as f64 + 0.75) * step).collect(),
            shares: vec![step; count],
        }
    }

    /// From the centre line, 0, to the edge, 1: panel edges at the roots of the Chebyshev polynomial of order
    /// N = 2 `count` + 1 and centres at its extrema, the nodes of the Gauss rule for a flow with an inverse-root
    /// singularity at the edges.
    pub(super) fn chebyshev(count: usize) -> Self {
        let step = PI / (2 * count + 1) as f64;
        let angle = |i: usize, offset: f64| 0.5 * PI - (i as f64 + offset) * step;
        Self {
            edges: (0..=count).map(|i| angle(i, 0.0).cos()).collect(),
            centres: (0..count).map(|i| angle(i, 0.5).cos()).collect(),
            shares: (0..count).map(|i| angle(i, 0.5).sin() * step).collect(),
        }
    }
}

/// The panels of a sheet from `start` to `end`: `along` columns of `across` panels between centre line and edge.
pub(super) fn panels(
    kernel: Kernel,
    outline: &Outline<'_>,
    (start, end): (f64, f64),
    (along, across): (usize, usize),
) -> Vec<Panel> {
    let (columns, rows) = match kernel {
        Kernel::Source => (Division::equal(along), Division::equal(across)),
        Kernel::Jump => (Division::inset(along), Division::chebyshev(across)),
    };
    let length = end - start;
    let width = |x: f64| outline.at(x).value.exp();
    let place = |share: f64| start + share * length;
    let mut panels = Vec::with_capacity(along * across);
    for (pair, (centre, x_share)) in columns.edges.windows(2).zip(columns.centres.iter().zip(&columns.shares))
    {
        let (x, [from, to]) = (place(*centre), [pair[0], pair[1]].map(place));
        let [centre_width, from_width, to_width] = [x, from, to].map(width);
        for (pair, (b, b_share)) in rows.edges.windows(2).zip(rows.centres.iter().zip(&rows.shares)) {
            let corners = [
                [from, pair[0] * from_width],
                [to, pair[0] * to_width],
                [to, pair[1] * to_width],
                [from, pair[1] * from_width],
            ];
            let weight = x_share * length * b_share * centre_width;
            panels.push(Panel::new(corners, [x, b * centre_width], Some(weight)));
        }
    }
    panels
}
