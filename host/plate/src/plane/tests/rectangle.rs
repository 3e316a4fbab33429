//! Eigenfrequencies of plates: the closed form between supported edges, Leissa's tables between clamped edges and
//! with free ends, trapezoids clamped all round.
//!
//! The edges z = +-W are supported or clamped and never free: the polynomials across the width vanish there. So a plate
//! that is free all round is outside this basis. The ends x = 0, L take every condition.

use super::super::basis::Edges;
use super::super::outline::Outline;
use super::super::section::{Energy, Section};
use super::super::system::{Mesh, System};
use crate::definition::taper::WidthLaw;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// Condition of an end x = 0, L.
#[derive(Debug, Clone, Copy)]
enum Condition {
    Free,
    Supported,
    Clamped,
}

/// A plate 0 <= x <= `length`, |z| <= W(x), that narrows linearly from the first half-width to the second.
struct Panel {
    edges: Edges,
    ends: [Condition; 2],
    poisson_ratio: f64,
    length: f64,
    half_widths: [f64; 2],
    elements: f64,
    orders: usize,
}

impl Panel {
    /// A rectangle whose four edges are alike.
    fn rectangle(edges: Edges, length: f64, half_width: f64, elements: f64, orders: usize) -> Self {
        let ends = match edges {
            Edges::Supported | Edges::Turning => [Condition::Supported; 2],
            Edges::Clamped => [Condition::Clamped; 2],
        };
        Self { edges, ends, poisson_ratio: 0.33, length, half_widths: [half_width; 2], elements, orders }
    }

    /// The eigenvalue K^4 that is nearest to `shift`, of the modes that are even in z.
    fn nearest(&self, shift: f64) -> f64 {
        let section =
            Section::new(self.edges, Energy::Bending(self.poisson_ratio), self.orders, [FRAC_PI_2; 2]);
        let mesh = Mesh::new(&[0.0, self.length], self.length / self.elements);
        let [start, end] = self.half_widths;
        let law = WidthLaw::Linear { half_width_m: start, fall: (start - end) / self.length };
        let outline = Outline::Plate { law: &law, rounding_m: 0.0 };
        let system = |stiffness: f64, inertia: f64| {
            let mut system = System::new(&section, &mesh, &outline, |_| stiffness.into(), |_| inertia);
            for (node, end) in [0, mesh.elements()].into_iter().zip(self.ends) {
                match end {
                    Condition::Free => {}
                    Condition::Supported => system.hold(node, 0.0),
                    Condition::Clamped => system.clamp(node),
                }
            }
            system
        };
        let mass = system(0.0, -1.0).matrix;
        let held: Vec<bool> = {
            let free = System::new(&section, &mesh, &outline, |_| Complex64::ZERO, |_| -1.0).matrix;
            let ones: Vec<Complex64> =
                (0..free.order()).map(|i| Complex64::new((i as f64).sin(), 0.0)).collect();
            let (free, bound) = (free.times(&ones), mass.times(&ones));
            free.iter().zip(&bound).map(|(free, bound)| free != bound).collect()
        };
        let by_mass = |vector: &[Complex64]| -> Vec<Complex64> {
            let product = mass.times(vector);
            product
                .iter()
                .zip(&held)
                .map(|(value, held)| if *held { Complex64::ZERO } else { *value })
                .collect()
        };
        let factored = system(1.0, shift).matrix.factor();
        let mut vector: Vec<Complex64> =
            held.iter().enumerate().map(|(i, _)| Complex64::new(1.0 + (i as f64).cos(), 0.0)).collect();
        let mut found = f64::NAN;
        for _ in 0..12 {
            let right = by_mass(&vector);
            let mut next = right.clone();
            factored.solve(&mut next);
            let dot =
                |a: &[Complex64], b: &[Complex64]| a.iter().zip(b).map(|(a, b)| (a * b).re).sum::<f64>();
            found = shift + dot(&next, &right) / dot(&next, &by_mass(&next));
            let largest = next.iter().map(|value| value.norm()).fold(0.0, f64::max);
            vector = next.iter().map(|value| value / largest).collect();
        }
        found
    }
}

#[test]
fn supported_rectangles_have_the_closed_forms_frequencies() {
    for (length, half_width) in [(1.0, 0.5), (3.0, 0.5), (1.0, 1.5)] {
        let rectangle = Panel::rectangle(Edges::Supported, length, half_width, 32.0, 6);
        for (m, n) in [(1.0, 1.0), (2.0, 1.0), (3.0, 1.0), (1.0, 3.0)] {
            let wanted: f64 = (m * PI / length).powi(2) + (n * PI / (2.0 * half_width)).powi(2);
            // Frequencies are proportional to K^2.
            let found = rectangle.nearest(0.99 * wanted * wanted).sqrt();
            assert!((found / wanted - 1.0).abs() < 1e-5, "{length} x {half_width}: {found} {wanted}");
        }
    }
}

#[test]
fn a_clamped_rectangle_three_times_as_long_as_wide_has_leissas_frequency() {
    let lowest = |across: bool, elements: f64, orders: usize| {
        let (length, half_width) = if across { (3.0, 0.5) } else { (1.0, 1.5) };
        Panel::rectangle(Edges::Clamped, length, half_width, elements, orders).nearest(520.0).sqrt()
    };
    let found = lowest(true, 30.0, 6);
    let finer = lowest(true, 60.0, 8);
    let turned = lowest(false, 30.0, 8);
    assert!((found - 23.196).abs() < 6e-4, "{found}");
    assert!((found / finer - 1.0).abs() < 1e-5, "{found} {finer}");
    assert!((turned / finer - 1.0).abs() < 1e-5, "{turned} {finer}");
}

/// Leissa, J. Sound Vib. 31, 257 (1973): plates with two opposite edges supported have exact solutions
/// w = Y(x) cos(m pi z/2W), m = 1, 3, ... Each number is omega a^2 sqrt(rho h/D) with a = 2W and Poisson's ratio 0.3. All
/// were computed again as roots of the exact characteristic equation (Y of cos, sin, cosh and sinh; at a free end
/// Y'' - nu (m pi/a)^2 Y = 0 and Y''' - (2 - nu) (m pi/a)^2 Y' = 0), by a program that shares nothing with this one.
#[test]
fn plates_with_free_ends_between_supported_edges_have_leissas_frequencies() {
    use Condition::{Clamped, Free, Supported};
    for (ends, a_over_b, wanted) in [
        ([Free, Free], 1.0, [9.6314, 16.1348, 36.7256, 87.9867]),
        ([Free, Free], 0.4, [9.7600, 11.0368, 15.0626, 21.7064]),
        ([Free, Free], 2.5, [9.4841, 33.6228, 86.9684, 130.3576]),
        ([Supported, Free], 1.0, [11.6845, 27.7563, 61.8606, 90.2941]),
        ([Clamped, Free], 1.0, [12.6874, 33.0651, 72.3976, 90.6114]),
    ] {
        let panel = Panel {
            edges: Edges::Supported,
            ends,
            poisson_ratio: 0.3,
            length: 1.0 / a_over_b,
            half_widths: [0.5; 2],
            elements: 32.0,
            orders: 6,
        };
        for lambda in wanted {
            let lambda: f64 = lambda;
            let found = panel.nearest(0.995 * lambda * lambda).sqrt();
            println!("{ends:?} a/b {a_over_b}: {found} for {lambda}");
            assert!((found / lambda - 1.0).abs() < 1e-3, "{ends:?} a/b {a_over_b}: {found} for {lambda}");
        }
    }
}

/// The lowest two frequencies of modes that are even in z. A trapezoid with sides 1 and 1/2 at a distance of 1 has
/// 52.2836 and 89.5217 by a Ritz solution that shares nothing with this one (polynomials in x and z times the squares of
/// the edges' equations; from degree 10 to 12 the first moves by 3e-7, the second by 5e-7). The same solution gives the clamped
/// equilateral triangle 99.020 and 189.006, which stay within 1e-6 when a twentieth of it is cut off. No published table of trapezoids was at hand.
#[test]
fn trapezoids_clamped_all_round_have_the_frequencies_of_a_ritz_solution() {
    let trapezoid = |length: f64, end: f64, elements: f64| Panel {
        edges: Edges::Clamped,
        ends: [Condition::Clamped; 2],
        poisson_ratio: 0.3,
        length,
        half_widths: [0.5, end],
        elements,
        orders: 8,
    };
    for (panel, wanted) in [
        (trapezoid(1.0, 0.25, 32.0), [52.2836, 89.5217]),
        (trapezoid(0.95 * 0.75_f64.sqrt(), 0.025, 48.0), [99.020, 189.006]),
    ] {
        for lambda in wanted {
            let lambda: f64 = lambda;
            let found = panel.nearest(0.99 * lambda * lambda).sqrt();
            println!("{:?}: {found} for {lambda}", panel.half_widths);
            assert!((found / lambda - 1.0).abs() < 1e-3, "{:?}: {found} for {lambda}", panel.half_widths);
        }
    }
}
