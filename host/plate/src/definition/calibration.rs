//! The record of a calibration in a plate file: tolerances, and the correction of the drive's response.

use crate::definition::impedance::Impedance;
use crate::definition::response_curve::ResponseCurve;

/// The fields of a plate file for the source's intervals, in the order of [`Impedance::fields`].
pub(crate) const SOURCE_TOLERANCE: [&str; 3] =
    ["resistance_tolerance_n_s_per_m", "mass_tolerance_kg", "stiffness_tolerance_n_per_m"];

/// The record of a calibration.
///
/// The tolerances of wave speed and loss are [`crate::PlateSpec::wave_speed_tolerance`] and
/// [`crate::PlateSpec::loss_tolerance`], which a drive table and the validity lights use.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Sum of the squared residuals, each over its variance, divided by their number (0 to 1e6): about 1 where the
    /// model fits to within the noise.
    pub chi2_per_n: f64,
    /// Half of the 95 % interval of the half-width at the driven end, as a fraction (0 to 1).
    pub half_width_tolerance: f64,
    /// Half of the 95 % interval of ln(W0/W(L)), as a fraction (0 to 1); for an exponential taper, of its rate.
    pub taper_tolerance: f64,
    /// Half of the 95 % interval of the level of the peak, dB (0 to 40). `None` if no levels were measured.
    pub level_tolerance_db: Option<f64>,
    /// Halves of the 95 % intervals of the source's resistance, mass and stiffness. `None` if the source was not fitted.
    pub source_tolerance: Option<Impedance>,
    /// Measured complex gain from the DAC to the peak over the gain by the rest of the file. It multiplies every
    /// steady amplitude. `None` if no levels were measured.
    pub correction: Option<ResponseCurve>,
}
