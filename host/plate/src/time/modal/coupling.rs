//! The source's resistance and the actuator couple the oscillators; a diagonalisation makes them independent again.

use super::bank::{Input, J, ModalBank};
use crate::definition::actuator::Resonator;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The oscillators of a plate with an ideal force or displacement drive, without resistance and actuator.
pub(super) struct Uncoupled {
    pub(super) pole: Vec<Complex64>,
    pub(super) shape: DMatrix<Complex64>,
    pub(super) direct: DVector<Complex64>,
    /// f(0) per unit of each oscillator's state.
    pub(super) at_drive: Vec<Complex64>,
    /// Factor from the drive to the oscillators' input.
    pub(super) scale: f64,
}

/// Adds the source's resistance (R/T, s/m) and the actuator, and returns the result as independent oscillators.
pub(super) fn couple(free: &Uncoupled, resistance: Option<f64>, actuator: Option<Resonator>) -> ModalBank {
    let count = free.pole.len();
    if resistance.is_none() && actuator.is_none() {
        return ModalBank {
            input: Input::Drive,
            pole: free.pole.clone(),
            shape: free.shape.map(|value| value * free.scale),
            direct: free.direct.map(|value| value * free.scale),
        };
    }
    // z' = M z + b u; each row is (p - omega) z = F with F = f'(0) or the held displacement.
    let extra = if actuator.is_some() { 2 } else { 0 };
    let size = count + extra;
    let mut matrix = DMatrix::<Complex64>::zeros(size, size);
    let mut drive = DVector::<Complex64>::zeros(size);
    for (i, pole) in free.pole.iter().enumerate() {
        matrix[(i, i)] = -J * pole;
    }
    let (poles, residues) = actuator.map_or(([Complex64::ZERO; 2], [Complex64::ZERO; 2]), actuator_poles);
    for i in 0..extra {
        matrix[(count + i, count + i)] = -J * poles[i];
        drive[count + i] = J;
    }
    // F is a sum of the oscillators' states (`own`) and of the source or, with a resistance, of the source's time
    // derivative.
    let (own, source_gain) = match resistance {
        Some(ratio) => {
            // F = (R/T) (f(0)' - 2 s') and f(0)' = sum g (-j p z + j F).
            let sum: Complex64 = free.at_drive.iter().sum();
            let scale = ratio / (1.0 - J * ratio * sum);
            (
                free.at_drive.iter().zip(&free.pole).map(|(g, p)| -J * g * p * scale).collect::<Vec<_>>(),
                -2.0 * scale,
            )
        }
        None => (vec![Complex64::ZERO; count], Complex64::from(free.scale)),
    };
    for row in 0..count {
        for (column, value) in own.iter().enumerate() {
            matrix[(row, column)] += J * value;
        }
        for i in 0..extra {
            let through = if resistance.is_some() { -J * poles[i] * residues[i] } else { residues[i] };
            matrix[(row, count + i)] += J * source_gain * through;
        }
        if extra == 0 {
            drive[row] = J * source_gain;
        }
    }
    let input = if resistance.is_some() && extra == 0 { Input::DriveRate } else { Input::Drive };
    let mut output = DMatrix::<Complex64>::zeros(free.shape.nrows(), size);
    output.view_mut((0, 0), (free.shape.nrows(), count)).copy_from(&free.shape);
    if resistance.is_none() {
        for (i, residue) in residues.iter().enumerate().take(extra) {
            let column = free.direct.map(|value| value * free.scale * residue);
            output.set_column(count + i, &column);
        }
    }
    separate(&matrix, &drive, &output, input)
}

/// Poles and residues of the actuator: H = sum r/(p - omega).
fn actuator_poles(actuator: Resonator) -> ([Complex64; 2], [Complex64; 2]) {
    let omega = TAU * actuator.resonance_hz;
    // At Q = 1/2 both poles are equal and the residues infinite. A change of Q by 1e-6 separates them and has no
    // visible effect.
    let quality = if (actuator.quality - 0.5).abs() < 1e-6 { 0.500_001 } else { actuator.quality };
    let half = Complex64::new(0.0, -0.5 / quality);
    let root = Complex64::from(1.0 - 0.25 / (quality * quality)).sqrt();
    let (first, second) = (omega * (half + root), omega * (half - root));
    let residue = omega * omega / (first - second);
    ([first, second], [residue, -residue])
}

/// Diagonalises z' = M z + b u with the field `output` z into independent oscillators.
fn separate(
    matrix: &DMatrix<Complex64>,
    drive: &DVector<Complex64>,
    output: &DMatrix<Complex64>,
    input: Input,
) -> ModalBank {
    let size = matrix.nrows();
    // Schur's form of the matrix, scaled to order one; back-substitution in the triangle gives the eigenvectors.
    let scale = matrix.iter().map(|value| value.norm()).fold(0.0, f64::max).max(1e-300);
    let (unitary, triangle) = nalgebra::Schur::new(matrix / Complex64::from(scale)).unpack();
    let mut vector = DMatrix::<Complex64>::zeros(size, size);
    for column in 0..size {
        vector[(column, column)] = Complex64::ONE;
        for row in (0..column).rev() {
            let sum: Complex64 = (row + 1..=column).map(|k| triangle[(row, k)] * vector[(k, column)]).sum();
            let mut gap = triangle[(column, column)] - triangle[(row, row)];
            if gap.norm() < 1e-14 {
                gap = Complex64::from(1e-14);
            }
            vector[(row, column)] = sum / gap;
        }
    }
    let right = &unitary * &vector;
    let reduced = unitary.adjoint() * drive;
    let amplitude = vector.solve_upper_triangular(&reduced).unwrap_or(reduced);
    let shape = output * right;
    // z = b u/(j (p - omega)): with b folded into the shape the oscillator is z' = -j p z + j u.
    ModalBank {
        input,
        pole: (0..size).map(|i| J * triangle[(i, i)] * scale).collect(),
        shape: DMatrix::from_fn(shape.nrows(), size, |row, i| shape[(row, i)] * amplitude[i] * -J),
        direct: DVector::zeros(shape.nrows()),
    }
}
