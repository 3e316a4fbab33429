//! The loss of a plate's stiffness over the frequency: the same everywhere, or a power law about the middle of the band.
//!
//! ```text
//! eta(f) = eta (f/f_m)^p,   f_m^2 = product of the frequencies of the span's ends
//! ```
//! p is 0 of a loss that does not depend on the rate, as of most metals and of many a rubber over an octave, and 1 of a viscous one
//! (Kelvin and Voigt).

use super::error::PlateError;
use super::limits;
use super::model::Model;
use super::plate::Plate;
use super::spec::PlateSpec;

/// eta of the stiffness, in K^2, at every frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LossLaw {
    /// eta at the middle of the band.
    middle: f64,
    course: Option<Course>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Course {
    exponent: f64,
    /// f_m, Hz.
    middle_hz: f64,
    /// The most that any frequency has.
    most: f64,
}

impl LossLaw {
    pub(crate) fn at(&self, frequency_hz: f64) -> f64 {
        let Some(Course { exponent, middle_hz, most }) = self.course else { return self.middle };
        (self.middle * (frequency_hz / middle_hz).powf(exponent)).min(most)
    }
}

impl PlateSpec {
    /// Refuses a course of the loss that no law here has.
    pub(super) fn check_loss_exponent(&self) -> Result<(), PlateError> {
        let stated = [
            ("loss_exponent", self.loss_exponent),
            ("loss_exponent_tolerance", self.loss_exponent_tolerance),
        ];
        for (field, value) in stated {
            if value.is_some() && self.model.is_clamped() {
                let reason = "the law between clamped edges has one loss for all frequencies";
                return Err(PlateError::unexpected(field, reason));
            }
        }
        Ok(())
    }
}

impl Plate {
    /// The law of [`Plate::wave_loss`] over the frequency.
    pub(crate) fn loss_law(&self) -> LossLaw {
        let course = self.spec().loss_exponent.map(|exponent| {
            let (low_hz, high_hz) = self.band_hz();
            let most = self.share_of_loss() * limits::LOSS_FACTOR.high;
            Course { exponent, middle_hz: (low_hz * high_hz).sqrt(), most }
        });
        LossLaw { middle: self.wave_loss(), course }
    }

    /// [`Plate::wave_loss`] at a frequency.
    pub(crate) fn stiffness_loss_at(&self, frequency_hz: f64) -> f64 {
        self.loss_law().at(frequency_hz)
    }

    /// The loss factor of the modulus or the tension at a frequency, Hz: that of the file, or its power law, at most 0.5.
    #[must_use]
    pub fn loss_factor_at(&self, frequency_hz: f64) -> f64 {
        self.stiffness_loss_at(frequency_hz) / self.share_of_loss()
    }

    /// [`Plate::wave_loss`] over the loss factor.
    pub(super) fn share_of_loss(&self) -> f64 {
        match self.spec().model {
            Model::BendingSupported(_) | Model::BendingClamped(_) => 0.5,
            Model::Membrane { .. } | Model::ShearHorizontal { .. } => 1.0,
        }
    }
}
