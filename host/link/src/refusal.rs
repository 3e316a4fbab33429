//! Reasons for which a request is refused.

use crate::drive::DriveError;
use crate::error::LinkError;
use slipline_protocol::refusal;
use slipline_protocol::version::Compatibility;

/// Why a request was refused: the device's own reply, or a reason on this side. Its text is one sentence
/// without a capital and a full stop.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
pub enum Refusal {
    /// The device refused.
    #[error("{0}")]
    Device(refusal::Refusal),
    /// The port could not be opened, or no device answered there.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The firmware's version does not allow it.
    #[error("{}", .0.sentence())]
    Incompatible(Compatibility),
    /// The drive cannot be converted to the device's units.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The table that was read back differs from the one that was sent.
    #[error("the table on the device is not the one that was sent")]
    TableDiffers,
    /// The device did not read a block of its inputs in time, so the measurement ended early.
    #[error("the device lost codes of its inputs at sample {at}; measure again")]
    InputLost {
        /// The first missing sample.
        at: u64,
    },
    /// The device has accepted to enter its bootloader, and runs the same program again.
    #[error("the device restarted and is not in its bootloader: hold BOOT0 while you reset it")]
    NotInBootloader,
    /// The device replied with an event that does not belong to the command.
    #[error("the device's reply does not belong to the command")]
    UnexpectedReply,
}
