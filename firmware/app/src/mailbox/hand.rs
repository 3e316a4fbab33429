//! When the board's user button was pressed, as the renderer has seen it: the sign that a hand is on the board.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::units::SampleIndex;

use super::Mailbox;

/// The presses of this run. A button that is held while the device starts counts from its release on, if at all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hand {
    /// The block before which the last press began.
    pub since: Option<SampleIndex>,
    /// The last block before which the button was pressed.
    pub last: Option<SampleIndex>,
}

impl<M: RawMutex> Mailbox<M> {
    /// The presses of this run.
    pub fn hand(&self) -> Hand {
        self.shared.lock(|shared| shared.hand.get())
    }

    /// Notes that the button is pressed before the block at `index`; `begins`: it was not before the block before.
    pub(crate) fn note_press(&self, index: SampleIndex, begins: bool) {
        self.shared.lock(|shared| {
            let since = if begins { Some(index) } else { shared.hand.get().since };
            shared.hand.set(Hand { since, last: Some(index) });
        });
    }
}
