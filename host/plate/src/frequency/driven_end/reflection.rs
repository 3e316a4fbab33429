//! How much of the returning wave the driven end sends back.

use super::{DrivenEnd, supported};
use crate::spec::drive::DriveEnd;
use crate::spec::model::Model;
use crate::spec::plate::Plate;
use crate::spec::source::Source;
use num_complex::Complex64;

/// Reflection r of the propagating wave at the driven end: on a straight strip of the end's width and with the drive at
/// rest, p = e^(-j k0 x) + r e^(+j k0 x). `None` if the wave of `frequency_hz` cannot enter.
///
/// It is the reflection of the end as the solvers have it: for a plate in bending the ends `Force` and `Resistance` are
/// approximations, see [`resistance_reflection`].
pub fn reflection(plate: &Plate, frequency_hz: f64) -> Option<Complex64> {
    of_end(plate, frequency_hz, || DrivenEnd::with_narrowing(plate, frequency_hz, 0.0))
}

/// [`reflection`] with `source` at the end of a supported plate in bending, in place of the plate's own drive end.
pub(crate) fn source_reflection(plate: &Plate, source: &Source, frequency_hz: f64) -> Option<Complex64> {
    of_end(plate, frequency_hz, || supported::sourced(plate, frequency_hz, 0.0, source))
}

fn of_end(plate: &Plate, frequency_hz: f64, end: impl FnOnce() -> DrivenEnd) -> Option<Complex64> {
    let width_mode = plate.width_mode(1);
    if width_mode.wavenumber_squared(0.0, frequency_hz) <= 0.0 || !frequency_hz.is_finite() {
        return None;
    }
    let k0 = width_mode.lossy_wavenumber_squared(0.0, frequency_hz).sqrt();
    let DrivenEnd { alpha, beta, .. } = end();
    let step = Complex64::I * k0 * beta;
    Some((step - alpha) / (step + alpha))
}

/// [`reflection`] of the free end with a damper of the same resistance that an end `Resistance` of a supported plate in
/// bending stands for. `None` for other plates and ends.
pub fn resistance_reflection(plate: &Plate, frequency_hz: f64) -> Option<Complex64> {
    let (DriveEnd::Resistance { ratio, at_frequency_hz }, Model::BendingSupported(_)) =
        (plate.spec().drive_end, &plate.spec().model)
    else {
        return None;
    };
    let source = Source {
        resistance_n_s_per_m: ratio * plate.wave_impedance_n_s_per_m(at_frequency_hz)?,
        ..Source::soft(&plate.spec().model, at_frequency_hz)
    };
    source_reflection(plate, &source, frequency_hz)
}
