//! Unknowns of the plate as coordinates that a fit moves, and their standard deviations beforehand, by calipers and plate
//! file.
//!
//! | coordinate | of | known beforehand to (standard deviation) |
//! |---|---|---|
//! | 0 | ln of the wave speed over the file's | 10 % |
//! | 1 | ln of the loss factor over the file's | a factor of e |
//! | 2 | ln(W0/W(L)) over the file's, less 1 | [`Priors::taper`] |
//! | 3 | ln of W0 over the file's | [`Priors::half_width`] |

use crate::definition::limits;
use crate::definition::{Model, PlateSpec};
use crate::quantity::{OutOfRange, Range};

/// Coordinates of the plate; those of the sensors follow.
pub(crate) const SPEED: usize = 0;
pub(crate) const LOSS: usize = 1;
pub(crate) const TAPER: usize = 2;
pub(crate) const HALF_WIDTH: usize = 3;
pub(crate) const OF_PLATE: usize = 4;
/// Ways over which derivatives by the plate's coordinates are taken.
pub(crate) const STEPS: [f64; OF_PLATE] = [1e-6, 1e-4, 1e-6, 1e-6];

/// How well the plate's numbers are known before it is measured, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Priors {
    /// Of ln(wave speed) (0.001 to 0.5).
    pub wave_speed: f64,
    /// Of ln(loss factor) (0.01 to 3).
    pub loss: f64,
    /// Of ln(W0/W(L)), relative (1e-5 to 0.1): for an exponential taper that of its rate.
    pub taper: f64,
    /// Of W0, relative (1e-5 to 0.1).
    pub half_width: f64,
}

impl Default for Priors {
    /// A plate that was cut to 0.3 % of its width and 0.4 % of its taper, of a material known to 10 % of wave speed and
    /// a factor of e of loss.
    fn default() -> Self {
        Self { wave_speed: 0.1, loss: 1.0, taper: 4e-3, half_width: 3e-3 }
    }
}

impl Priors {
    /// Refuses a standard deviation that is out of its range.
    pub(crate) fn check(&self) -> Result<(), OutOfRange> {
        let widths = Range::new(1e-5, 0.1, "");
        OutOfRange::check("priors.wave_speed", self.wave_speed, Range::new(1e-3, 0.5, ""))?;
        OutOfRange::check("priors.loss", self.loss, Range::new(0.01, 3.0, ""))?;
        OutOfRange::check("priors.taper", self.taper, widths)?;
        OutOfRange::check("priors.half_width", self.half_width, widths)
    }

    /// The standard deviations in the order of the coordinates.
    pub(crate) const fn deviations(&self) -> [f64; OF_PLATE] {
        [self.wave_speed, self.loss, self.taper, self.half_width]
    }
}

/// The specification at these coordinates of the plate.
pub(crate) fn spec_at(nominal: &PlateSpec, coordinates: &[f64]) -> PlateSpec {
    let mut spec = nominal.clone();
    let speed = coordinates[SPEED].exp();
    spec.model = with_speed(&spec.model, speed);
    // A lossless file has nothing to multiply: its coordinate is taken from a small loss.
    spec.loss_factor = (loss_of(nominal) * coordinates[LOSS].exp()).min(limits::LOSS_FACTOR.high);
    let (scale, power) = (coordinates[HALF_WIDTH].exp(), 1.0 + coordinates[TAPER]);
    spec.taper = spec.taper.stretched(scale, power);
    spec
}

/// The loss factor that the fit starts from.
pub(crate) fn loss_of(nominal: &PlateSpec) -> f64 {
    nominal.loss_factor.max(1e-4)
}

fn with_speed(model: &Model, factor: f64) -> Model {
    let mut model = model.clone();
    match &mut model {
        Model::Membrane { wave_speed_m_per_s, tension_n_per_m, .. } => {
            *wave_speed_m_per_s *= factor;
            if let Some(tension) = tension_n_per_m {
                *tension *= factor * factor;
            }
        }
        Model::ShearHorizontal { shear_modulus_pa, .. } => *shear_modulus_pa *= factor * factor,
        Model::BendingSupported(bending) | Model::BendingClamped(bending) => {
            bending.youngs_modulus_pa *= factor.powi(4);
        }
    }
    model
}
