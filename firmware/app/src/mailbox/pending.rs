//! Start, table and trigger of the pending motion.

use slipline_protocol::units::SampleIndex;

use crate::slots::SlotIndex;

/// The pending motion without its trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pending {
    /// Its start; the first index at which the trigger input is looked at, if it waits for that.
    pub at: SampleIndex,
    /// The slot of its table.
    pub slot: SlotIndex,
    /// Whether any tone sounds at its end.
    pub sounds: bool,
    /// It begins with the first block after a rise of the trigger input.
    pub waits: bool,
    /// Any other motion may replace it: one that waits, and the level hold's own.
    pub yields: bool,
    /// It is a drive of the user's: drive time and lease begin with it. Not a table's swap, nor the level hold's own.
    pub drives: bool,
}
