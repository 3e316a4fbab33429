//! The axial part of the local wavenumber, a K^2, for the amplitude equation and its conditions at the driven end.

use crate::definition::width_mode::WidthMode;
use num_complex::Complex64;

/// a K^2 (1 + j eta) with eta = [`crate::Plate::wave_loss_at`], 1/m^2.
pub(crate) fn lossy_axial_squared(width_mode: &WidthMode<'_>, frequency_hz: f64) -> Complex64 {
    width_mode.axial_squared(frequency_hz) * width_mode.plate.lossy(frequency_hz)
}
