//! Reflection of the returning wave at the driven end.

use super::DrivenEnd;
use super::whole_end::with_whole_end;
use crate::definition::drive::DriveEnd;
use crate::definition::plate::Plate;
use num_complex::Complex64;

/// Reflection r of the propagating wave at the driven end: on a straight strip of the end's width and with the drive at
/// rest, p = e^(-j k0 x) + r e^(+j k0 x). `None` if the wave of `frequency_hz` cannot enter.
///
/// It is the reflection in the solvers' equation: for a plate in bending the ends `Force` and `Resistance` are
/// approximations, see [`resistance_reflection`].
pub fn reflection(plate: &Plate, frequency_hz: f64) -> Option<Complex64> {
    let k0 = entering(plate, frequency_hz)?;
    Some(DrivenEnd::with_narrowing(plate, frequency_hz, 0.0).reflection(k0))
}

/// k0 with loss at the driven end, 1/m; `None` if the wave of `frequency_hz` cannot enter.
pub(super) fn entering(plate: &Plate, frequency_hz: f64) -> Option<Complex64> {
    let width_mode = plate.width_mode(1);
    let enters = frequency_hz.is_finite() && width_mode.wavenumber_squared(0.0, frequency_hz) > 0.0;
    enters.then(|| width_mode.lossy_wavenumber_squared(0.0, frequency_hz).sqrt())
}

impl DrivenEnd {
    /// r for the wavenumber `k0`, 1/m.
    pub(super) fn reflection(&self, k0: Complex64) -> Complex64 {
        let step = Complex64::I * k0 * self.beta;
        (step - self.alpha) / (step + self.alpha)
    }
}

/// [`reflection`] of a free end with a damper, for an end `Resistance` of a plate in bending with the same
/// resistance. `None` for other plates and ends.
pub fn resistance_reflection(plate: &Plate, frequency_hz: f64) -> Option<Complex64> {
    match plate.spec().drive_end {
        DriveEnd::Resistance { .. } => reflection(&with_whole_end(plate)?, frequency_hz),
        _ => None,
    }
}
