//! Solution of a linear system given by its product with a vector: the generalised minimal residual method (GMRES;
//! Saad and Schultz 1986).

use num_complex::Complex64;

/// Residual over the right-hand side at which the solution is accepted.
const TOLERANCE: f64 = 1e-8;
/// Largest number of steps. The systems here differ little from one that is solved exactly, and take 10 to 40.
const STEPS_MAX: usize = 200;

/// The x with `apply`(x) = `right`; `None` without convergence in 200 steps. `apply` is linear.
pub(super) fn solve(
    apply: impl Fn(&[Complex64]) -> Vec<Complex64>,
    right: &[Complex64],
) -> Option<Vec<Complex64>> {
    let size = norm(right);
    if size == 0.0 {
        return Some(right.to_vec());
    }
    // Orthonormal vectors. Column n of `triangle`, after the rotations, has the components of `apply` of vector n.
    let mut basis = vec![scaled(right, size.recip())];
    let mut triangle: Vec<Vec<Complex64>> = Vec::new();
    let mut rotations: Vec<(Complex64, Complex64)> = Vec::new();
    let mut rest = vec![Complex64::from(size)];
    for step in 0..STEPS_MAX {
        let mut next = apply(&basis[step]);
        // Orthogonalised twice, because of rounding.
        let mut column = vec![Complex64::ZERO; step + 1];
        for _ in 0..2 {
            for (vector, sum) in basis.iter().zip(&mut column) {
                let share: Complex64 = vector.iter().zip(&next).map(|(a, b)| a.conj() * b).sum();
                *sum += share;
                next.iter_mut().zip(vector).for_each(|(to, from)| *to -= from * share);
            }
        }
        let length = norm(&next);
        for (row, (cosine, sine)) in rotations.iter().enumerate() {
            let (upper, lower) = (column[row], column[row + 1]);
            column[row] = cosine.conj() * upper + sine.conj() * lower;
            column[row + 1] = cosine * lower - sine * upper;
        }
        let hypotenuse = column[step].norm().hypot(length);
        if !hypotenuse.is_normal() {
            return None;
        }
        let (cosine, sine) = (column[step] / hypotenuse, Complex64::from(length / hypotenuse));
        column[step] = hypotenuse.into();
        rest.push(-sine * rest[step]);
        rest[step] *= cosine.conj();
        rotations.push((cosine, sine));
        triangle.push(column);
        if rest[step + 1].norm() <= TOLERANCE * size {
            return Some(combined(&basis, &triangle, &rest, right.len()));
        }
        basis.push(scaled(&next, length.recip()));
    }
    None
}

/// The combination of the vectors that solves the triangular system.
fn combined(
    basis: &[Vec<Complex64>],
    triangle: &[Vec<Complex64>],
    right: &[Complex64],
    order: usize,
) -> Vec<Complex64> {
    let mut shares = right[..triangle.len()].to_vec();
    for row in (0..shares.len()).rev() {
        shares[row] /= triangle[row][row];
        for above in 0..row {
            let known = shares[row] * triangle[row][above];
            shares[above] -= known;
        }
    }
    let mut sum = vec![Complex64::ZERO; order];
    for (vector, share) in basis.iter().zip(&shares) {
        sum.iter_mut().zip(vector).for_each(|(to, from)| *to += from * share);
    }
    sum
}

fn norm(vector: &[Complex64]) -> f64 {
    vector.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt()
}

fn scaled(vector: &[Complex64], factor: f64) -> Vec<Complex64> {
    vector.iter().map(|value| value * factor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dense_system_is_solved_and_a_singular_one_is_not() {
        let order = 30;
        let element = |row: usize, column: usize| {
            let number = ((row * 31 + column * 17) % 23) as f64;
            let diagonal = if row == column { 40.0 } else { 0.0 };
            Complex64::new(diagonal + number - 11.0, number - 7.0)
        };
        let times = |x: &[Complex64]| -> Vec<Complex64> {
            (0..order).map(|row| (0..order).map(|column| element(row, column) * x[column]).sum()).collect()
        };
        let wanted: Vec<Complex64> =
            (0..order).map(|i| Complex64::new((i as f64).sin(), (2.0 * i as f64).cos())).collect();
        let found = solve(times, &times(&wanted)).expect("regular");
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found - wanted).norm() < 1e-7, "{found} for {wanted}");
        }
        let nothing = |x: &[Complex64]| vec![Complex64::ZERO; x.len()];
        assert_eq!(solve(nothing, &wanted), None);
        assert_eq!(solve(times, &vec![Complex64::ZERO; order]), Some(vec![Complex64::ZERO; order]));
    }
}
