//! What the mailbox knows of a motion that has not begun.

use slipline_protocol::units::SampleIndex;

use crate::slots::SlotIndex;

/// What is known of a motion that has not begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pending {
    /// Its start; the first index at which the trigger input is looked at, if it waits for that.
    pub at: SampleIndex,
    /// The slot of the table it goes by.
    pub slot: SlotIndex,
    /// Whether any tone sounds at its end.
    pub sounds: bool,
    /// It begins with the first block after a rise of the trigger input.
    pub waits: bool,
}
