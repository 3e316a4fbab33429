//! A bank of independent complex oscillators, one per pole of the plate, which are integrated in time.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The imaginary unit.
pub(super) const J: Complex64 = Complex64::new(0.0, 1.0);

/// The input of the oscillators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Input {
    /// The drive itself.
    Drive,
    /// The drive's time derivative.
    DriveRate,
}

/// Independent oscillators and their effect on the field.
pub(crate) struct ModalBank {
    pub(crate) input: Input,
    /// Complex angular frequencies p, rad/s; the imaginary part is zero or negative, so that oscillations decay.
    pub(crate) pole: Vec<Complex64>,
    /// Field per unit of each oscillator's state z = u/(p - omega): one row per position, one column per pole.
    pub(crate) shape: DMatrix<Complex64>,
    /// Field per unit of input that follows the input without delay: one entry per position.
    pub(crate) direct: DVector<Complex64>,
}

/// The sum of the oscillators far from the band: their response as a quadratic in omega about the middle of the band.
pub(crate) struct QuasiStatic {
    /// Field per unit of the input, of (omega - centre) times the input, and of (omega - centre)^2 times the input: one
    /// column each.
    pub(crate) shape: DMatrix<Complex64>,
}

impl ModalBank {
    /// Removes the oscillators farther than `reach_hz` from `centre_hz` and returns their quasi-static response.
    ///
    /// 1/(p - omega) = sum over k of (omega - centre)^k/(p - centre)^(k + 1), truncated after k = 2. If `reach_hz` is
    /// 3.5 times the half band, the relative error of such a term is at most (1/3.5)^3, at the ends of the band, and
    /// these terms are a small part of the field.
    pub(crate) fn condense(self, centre_hz: f64, reach_hz: f64) -> (Self, QuasiStatic) {
        let centre = TAU * centre_hz;
        let (near, far): (Vec<usize>, Vec<usize>) =
            (0..self.pole.len()).partition(|&i| (self.pole[i] - centre).norm() < TAU * reach_hz);
        let mut quasi_static = DMatrix::zeros(self.shape.nrows(), 3);
        quasi_static.set_column(0, &self.direct);
        for i in far {
            let inverse = 1.0 / (self.pole[i] - centre);
            let mut factor = inverse;
            for k in 0..3 {
                for row in 0..self.shape.nrows() {
                    quasi_static[(row, k)] += self.shape[(row, i)] * factor;
                }
                factor *= inverse;
            }
        }
        let bank = Self {
            input: self.input,
            pole: near.iter().map(|&i| self.pole[i]).collect(),
            shape: self.shape.select_columns(&near),
            direct: DVector::zeros(self.shape.nrows()),
        };
        (bank, QuasiStatic { shape: quasi_static })
    }

    /// Steady field at `frequency_hz` per unit of drive: the limit of the time steps.
    #[cfg(test)]
    pub(crate) fn steady(&self, frequency_hz: f64) -> Vec<Complex64> {
        let omega = TAU * frequency_hz;
        let input = match self.input {
            Input::Drive => Complex64::ONE,
            Input::DriveRate => -J * omega,
        };
        (0..self.shape.nrows())
            .map(|row| {
                let ringing: Complex64 =
                    self.pole.iter().enumerate().map(|(i, p)| self.shape[(row, i)] / (p - omega)).sum();
                (ringing + self.direct[row]) * input
            })
            .collect()
    }
}
