//! The condition that the driven end imposes on the propagating wave, and the near field beside that wave.
//!
//! The amplitude equation has one wave in each direction and takes one condition at x = 0. A membrane and a shear wave
//! need no other. In bending there are two conditions, for deflection or force and for slope or moment, and an
//! evanescent wave e beside the propagating wave p. Every driven end gives two linear equations in p(0), p'(0) and the
//! amplitude of e. Eliminating e leaves
//!
//! alpha p(0) + beta p'(0) = drive,   e(0) = a p(0) + b p'(0).
//!
//! ```text
//! DriveEnd -+- displacement, force, resistance: one-mode conditions        (one_mode)
//!           +- source on a membrane or shear wave: its impedance            (one_mode)
//!           +- slope, source on supported bending: supported strip          (supported), its lead-in (lead_in)
//!           +- slope, source on clamped bending: all waves of the strip       (clamped, strip_waves, turning_wave)
//! ```

mod clamped;
mod lead_in;
mod near_field;
mod one_mode;
mod reflection;
mod source_end;
mod strip;
mod strip_waves;
mod supported;
mod turning_wave;
mod whole_end;

use crate::definition::drive::DriveEnd;
use crate::definition::model::Model;
use crate::definition::plate::Plate;
use crate::definition::source::Source;
use num_complex::Complex64;

pub(crate) use near_field::NearField;
pub(crate) use one_mode::film_rise;
pub use reflection::{reflection, resistance_reflection};
pub(crate) use source_end::{Scattering, SourceEnd};
pub(crate) use whole_end::{drive_rise, with_whole_end};

/// The condition alpha p(0) + beta p'(0) = drive for a drive of 1, and the near field.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DrivenEnd {
    pub(crate) alpha: Complex64,
    pub(crate) beta: Complex64,
    pub(crate) drive: Complex64,
    /// The evanescent waves that start at the end; empty if the model has none.
    pub(crate) near: NearField,
}

impl DrivenEnd {
    /// The driven end of `plate` at `frequency_hz`.
    pub(crate) fn of(plate: &Plate, frequency_hz: f64) -> Self {
        Self::with_narrowing(plate, frequency_hz, plate.width.at(0.0).slope)
    }

    /// As [`DrivenEnd::of`], for a plate whose width changes by `narrowing_per_m` (W'/W at x = 0; 0 for the straight
    /// strip with the width of the end).
    fn with_narrowing(plate: &Plate, frequency_hz: f64, narrowing_per_m: f64) -> Self {
        match (plate.spec().drive_end, &plate.spec().model) {
            (DriveEnd::DisplacementAndSlope { slope }, Model::BendingSupported(_)) => {
                supported::moved(plate, frequency_hz, narrowing_per_m, slope)
            }
            (DriveEnd::DisplacementAndSlope { slope }, Model::BendingClamped(_)) => {
                clamped::moved(plate, frequency_hz, narrowing_per_m, slope)
            }
            (DriveEnd::Source(source), _) => Self::sourced(plate, frequency_hz, narrowing_per_m, &source),
            _ => one_mode::driven(plate, frequency_hz),
        }
    }

    /// The driven end with `source` in place of the plate's own drive end.
    fn sourced(plate: &Plate, frequency_hz: f64, narrowing_per_m: f64, source: &Source) -> Self {
        match plate.spec().model {
            Model::BendingSupported(_) => supported::sourced(plate, frequency_hz, narrowing_per_m, source),
            Model::BendingClamped(_) => clamped::sourced(plate, frequency_hz, narrowing_per_m, source),
            _ => one_mode::sourced(plate, frequency_hz, source),
        }
    }

    /// The condition alpha p(0) + beta p'(0) = drive alone, without a near field.
    fn simple(alpha: Complex64, beta: Complex64, drive: Complex64) -> Self {
        Self { alpha, beta, drive, near: NearField::default() }
    }
}
