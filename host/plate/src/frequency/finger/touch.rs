//! The field with a finger: the plate's own field plus that of the finger's force.
//!
//! Two solutions of the homogeneous equation suffice: r, which decays beyond the turning point, and l, which
//! satisfies the driven end's condition without a drive. A force per length q(x) changes the propagating wave by
//! -(1/(w S)) (r(x) integral of l q to the left of x + l(x) integral of r q to the right of it),
//! with w = l r' - l' r. The force F on a cell of the contact follows from the mean motion m of that cell, with the
//! plate's own part m0: F = c m and m = m0 + sum of C F over all cells, with c = j omega Z times the cell's fraction
//! of the contact.

use super::Finger;
use super::contact::{BANDS, COLUMNS, Contact, means_across, strip_half_width};
use crate::definition::plate::Plate;
use crate::frequency::numerov::{self, Grid, TwoSolutions};
use crate::special::gauss::gauss;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Gauss points on each stretch.
const PLACES: usize = 3;

/// f at the grid points on the plate, relative to the drive, with `finger` on it.
pub(crate) fn touched(grid: &Grid, plate: &Plate, finger: &Finger, frequency_hz: f64) -> Vec<Complex64> {
    let (begins_m, ends_m) = finger.reach(plate);
    let (mut field, solutions) = numerov::solve_with_both(grid, plate, frequency_hz, ends_m);
    if ends_m > begins_m {
        Touch::new(&field, &solutions, plate, finger, frequency_hz).add_to(&mut field);
    }
    field
}

/// As [`numerov::solve_each_apart`], with a finger on the plate where there is one.
pub(crate) fn solve_each_touched(
    grid: &Grid,
    plate: &Plate,
    finger: Option<&Finger>,
    frequencies_hz: &[f64],
    every: usize,
    mut visit: impl FnMut(usize, &[Complex64]),
) {
    let Some(finger) = finger else {
        return numerov::solve_each_apart(grid, plate, frequencies_hz, every, visit);
    };
    for (number, &frequency_hz) in frequencies_hz.iter().enumerate() {
        let fine = touched(grid, plate, finger, frequency_hz);
        visit(number, &fine.into_iter().step_by(every).collect::<Vec<_>>());
    }
}

/// Mean motion under the contact on the touched plate over that on the free plate.
pub(crate) fn share_left(grid: &Grid, plate: &Plate, finger: &Finger, frequency_hz: f64) -> Complex64 {
    let (begins_m, ends_m) = finger.reach(plate);
    if ends_m <= begins_m {
        return Complex64::ONE;
    }
    let (field, solutions) = numerov::solve_with_both(grid, plate, frequency_hz, ends_m);
    Touch::new(&field, &solutions, plate, finger, frequency_hz).share_left
}

/// A stretch of the contact within one column and between two grid points, with the integrals of the two solutions
/// over it, each divided by the column's width.
struct Stretch {
    column: usize,
    ends_m: f64,
    left: Complex64,
    right: Complex64,
}

/// The forces of a finger on the plate.
struct Touch<'a> {
    solutions: &'a TwoSolutions,
    contact: Contact,
    stretches: Vec<Stretch>,
    force: [[Complex64; BANDS]; COLUMNS],
    /// The first width mode's mean over each band, column by column.
    mean: [[f64; BANDS]; COLUMNS],
    /// -1/(w S).
    per_force: Complex64,
    /// S at the finger, N.
    stiffness_n: Complex64,
    /// The mean motion under the contact over that of the free plate.
    share_left: Complex64,
}

impl<'a> Touch<'a> {
    fn new(
        field: &[Complex64],
        solutions: &'a TwoSolutions,
        plate: &Plate,
        finger: &Finger,
        frequency_hz: f64,
    ) -> Self {
        let step_m = solutions.step_m;
        let contact = Contact::new(finger, plate, frequency_hz);
        let mean = std::array::from_fn(|column| {
            let middle = 0.5 * (contact.column_m(column) + contact.column_m(column + 1));
            means_across(finger.half_across(plate, middle), strip_half_width(plate, middle), 1)
        });
        let rule = gauss(PLACES);
        let mut stretches = Vec::new();
        let mut own = [Complex64::ZERO; COLUMNS];
        for (column, own) in own.iter_mut().enumerate() {
            let (begins, ends) = (contact.column_m(column), contact.column_m(column + 1));
            let mut from = begins;
            while from < ends {
                // Up to the next grid point; a remainder of rounding size is merged with the next stretch.
                let to = (((from / step_m + 1e-6).floor() + 1.0) * step_m).min(ends);
                let mut stretch =
                    Stretch { column, ends_m: to, left: Complex64::ZERO, right: Complex64::ZERO };
                for &(place, weight) in &rule {
                    let x = from + place * (to - from);
                    let weight = weight * (to - from) / (ends - begins);
                    stretch.left += weight * interpolated(&solutions.left, step_m, x);
                    stretch.right += weight * interpolated(&solutions.right, step_m, x);
                    *own += weight * interpolated(field, step_m, x);
                }
                stretches.push(stretch);
                from = to;
            }
        }
        // The stiffness S is proportional to the inverse square of a solution's weight.
        let weight = interpolated(&solutions.weight, step_m, finger.place_m);
        let mut touch = Self {
            solutions,
            per_force: -(solutions.wronskian * solutions.stiffness_n).inv(),
            stiffness_n: solutions.stiffness_n / (weight * weight),
            force: [[Complex64::ZERO; BANDS]; COLUMNS],
            share_left: Complex64::ONE,
            contact,
            stretches,
            mean,
        };
        touch.push_back(&own, plate, finger, frequency_hz);
        touch
    }

    /// Solves for the force on each cell; `own` is the mean of the plate's own field over each column.
    fn push_back(&mut self, own: &[Complex64; COLUMNS], plate: &Plate, finger: &Finger, frequency_hz: f64) {
        let near = self.contact.compliance();
        let wave = self.wave_compliance();
        let per_area = -finger.impedance().dynamic_stiffness(TAU * frequency_hz) / finger.contact_m.powi(2);
        let cells = COLUMNS * BANDS;
        let mut matrix = DMatrix::<Complex64>::identity(cells, cells);
        let mut right = DVector::<Complex64>::zeros(cells);
        for column in 0..COLUMNS {
            let width = self.contact.column_m(column + 1) - self.contact.column_m(column);
            let middle = self.contact.column_m(column) + 0.5 * width;
            let area = width * 2.0 * finger.half_across(plate, middle) / BANDS as f64;
            let push = per_area * area;
            for (band, mean) in self.mean[column].iter().enumerate() {
                let row = column * BANDS + band;
                right[row] = push * own[column] * *mean;
                for (other, means) in self.mean.iter().enumerate() {
                    for (across, other_mean) in means.iter().enumerate() {
                        let compliance = wave[column][other] * (mean * other_mean)
                            + near[column.abs_diff(other)][band][across] / self.stiffness_n;
                        matrix[(row, other * BANDS + across)] -= push * compliance;
                    }
                }
            }
        }
        let free = right.sum();
        let Some(force) = matrix.lu().solve(&right).filter(|force| force.iter().all(|f| f.is_finite()))
        else {
            return;
        };
        // A cell's force is its area times the same impedance times its motion.
        self.share_left = force.sum() / free;
        for (column, bands) in self.force.iter_mut().enumerate() {
            for (band, cell) in bands.iter_mut().enumerate() {
                *cell = force[column * BANDS + band];
            }
        }
    }

    /// Mean over one column of the propagating wave per unit of force on another, m/N.
    fn wave_compliance(&self) -> [[Complex64; COLUMNS]; COLUMNS] {
        let mut left = [Complex64::ZERO; COLUMNS];
        let mut right = [Complex64::ZERO; COLUMNS];
        let mut itself = [Complex64::ZERO; COLUMNS];
        for stretch in &self.stretches {
            let column = stretch.column;
            // With the stretches before it, twice by symmetry, and with itself: within a short stretch both solutions
            // are nearly constant.
            itself[column] += stretch.right * (2.0 * left[column] + stretch.left);
            left[column] += stretch.left;
            right[column] += stretch.right;
        }
        std::array::from_fn(|column| {
            std::array::from_fn(|other| {
                let both = match column.cmp(&other) {
                    std::cmp::Ordering::Less => left[column] * right[other],
                    std::cmp::Ordering::Equal => itself[column],
                    std::cmp::Ordering::Greater => right[column] * left[other],
                };
                self.per_force * both
            })
        })
    }

    /// Adds the field of the forces to `field`, that of the untouched plate.
    fn add_to(&self, field: &mut [Complex64]) {
        let TwoSolutions { step_m, left, right, .. } = self.solutions;
        // The force on the propagating wave, column by column.
        let push: [Complex64; COLUMNS] = std::array::from_fn(|column| {
            self.force[column].iter().zip(self.mean[column]).map(|(force, mean)| force * mean).sum()
        });
        let mut ahead: Complex64 = self.stretches.iter().map(|it| push[it.column] * it.right).sum();
        let mut passed = Complex64::ZERO;
        let mut next = 0;
        let near = self.contact.near_field(&self.force);
        for (index, value) in field.iter_mut().enumerate() {
            let x = index as f64 * step_m;
            while let Some(stretch) =
                self.stretches.get(next).filter(|stretch| stretch.ends_m <= x + 1e-6 * step_m)
            {
                passed += push[stretch.column] * stretch.left;
                ahead -= push[stretch.column] * stretch.right;
                next += 1;
            }
            // Beyond the contact one of the two integrals is zero, and its solution is not computed or very large.
            let mut wave = Complex64::ZERO;
            if next > 0 {
                wave += right[index] * passed;
            }
            if next < self.stretches.len() {
                wave += left[index] * ahead;
            }
            *value += self.per_force * wave + near.at(x) / self.stiffness_n;
        }
    }
}

/// A value on a uniform grid between its points, by a cubic through the four nearest.
pub(super) fn interpolated(values: &[Complex64], step_m: f64, x: f64) -> Complex64 {
    let at = x / step_m;
    let first = ((at.floor() as usize).saturating_sub(1)).min(values.len().saturating_sub(4));
    let t = at - first as f64;
    let Some([a, b, c, d]) = values.get(first..first + 4).and_then(|four| four.first_chunk()) else {
        return Complex64::ZERO;
    };
    a * (-(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0)
        + b * (t * (t - 2.0) * (t - 3.0) / 2.0)
        + c * (-t * (t - 1.0) * (t - 3.0) / 2.0)
        + d * (t * (t - 1.0) * (t - 2.0) / 6.0)
}
