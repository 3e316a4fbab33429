//! A bank of independent complex oscillators, one per mode of the plate: what is integrated in time.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The imaginary unit.
pub(super) const J: Complex64 = Complex64::new(0.0, 1.0);

/// What the oscillators are driven by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Input {
    /// The drive itself.
    Drive,
    /// The drive's time derivative.
    DriveRate,
}

/// Independent oscillators and what they do to the plate.
pub(crate) struct ModalBank {
    pub(crate) input: Input,
    /// Complex angular frequencies p, rad/s; the imaginary part is not positive.
    pub(crate) pole: Vec<Complex64>,
    /// Field per oscillator: places x poles, for z = u/(p - omega).
    pub(crate) shape: DMatrix<Complex64>,
    /// Field that follows the input at once: one entry per place.
    pub(crate) direct: DVector<Complex64>,
}

/// ModalStates far from the band, summed up: their answer as a quadratic in omega about the band's middle.
pub(crate) struct QuasiStatic {
    /// Field per unit of the input, of (omega - centre) times it, and of its square: one column each.
    pub(crate) shape: DMatrix<Complex64>,
}

impl ModalBank {
    /// Takes out the oscillators further than `reach_hz` from `centre_hz`; what they did follows the input at once.
    ///
    /// 1/(p - omega) = sum (omega - centre)^k/(p - centre)^(k + 1), cut after k = 2: with `reach_hz` 3.5 times the
    /// half band that leaves (1/3.5)^3 of a small part, at the ends of the band.
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

    /// Steady field at `frequency_hz` per unit of drive: what the time steps converge to.
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
