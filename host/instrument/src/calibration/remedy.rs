//! Remedies for a refused calibration.

use super::page::WizardPage;
use slipline_plate::calibrate::{CalibrateError, Measurement};

/// Where and how the cause of a refusal is removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Remedy {
    /// On this page.
    Page(WizardPage),
    /// By swapping the two responses.
    Exchange,
}

impl Remedy {
    /// The remedy for a refused calibration of these measurements.
    #[must_use]
    pub fn of(error: &CalibrateError, sensors: [&Measurement; 2], check: Option<&Measurement>) -> Self {
        let at = |place_m: f64| {
            let of = sensors.into_iter().chain(check).position(|sensor| sensor.place_m == place_m);
            Self::Page(match of {
                Some(1) => WizardPage::SecondPlace,
                Some(2) => WizardPage::Check,
                _ => WizardPage::FirstAnswer,
            })
        };
        match *error {
            CalibrateError::Swapped { .. } => Self::Exchange,
            CalibrateError::BeyondPlate { place_m, .. }
            | CalibrateError::Clipped { place_m, .. }
            | CalibrateError::NoSignal { place_m }
            | CalibrateError::Misplaced { place_m, .. }
            | CalibrateError::HeavySensor { place_m, .. }
            | CalibrateError::UnlikeNearEnd { place_m, .. }
            | CalibrateError::NotCarried { place_m, .. } => at(place_m),
            CalibrateError::NoStrain
            | CalibrateError::AnotherMass { .. }
            | CalibrateError::FewFrequencies { .. }
            | CalibrateError::NotCovered { .. } => Self::Page(WizardPage::FirstAnswer),
            CalibrateError::DifferentSensors
            | CalibrateError::SamePlace { .. }
            | CalibrateError::EdgesUnseen { .. } => Self::Page(WizardPage::SecondPlace),
            CalibrateError::CheckDiffers { .. } => Self::Page(WizardPage::Check),
            CalibrateError::OutOfRange(_)
            | CalibrateError::WrongCount(_)
            | CalibrateError::Plate(_)
            | CalibrateError::Table(_)
            | CalibrateError::NoFit
            | CalibrateError::Unlike { .. }
            | CalibrateError::NoAir { .. }
            | CalibrateError::OtherAir { .. }
            | CalibrateError::MoreAir { .. }
            | CalibrateError::EdgesUnlike { .. }
            | CalibrateError::AnotherPlate { .. }
            | CalibrateError::EdgesGive { .. }
            | CalibrateError::ImplausibleFeeling { .. }
            | CalibrateError::CloseMarks { .. }
            | CalibrateError::EdgesOpen { .. }
            | CalibrateError::NoEdge
            | CalibrateError::NotCarriedByCurrent { .. }
            | CalibrateError::NotCalibrated
            | CalibrateError::AnotherSensor { .. }
            | CalibrateError::PhasesUnlike { .. }
            | CalibrateError::Ambiguous { .. } => Self::Page(WizardPage::Plate),
            _ => Self::Page(WizardPage::Plate),
        }
    }

    /// The instruction as a sentence.
    #[must_use]
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Exchange => "Swap the two answers.",
            Self::Page(WizardPage::FirstPlace | WizardPage::FirstAnswer) => {
                "Put the sensor at the first place again, see that its light is green, and measure there once more."
            }
            Self::Page(WizardPage::SecondPlace | WizardPage::Result) => {
                "Put the same sensor at the second place again, see that its light is green, and measure there once more."
            }
            Self::Page(WizardPage::Check) => {
                "Put the same sensor at the third place again, see that its light is green, and measure there once more."
            }
            Self::Page(WizardPage::Plate) => {
                "Take everything off the plate, check that it is the plate of this file, and measure its widths and \
                 its length by calipers and a rule."
            }
        }
    }
}
