//! Why a request was not done.

use crate::drive::DriveError;
use crate::error::LinkError;
use slipline_protocol::refusal;
use slipline_protocol::version::Compatibility;

/// Why a request was not done: the device's own answer, or a reason on this side. As text it is one sentence without a
/// capital and a full stop.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// The drive cannot be put into the device's units.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// The table that was read back is not the one that was sent.
    #[error("the table on the device is not the one that was sent")]
    TableDiffers,
    /// The device could not take a block of its inputs in time, so the measurement ended early.
    #[error("the device lost codes of its inputs at sample {at}; measure again")]
    InputLost {
        /// The first sample that is missing.
        at: u64,
    },
    /// The device answered with an event that does not belong to the command.
    #[error("the device gave an answer that does not fit the question")]
    UnexpectedReply,
}
