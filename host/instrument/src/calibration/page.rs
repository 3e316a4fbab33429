//! The pages of a calibration.

/// A page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum WizardPage {
    /// The plate file and the caliper measurements.
    #[default]
    Plate,
    /// Where to put the sensor first.
    FirstPlace,
    /// Its response there.
    FirstAnswer,
    /// Its next place, and its response there.
    SecondPlace,
    /// The calibrated plate, or why the calibration was refused.
    Result,
    /// A third place, whose response checks the result: from the result and back to it.
    Check,
}

impl WizardPage {
    /// The pages in their order; [`WizardPage::Check`] is beside the last.
    pub const ALL: [Self; 5] =
        [Self::Plate, Self::FirstPlace, Self::FirstAnswer, Self::SecondPlace, Self::Result];

    /// The title of the page.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Plate => "The plate as it is known",
            Self::FirstPlace => "The sensor's first place",
            Self::FirstAnswer => "Measure at this position",
            Self::SecondPlace => "The sensor's second place",
            Self::Result => "The plate as it was measured",
            Self::Check => "A third place, as a check",
        }
    }

    /// Its number, from 1; that of the result for the check of it.
    #[must_use]
    pub fn number(self) -> usize {
        Self::ALL.iter().position(|step| *step == self).map_or(Self::ALL.len(), |at| at + 1)
    }

    /// The page after this one.
    #[must_use]
    pub fn next(self) -> Option<Self> {
        if self == Self::Check {
            return Some(Self::Result);
        }
        Self::ALL.get(self.number()).copied()
    }

    /// The page before this one.
    #[must_use]
    pub fn back(self) -> Option<Self> {
        if self == Self::Check {
            return Some(Self::Result);
        }
        Self::ALL.get(self.number().checked_sub(2)?).copied()
    }

    /// The sensor place whose response this page asks for: 0, 1, or 2 for the check.
    #[must_use]
    pub const fn sensor(self) -> Option<usize> {
        match self {
            Self::FirstAnswer => Some(0),
            Self::SecondPlace => Some(1),
            Self::Check => Some(2),
            Self::Plate | Self::FirstPlace | Self::Result => None,
        }
    }
}
