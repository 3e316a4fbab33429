//! Ends of the amplitude equation alone: one condition, no near field.
//!
//! A film has a near field of length s = sqrt(D/T). No moment acts on its end, so the end moves by e = 1 + (s k0)^2
//! times the wave, and the force is T W e p'(0): that of a membrane whose end moves as much. So the conditions of a
//! film are those of the membrane with a drive smaller by the factor e.

use super::DrivenEnd;
use crate::definition::drive::DriveEnd;
use crate::definition::plate::Plate;
use crate::definition::source::Source;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The ends that f and f' alone determine; for bending they are approximations.
pub(super) fn driven(plate: &Plate, frequency_hz: f64) -> DrivenEnd {
    let width_mode = plate.width_mode(1);
    let k0 = |frequency_hz: f64| width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
    let end = match plate.spec().drive_end {
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
    };
    of_film(plate, frequency_hz, end)
}

/// Motion of the driven end of a film over its wave there, e; `None` for plates that are not films.
pub(crate) fn film_rise(plate: &Plate, frequency_hz: f64) -> Option<f64> {
    let square = plate.spec().model.film_square()?;
    Some(1.0 + square * plate.width_mode(1).wavenumber_squared(0.0, frequency_hz).max(0.0))
}

/// The end of a film from that of the ideal membrane. A force is the one that launches a wave of amplitude 1 at its
/// frequency.
fn of_film(plate: &Plate, frequency_hz: f64, end: DrivenEnd) -> DrivenEnd {
    let Some(rise) = film_rise(plate, frequency_hz) else { return end };
    let own = match plate.spec().drive_end {
        DriveEnd::Force { at_frequency_hz } => film_rise(plate, at_frequency_hz).unwrap_or(1.0),
        DriveEnd::Displacement
        | DriveEnd::DisplacementAndSlope { .. }
        | DriveEnd::Resistance { .. }
        | DriveEnd::Source(_) => 1.0,
    };
    DrivenEnd { drive: end.drive * (own / rise), ..end }
}

/// A source on a membrane or a shear wave: F - Z_s v + T W f'(0) = 0 with v = -j omega f. The line tension
/// T W = omega^2 sigma W/K^2, with the values in vacuum, is complex with loss. For a film omega^2 sigma/K^2 is
/// T (1 + (s K)^2), so it is divided by 1 + (s K)^2.
pub(super) fn sourced(plate: &Plate, frequency_hz: f64, source: &Source) -> DrivenEnd {
    let omega = TAU * frequency_hz;
    let vacuum = TAU * plate.vacuum_frequency_hz(frequency_hz);
    let axial = plate.width_mode(1).axial_squared(frequency_hz) * plate.lossy_compliance(frequency_hz);
    // A validated plate with a source states its tension or thickness.
    let surface_density = plate.spec().model.surface_density("a source").unwrap_or(f64::NAN);
    let mut stiffness = vacuum * vacuum * surface_density / axial;
    if let Some(square) = plate.spec().model.film_square() {
        stiffness /= 1.0 + square * plate.wavenumber_squared(frequency_hz);
    }
    let line = stiffness * plate.swinging_half_width_m(0.0);
    let end = DrivenEnd::simple(
        -source.impedance.dynamic_stiffness(omega) / line,
        Complex64::ONE,
        -source_force(plate, source) / line,
    );
    of_film(plate, frequency_hz, end)
}

/// The force of a unit drive, N.
pub(super) fn source_force(plate: &Plate, source: &Source) -> Complex64 {
    let impedance = plate.matching_resistance_n_s_per_m(source.at_frequency_hz).unwrap_or(f64::NAN);
    let rise = film_rise(plate, source.at_frequency_hz).unwrap_or(1.0);
    Complex64::from(2.0 * TAU * source.at_frequency_hz * impedance * rise)
}
