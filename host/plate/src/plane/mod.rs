//! The plate in two dimensions, in the frequency domain: a check of the one-mode equation, without its assumptions.
//!
//! ```text
//! Plate + Setup (end, lead-in, finger) + frequency -> Field -> centre line -> Response, as that of the one-mode equation
//!                                                  -> reflection of the driven end
//! Response of one, Response of the other           -> Comparison (mm, dB, nodes)
//! ```
//!
//! The sheet is mapped to a strip by b = z/W(x) and w = sum f_m(x) p_m(b) with polynomials p_m that vanish at the
//! edges (and have zero slope there, where they are clamped). The f_m are cubic Hermite elements. The minimised
//! energy is that of a membrane, or the whole energy D ((lap w)^2 - 2 (1 - nu)(w_xx w_zz - w_xz^2)) of a Kirchhoff
//! plate, so a free end and a supported edge need no condition of their own; see `section.rs`. The matrix is a narrow
//! band, and a preset's field takes some milliseconds.
//!
//! A plate with air carries the added mass of the air, computed by panels over the whole sheet: see `fluid.rs`. It
//! couples every part with every other, so a membrane's field takes 0.1 s in a baffle and up to 1 s in a bare frame.
//! Where the plate file states a coefficient, the mass is that of the free wave, as in the one-mode equation.
//!
//! Thick plates (`thick_plate`) use Mindlin's wavenumber in a Kirchhoff plate. Loss is a complex modulus that changes
//! K^2 to K^2 (1 + j eta), as in the one-mode equation. Only fields symmetric about the centre line are computed.

mod band_matrix;
mod basis;
mod comparison;
mod discrete;
mod error;
mod field;
mod fluid;
mod minimal_residual;
mod outline;
mod panels;
mod reflection;
mod section;
mod setup;
pub(crate) mod strip;
mod system;
#[cfg(test)]
mod tests;

pub use comparison::Comparison;
pub use error::PlaneError;
pub use field::Field;
pub use reflection::reflection;
pub use setup::{End, Force, Setup};

use crate::definition::plate::Plate;
use crate::frequency::Response;

/// The centre line of the plate at `frequency_hz` on `points` uniform positions, with its peak: see [`Field::solve`] and
/// [`Field::centre_line`].
///
/// ```
/// use slipline_plate::{Equation, plane, preset, respond};
///
/// let plate = preset("membrane").unwrap();
/// let one_mode = respond(&plate, 150.0, 513, Equation::Corrected).unwrap();
/// let setup = plane::Setup::of(&plate);
/// let two_dimensions = plane::respond(&plate, 150.0, 513, &setup).unwrap();
/// let differs = plane::Comparison::of(&one_mode, &two_dimensions);
/// assert!(differs.peak_shift_m.unwrap().abs() < 2e-3);
/// ```
///
/// # Errors
/// The errors of both.
pub fn respond(
    plate: &Plate,
    frequency_hz: f64,
    points: usize,
    setup: &Setup,
) -> Result<Response, PlaneError> {
    Field::solve(plate, frequency_hz, setup)?.centre_line(points)
}
