//! Reasons why a level hold has ended without the user's switch.

use super::HoldError;
use super::words::state_words;
use slipline_link::protocol::event::Faults;
use slipline_link::{HoldLoss, HoldState, Refusal};

/// Why a hold has ended. Its text is a reason without a capital and a full stop.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HoldEnd {
    /// The user has stopped the drive.
    #[error("the drive was stopped")]
    Stopped,
    /// The device has muted its output.
    #[error("the device was disarmed")]
    Disarmed,
    /// The device has stopped with a fault.
    #[error("the device has stopped: {0}")]
    Fault(Faults),
    /// The connection to the device is lost.
    #[error("the device disconnected")]
    LinkLost,
    /// The screen shows another plate, or the device has another table.
    #[error("the plate was changed")]
    OtherPlate,
    /// A measurement needs the sensor.
    #[error("the sensor is needed to measure the plate")]
    Measured,
    /// The sounding tones cannot be held.
    #[error("{0}")]
    Cannot(HoldError),
    /// The device has refused to listen or to hold.
    #[error("the device refused it: {0}")]
    Refused(Refusal),
    /// The device's firmware does not know the command.
    #[error("the device's firmware is too old for it")]
    TooOld,
    /// The device has ended the hold for an unknown reason.
    #[error("another command has changed the drive")]
    Disturbed,
    /// The device has lost all tones.
    #[error("every tone was lost, and sounds at the drive's level: {0}")]
    Lost(String),
}

impl HoldEnd {
    /// All tones are lost, each with its reason.
    pub(super) fn lost(losses: impl Iterator<Item = HoldLoss>) -> Self {
        let mut reasons: Vec<&str> = Vec::new();
        for loss in losses {
            let words = state_words(HoldState::Lost(loss));
            let reason = words.strip_prefix("lost: ").unwrap_or(words);
            if !reasons.contains(&reason) {
                reasons.push(reason);
            }
        }
        Self::Lost(reasons.join("; "))
    }

    /// Whether the end was not caused by the user, so that it is reported on every page.
    #[must_use]
    pub const fn is_trouble(&self) -> bool {
        !matches!(self, Self::Stopped | Self::Disarmed | Self::OtherPlate | Self::Measured)
    }
}
