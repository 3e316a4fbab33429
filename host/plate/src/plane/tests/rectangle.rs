//! Eigenfrequencies of rectangles: the closed form between supported edges, Leissa's table between clamped ones.

use super::super::basis::Edges;
use super::super::outline::Outline;
use super::super::section::{Energy, Section};
use super::super::system::{Mesh, System};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// A rectangle 0 <= x <= `length`, |z| <= `half_width`; all four edges alike.
struct Rectangle {
    edges: Edges,
    length: f64,
    half_width: f64,
    elements: f64,
    orders: usize,
}

impl Rectangle {
    /// The eigenvalue K^4 that is nearest to `shift`, of the modes that are even in z.
    fn nearest(&self, shift: f64) -> f64 {
        let section = Section::new(self.edges, Energy::Bending(0.33), self.orders, [FRAC_PI_2; 2]);
        let mesh = Mesh::new(&[0.0, self.length], self.length / self.elements);
        let outline = Outline::Uniform(self.half_width.ln());
        let system = |stiffness: f64, inertia: f64| {
            let mut system = System::new(&section, &mesh, &outline, |_| stiffness.into(), |_| inertia);
            for node in [0, mesh.elements()] {
                match self.edges {
                    Edges::Supported | Edges::Turning => system.hold(node, 0.0),
                    Edges::Clamped => system.clamp(node),
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
        let rectangle = Rectangle { edges: Edges::Supported, length, half_width, elements: 32.0, orders: 6 };
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
        Rectangle { edges: Edges::Clamped, length, half_width, elements, orders }.nearest(520.0).sqrt()
    };
    let found = lowest(true, 30.0, 6);
    let finer = lowest(true, 60.0, 8);
    let turned = lowest(false, 30.0, 8);
    assert!((found - 23.196).abs() < 6e-4, "{found}");
    assert!((found / finer - 1.0).abs() < 1e-5, "{found} {finer}");
    assert!((turned / finer - 1.0).abs() < 1e-5, "{turned} {finer}");
}
