//! The thread side hands a motion over to the renderer.

use embassy_sync::blocking_mutex::raw::RawMutex;

use super::shared::Shared;
use super::{Mailbox, Pending, View};
use crate::motion::Motion;

/// Why a program could not be published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotPublished {
    /// Another one is pending.
    Pending,
    /// Its index has passed, or the motion it was made for has changed: make it anew.
    Late,
}

impl<M: RawMutex> Mailbox<M> {
    /// Hands over a motion that goes on from that of `view`: it is pending until its start. One that waits for the
    /// trigger input is dropped for it.
    ///
    /// # Errors
    /// [`NotPublished`]; nothing has begun then.
    pub fn publish(&self, motion: Motion, view: &View) -> Result<(), NotPublished> {
        self.hand_over(motion, view, false)
    }

    /// As [`Mailbox::publish`] a motion that begins with the first block after a rise of the trigger input. The rise
    /// counts from the rendering of the block at the motion's start on; the motion of `view` must have ended there.
    ///
    /// # Errors
    /// As [`Mailbox::publish`].
    pub fn publish_waiting(&self, motion: Motion, view: &View) -> Result<(), NotPublished> {
        self.hand_over(motion, view, true)
    }

    fn hand_over(&self, motion: Motion, view: &View, waits: bool) -> Result<(), NotPublished> {
        let refusal = |shared: &Shared| {
            let is_late = motion.start() < shared.next.get()
                || shared.changes.get() != view.changes
                || shared.stop.get().is_some();
            if shared.pending.get().is_some_and(|pending| !pending.waits) {
                Err(NotPublished::Pending)
            } else if is_late {
                Err(NotPublished::Late)
            } else {
                Ok(())
            }
        };
        // While nothing is pending, the renderer neither swaps the motions nor reads the spare one.
        let spare = self.shared.lock(|shared| {
            if shared.is_publishing.get() {
                return Err(NotPublished::Pending);
            }
            refusal(shared)?;
            // It may be one that waits: from here on it cannot begin any more.
            shared.pending.set(None);
            shared.is_publishing.set(true);
            Ok(shared.live.get().other())
        })?;
        spare.of(&self.motions).store(&motion);
        self.shared.lock(|shared| {
            shared.is_publishing.set(false);
            refusal(shared)?;
            spare.of(&shared.outlines).set(motion.outline());
            shared.pending.set(Some(Pending {
                at: motion.start(),
                slot: motion.table().slot,
                sounds: !motion.ends_silent(),
                waits,
            }));
            Ok(())
        })
    }
}
