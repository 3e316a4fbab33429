//! The system of equations of one sheet at one frequency: stiffness minus inertia over all elements, and what acts on
//! a node.
//!
//! An unknown is f_m at a node, or its slope there times [`Mesh::unit_m`]. A node has `2 orders` unknowns, so an element
//! couples at most `4 orders` neighbours: the matrix is a band.

use super::band_matrix::BandMatrix;
use super::basis::along;
use super::outline::Outline;
use super::section::Section;
use crate::special::gauss::gauss;
use num_complex::Complex64;

/// Points per element of the integration along x: exact for the products of two cubics.
const GAUSS_ALONG: usize = 4;

/// The nodes along x.
#[derive(Debug, Clone)]
pub(super) struct Mesh {
    /// Rising positions, metres.
    pub(super) nodes: Vec<f64>,
    /// Length that the slopes are multiplied by, metres.
    pub(super) unit_m: f64,
}

impl Mesh {
    /// Nodes at most `longest_m` apart with one at each of the `places` (rising), the first and the last included.
    pub(super) fn new(places: &[f64], longest_m: f64) -> Self {
        let mut nodes = vec![places[0]];
        for pair in places.windows(2) {
            let length = pair[1] - pair[0];
            // Places that nearly meet would make an element without length.
            if length <= 1e-3 * longest_m {
                continue;
            }
            let count = (length / longest_m).ceil().max(1.0);
            nodes.extend((1..=count as usize).map(|i| pair[0] + length * i as f64 / count));
        }
        Self { nodes, unit_m: longest_m }
    }

    pub(super) fn elements(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Start and length of an element, metres.
    pub(super) fn element(&self, number: usize) -> (f64, f64) {
        (self.nodes[number], self.nodes[number + 1] - self.nodes[number])
    }

    /// The element that holds `x` and the place in it from 0 to 1; beyond the ends that of the nearest end.
    pub(super) fn locate(&self, x: f64) -> (usize, f64) {
        let after = self.nodes.partition_point(|&node| node <= x);
        let number = after.saturating_sub(1).min(self.elements() - 1);
        let (start, length) = self.element(number);
        (number, ((x - start) / length).clamp(0.0, 1.0))
    }

    /// The node at `x`.
    pub(super) fn node_at(&self, x: f64) -> usize {
        let (number, t) = self.locate(x);
        number + usize::from(t > 0.5)
    }
}

/// The equations before they are solved.
pub(super) struct System<'a> {
    pub(super) section: &'a Section,
    pub(super) mesh: &'a Mesh,
    pub(super) matrix: BandMatrix,
    pub(super) right: Vec<Complex64>,
    /// What the conditions have done to the rows, in this order.
    changes: Vec<RowChange>,
}

/// What a condition does to the rows of the equations.
enum RowChange {
    /// Adds `factor` times one to another.
    Add { source: usize, target: usize, factor: f64 },
    /// Replaces one by a condition.
    Replace(usize),
}

impl<'a> System<'a> {
    /// Sums up `stiffness(x)` times the energy minus `inertia(x)` times the integral of w v over every element; x is the
    /// middle of the element.
    pub(super) fn new(
        section: &'a Section,
        mesh: &'a Mesh,
        outline: &Outline<'_>,
        stiffness: impl Fn(f64) -> Complex64,
        inertia: impl Fn(f64) -> f64,
    ) -> Self {
        let per_node = 2 * section.orders;
        let unknowns = per_node * mesh.nodes.len();
        let mut matrix = BandMatrix::new(unknowns, 2 * per_node - 1);
        let square = section.orders * section.orders;
        let mut form = section.form();
        let rule = gauss(GAUSS_ALONG);
        let mut energy: [[Vec<f64>; 4]; 4] =
            std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; square]));
        let mut partial: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; square]);
        for element in 0..mesh.elements() {
            let (start, h) = mesh.element(element);
            let mut mass = [[0.0; 4]; 4];
            energy.iter_mut().flatten().for_each(|block| block.fill(0.0));
            for &(t, weight) in &rule {
                let law = outline.at(start + t * h);
                section.fill(law, &mut form);
                let cubics = along(t, h, mesh.unit_m);
                for (right, b) in cubics.iter().enumerate() {
                    for (sum, terms) in partial.iter_mut().zip(&form.terms) {
                        for (at, sum) in sum.iter_mut().enumerate() {
                            *sum = b[0] * terms[0][at] + b[1] * terms[1][at] + b[2] * terms[2][at];
                        }
                    }
                    for (left, a) in cubics.iter().enumerate().take(right + 1) {
                        let [a0, a1, a2] = a.map(|derivative| derivative * weight * h);
                        for (at, sum) in energy[left][right].iter_mut().enumerate() {
                            *sum += a0 * partial[0][at] + a1 * partial[1][at] + a2 * partial[2][at];
                        }
                        mass[left][right] += a0 * b[0] * law.value.exp();
                    }
                }
            }
            let middle = start + 0.5 * h;
            let (stiffness, inertia) = (stiffness(middle), inertia(middle));
            for right in 0..4 {
                for left in 0..=right {
                    let inertia = inertia * mass[left][right];
                    for (at, &energy) in energy[left][right].iter().enumerate() {
                        let value = stiffness * energy - inertia * section.mass[at];
                        let row = unknown(section, element, left, at / section.orders);
                        let column = unknown(section, element, right, at % section.orders);
                        matrix.add(row, column, value);
                        if left != right {
                            matrix.add(column, row, value);
                        }
                    }
                }
            }
        }
        Self { section, mesh, matrix, right: vec![Complex64::ZERO; unknowns], changes: Vec::new() }
    }

    /// Index of f of a polynomial at a node; its slope is the next.
    fn unknown(&self, node: usize, order: usize) -> usize {
        unknown(self.section, node, 0, order)
    }

    /// Adds what resists the deflection of the width mode at a node: force = `stiffness` times deflection.
    pub(super) fn resist(&mut self, node: usize, stiffness: Complex64) {
        let projection = &self.section.projection;
        for (m, left) in projection.iter().enumerate() {
            for (n, right) in projection.iter().enumerate() {
                self.matrix.add(self.unknown(node, m), self.unknown(node, n), stiffness * left * right);
            }
        }
    }

    /// A force on the width mode at a node.
    pub(super) fn push(&mut self, node: usize, force: Complex64) {
        for (m, projection) in self.section.projection.iter().enumerate() {
            let row = self.unknown(node, m);
            self.right[row] += force * projection;
        }
    }

    /// Holds the deflection of a node to `amplitude` times the width mode.
    pub(super) fn hold(&mut self, node: usize, amplitude: f64) {
        for (m, share) in self.section.mode.iter().enumerate() {
            let row = self.unknown(node, m);
            self.prescribe(row, (share * amplitude).into());
        }
    }

    /// Holds dw/dx = 0 at a node where W'/W is `narrowing`: f_m' = W'/W times the coefficient of p_m in sum f_n b p_n'.
    ///
    /// Call it before [`System::hold`] of the same node.
    pub(super) fn guide(&mut self, node: usize, narrowing: f64) {
        let orders = self.section.orders;
        let factor = |m: usize, n: usize| self.mesh.unit_m * narrowing * self.section.slant[m * orders + n];
        for m in 0..orders {
            let slope = self.unknown(node, m) + 1;
            for n in 0..orders {
                // Virtual deflections obey the condition too.
                self.add_row(slope, self.unknown(node, n), factor(m, n));
            }
        }
        for m in 0..orders {
            let slope = self.unknown(node, m) + 1;
            self.prescribe(slope, Complex64::ZERO);
            for n in 0..orders {
                self.matrix.add(slope, self.unknown(node, n), (-factor(m, n)).into());
            }
        }
    }

    /// Adds `stiffness` per area over the patch |x - `place`| <= `reach_m`, |z| <= `reach_m`. The mesh has nodes at
    /// its ends.
    pub(super) fn cover(&mut self, outline: &Outline<'_>, place: f64, reach_m: f64, stiffness: Complex64) {
        let inside = |start: f64, h: f64| (start + 0.5 * h - place).abs() <= reach_m;
        for element in 0..self.mesh.elements() {
            let (start, h) = self.mesh.element(element);
            if !inside(start, h) {
                continue;
            }
            for (t, weight) in gauss(GAUSS_ALONG) {
                let width = outline.at(start + t * h).value.exp();
                let products = self.section.mass_within((reach_m / width).min(1.0));
                let cubics = along(t, h, self.mesh.unit_m);
                for (left, a) in cubics.iter().enumerate() {
                    for (right, b) in cubics.iter().enumerate() {
                        let factor = stiffness * (weight * h * width * a[0] * b[0]);
                        for (at, product) in products.iter().enumerate() {
                            let row = unknown(self.section, element, left, at / self.section.orders);
                            let column = unknown(self.section, element, right, at % self.section.orders);
                            self.matrix.add(row, column, factor * product);
                        }
                    }
                }
            }
        }
    }

    /// Clamps a node: deflection and slope zero.
    pub(super) fn clamp(&mut self, node: usize) {
        self.hold(node, 0.0);
        for m in 0..self.section.orders {
            self.prescribe(self.unknown(node, m) + 1, Complex64::ZERO);
        }
    }

    fn prescribe(&mut self, row: usize, value: Complex64) {
        self.matrix.prescribe(row);
        self.right[row] = value;
        self.changes.push(RowChange::Replace(row));
    }

    fn add_row(&mut self, source: usize, target: usize, factor: f64) {
        self.matrix.add_row(source, target, factor);
        let right = self.right[source] * factor;
        self.right[target] += right;
        self.changes.push(RowChange::Add { source, target, factor });
    }

    /// Does to the forces of a load what the conditions have done to the rows.
    pub(super) fn condition(&self, forces: &mut [Complex64]) {
        for change in &self.changes {
            match *change {
                RowChange::Add { source, target, factor } => {
                    let force = forces[source] * factor;
                    forces[target] += force;
                }
                RowChange::Replace(row) => forces[row] = Complex64::ZERO,
            }
        }
    }

    /// The unknowns.
    pub(super) fn solve(self) -> Vec<Complex64> {
        let mut unknowns = self.right;
        self.matrix.factor().solve(&mut unknowns);
        unknowns
    }
}

/// Index of the unknown of the cubic `number` of an element: 0, 1 are value and slope at its start, 2, 3 at its end.
pub(super) fn unknown(section: &Section, element: usize, number: usize, order: usize) -> usize {
    2 * ((element + number / 2) * section.orders + order) + number % 2
}

/// f_m of every polynomial at `x` from the unknowns.
pub(super) fn amplitudes(section: &Section, mesh: &Mesh, unknowns: &[Complex64], x: f64) -> Vec<Complex64> {
    let (element, t) = mesh.locate(x);
    let (_, h) = mesh.element(element);
    let cubics = along(t, h, mesh.unit_m);
    (0..section.orders)
        .map(|m| {
            let term = |(number, cubic): (usize, &[f64; 3])| {
                unknowns[unknown(section, element, number, m)] * cubic[0]
            };
            cubics.iter().enumerate().map(term).sum()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::basis::Edges;
    use super::super::section::Energy;
    use super::*;
    use crate::definition::taper::WidthLaw;

    /// The equations of a guided node are those of the free one, for every virtual deflection that keeps the guide.
    #[test]
    fn a_guide_does_no_work() {
        let law = WidthLaw::Exponential { log_width: 0.02_f64.ln(), rate_per_m: 12.0 };
        let outline = Outline::Plate { law: &law, rounding_m: 0.0 };
        let section = Section::new(Edges::Clamped, Energy::Bending(0.3), 3, [2.365; 2]);
        let mesh = Mesh::new(&[0.0, 0.02], 0.008);
        let free = || System::new(&section, &mesh, &outline, |_| Complex64::ONE, |_| 1e8);
        let unknowns = free().right.len();
        let keeps_the_guide = |seed: f64| -> Vec<Complex64> {
            let mut w: Vec<Complex64> =
                (0..unknowns).map(|i| (seed * (i as f64 + 1.0)).sin().into()).collect();
            for m in 0..3 {
                w[2 * m + 1] =
                    (0..3).map(|n| w[2 * n] * section.slant[3 * m + n] * -12.0 * mesh.unit_m).sum();
            }
            w
        };
        let (w, v) = (keeps_the_guide(0.7), keeps_the_guide(1.3));
        let mut guided = free();
        guided.guide(0, -12.0);
        let (wanted, found) = (free().matrix.times(&w), guided.matrix.times(&w));
        let largest = wanted.iter().map(|force| force.norm()).fold(0.0, f64::max);
        assert!((0..3).all(|m| found[2 * m + 1].norm() < 1e-12), "the guide is kept");
        let work = |forces: &[Complex64], counts: &dyn Fn(usize) -> bool| -> Complex64 {
            (0..unknowns).filter(|&i| counts(i)).map(|i| v[i] * forces[i]).sum()
        };
        let of_guide = |i: usize| i < 6 && i % 2 == 1;
        let error = work(&wanted, &|_| true) - work(&found, &|i| !of_guide(i));
        assert!(error.norm() < 1e-9 * largest, "{error} of {largest}");
        // Nor does it take from the work of a load.
        let mut load: Vec<Complex64> = (0..unknowns).map(|i| (0.3 * (i * i) as f64).cos().into()).collect();
        let whole = work(&load, &|_| true);
        guided.condition(&mut load);
        let left = work(&load, &|_| true);
        assert!((whole - left).norm() < 1e-9 * whole.norm(), "{left} of {whole}");
    }
}
