//! What the mailbox knows of a motion that has not begun.

use slipline_protocol::units::SampleIndex;

use crate::slots::SlotIndex;

/// What is known of a motion that waits for its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pending {
    /// Its start.
    pub at: SampleIndex,
    /// The slot of the table it goes by.
    pub slot: SlotIndex,
    /// Whether any tone sounds at its end.
    pub sounds: bool,
}
