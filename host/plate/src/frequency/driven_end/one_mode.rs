//! Ends of the amplitude equation alone: one condition, no near field.

use super::DrivenEnd;
use crate::definition::drive::DriveEnd;
use crate::definition::plate::Plate;
use crate::definition::source::Source;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The ends that f and f' alone determine: for bending they are approximations.
pub(super) fn driven(plate: &Plate, frequency_hz: f64) -> DrivenEnd {
    let width_mode = plate.width_mode(1);
    let k0 = |frequency_hz: f64| width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
    match plate.spec().drive_end {
        DriveEnd::Force { at_frequency_hz } => {
            DrivenEnd::simple(Complex64::ZERO, Complex64::ONE, Complex64::from(-k0(at_frequency_hz)))
        }
        DriveEnd::Resistance { ratio, at_frequency_hz } => {
            // r k0 = (R/T) omega with R/T constant.
            let a = Complex64::new(0.0, ratio * k0(at_frequency_hz) * frequency_hz / at_frequency_hz);
            DrivenEnd::simple(a, Complex64::ONE, 2.0 * a)
        }
        DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. } | DriveEnd::Source(_) => {
            DrivenEnd::simple(Complex64::ONE, Complex64::ZERO, Complex64::ONE)
        }
    }
}

/// A source on a membrane or a shear wave: F - Z_s v + T W f'(0) = 0 with v = -j omega f, where the line tension
/// T W = omega^2 sigma W/K^2, of the plate in vacuum, is complex with loss.
pub(super) fn sourced(plate: &Plate, frequency_hz: f64, source: &Source) -> DrivenEnd {
    let omega = TAU * frequency_hz;
    let vacuum = TAU * plate.vacuum_frequency_hz(frequency_hz);
    let axial = plate.width_mode(1).axial_squared(frequency_hz) * plate.lossy_compliance();
    // A validated plate with a source has its tension or thickness.
    let surface_density = plate.spec().model.surface_density("a source").unwrap_or(f64::NAN);
    let stiffness = vacuum * vacuum * surface_density / axial;
    let line = stiffness * plate.half_width_m(0.0);
    DrivenEnd::simple(
        -source.impedance.dynamic_stiffness(omega) / line,
        Complex64::ONE,
        -source_force(plate, source) / line,
    )
}

/// The force of a drive of 1, N.
pub(super) fn source_force(plate: &Plate, source: &Source) -> Complex64 {
    let impedance = plate.wave_impedance_n_s_per_m(source.at_frequency_hz).unwrap_or(f64::NAN);
    Complex64::from(2.0 * TAU * source.at_frequency_hz * impedance)
}
