//! The amplifier of a rig whose bandwidth is finite: a low-pass of second order at its codes, and the images that it lets through to
//! the current.
//!
//! The low-pass at the codes is that of the bilinear transform, with the same bandwidth: up to a tenth of the sample rate it is within
//! some per cent of the differential equation.

use super::motor::{Motor, Transducer};
use crate::measure::{Bandwidths, images};
use slipline_plate::Complex64;
use slipline_plate::calibrate::DriveLoad;
use std::f64::consts::{PI, SQRT_2, TAU};

/// The low-pass at the codes: y = (u + 2 u' + u'') gain - a y' - b y''.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct LowPass {
    gain: f64,
    feedback: [f64; 2],
    before: [[f64; 2]; 2],
}

impl LowPass {
    /// A low-pass at rest.
    pub(super) fn new(bandwidth_hz: f64, sample_rate_hz: f64) -> Self {
        let k = (PI * bandwidth_hz / sample_rate_hz).tan();
        let scale = (1.0 + SQRT_2 * k + k * k).recip();
        let feedback = [2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale];
        Self { gain: k * k * scale, feedback, before: [[0.0; 2]; 2] }
    }

    /// The next value.
    pub(super) fn next(&mut self, u: f64) -> f64 {
        let ([u1, u2], [y1, y2]) = (self.before[0], self.before[1]);
        let y = self.gain * (u + 2.0 * u1 + u2) - self.feedback[0] * y1 - self.feedback[1] * y2;
        self.before = [[u, u1], [y, y1]];
        y
    }

    /// Its steady response at a frequency, for e^(-j omega t).
    pub(super) fn response(&self, frequency_hz: f64, sample_rate_hz: f64) -> Complex64 {
        let turn = Complex64::cis(TAU * frequency_hz / sample_rate_hz);
        let [a, b] = self.feedback;
        self.gain * (1.0 + turn).powi(2) / (1.0 + a * turn + b * turn * turn)
    }
}

/// The current by the amplifier's voltage with the images that fold onto a tone, over that without them.
pub(super) fn with_images(
    motor: &Motor,
    amplifier_hz: f64,
    frequency_hz: f64,
    sample_rate_hz: f64,
) -> Complex64 {
    let bandwidths = Bandwidths { amplifier_hz: Some(amplifier_hz), filter_hz: None };
    let load = motor.load();
    1.0 + images(&load, |hz| bandwidths.response(hz), frequency_hz, sample_rate_hz).sum::<Complex64>()
}

impl Motor {
    /// What the amplifier drives, as a data sheet states it.
    #[must_use]
    pub const fn load(&self) -> DriveLoad {
        match self.transducer {
            Transducer::Coil { resistance_ohm, .. } => DriveLoad::Coil { resistance_ohm },
            Transducer::Piezo { capacitance_f, .. } => DriveLoad::Piezo { capacitance_f },
        }
    }
}
