//! The plate, its driven end and its actuator as a bank of independent complex oscillators.
//!
//! z' = -j p z + j u, field = quasi-static terms of u + sum of shape z. Signals are analytic: e^(-j omega t) with
//! omega > 0 only. So a loss by hysteresis, K^2 (1 + j eta), which has no real equation in the time domain, has a bank as
//! any other loss.

use nalgebra::DMatrix;
use num_complex::Complex64;

/// Independent oscillators and their effect on the field.
pub(super) struct ModalBank {
    /// Complex angular frequencies p, rad/s; the imaginary part is zero or negative, so that oscillations decay.
    pub(super) pole: Vec<Complex64>,
    /// Field per unit of each oscillator's state z = u/(p - omega): one row per position, one column per pole.
    pub(super) shape: DMatrix<Complex64>,
    /// Field per unit of the drive, of (omega - centre) times the drive, and of (omega - centre)^2 times the drive: one
    /// column each. They represent the oscillators far from the band; centre is the middle of the band.
    pub(super) quasi_static: DMatrix<Complex64>,
}

#[cfg(test)]
impl ModalBank {
    /// Steady field at `frequency_hz` per unit of drive: the limit of the time steps.
    pub(super) fn steady(&self, frequency_hz: f64, centre_hz: f64) -> Vec<Complex64> {
        use std::f64::consts::TAU;
        let omega = TAU * frequency_hz;
        let apart = TAU * (frequency_hz - centre_hz);
        let at = |row: usize| {
            let ringing = self.pole.iter().enumerate().map(|(i, p)| self.shape[(row, i)] / (p - omega));
            let slow = (0..3).map(|k| self.quasi_static[(row, k)] * apart.powi(k as i32));
            ringing.chain(slow).sum()
        };
        (0..self.shape.nrows()).map(at).collect()
    }
}
