//! The supported strip at the driven end: parameters of its two waves and of the agents behind them.

use crate::definition::plate::Plate;
use crate::frequency::axial::lossy_axial_squared;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The strip at the driven end at one frequency.
pub(super) struct Strip {
    pub(super) omega: f64,
    /// K^2 with loss, 1/m^2.
    pub(super) axial: Complex64,
    /// K^2 without loss, 1/m^2.
    pub(super) lossless_axial: f64,
    /// 1 + j eta of the plate's own stiffness.
    pub(super) compliance: Complex64,
    /// q^2 = (pi/2W)^2, 1/m^2.
    pub(super) across: f64,
    /// D W without loss, N m^2.
    pub(super) stiffness: f64,
    /// 1 - nu.
    pub(super) lateral: f64,
    /// s = W'/W, 1/m.
    pub(super) narrowing: f64,
}

impl Strip {
    pub(super) fn new(plate: &Plate, frequency_hz: f64, narrowing: f64) -> Self {
        let width_mode = plate.width_mode(1);
        let omega = TAU * frequency_hz;
        let model = &plate.spec().model;
        let lossless_axial = width_mode.axial_squared(frequency_hz);
        let surface_density = model.surface_density("a source").unwrap_or(f64::NAN);
        let vacuum = TAU * plate.vacuum_frequency_hz(frequency_hz);
        let rigidity = surface_density * vacuum / (lossless_axial * plate.axial_rise(frequency_hz));
        Self {
            omega,
            axial: lossy_axial_squared(&width_mode, frequency_hz),
            lossless_axial,
            compliance: plate.lossy_compliance(frequency_hz),
            across: width_mode.width_term(0.0),
            stiffness: rigidity * plate.half_width_m(0.0),
            lateral: 1.0 - model.bending().map_or(f64::NAN, |bending| bending.poisson_ratio),
            narrowing,
        }
    }
}
