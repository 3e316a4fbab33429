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
    /// Stale: the start index has passed or the base motion changed. Plan again.
    Late,
}

/// How a motion is pending: as the fields of [`Pending`].
#[derive(Clone, Copy)]
struct Manner {
    waits: bool,
    yields: bool,
    drives: bool,
}

impl<M: RawMutex> Mailbox<M> {
    /// Hands over a drive that goes on from the motion of `view`: it is pending until its start. A pending motion that
    /// [yields](Pending::yields) is dropped for it.
    ///
    /// # Errors
    /// [`NotPublished`]; nothing has begun then.
    pub fn publish(&self, motion: &Motion, view: &View) -> Result<(), NotPublished> {
        self.hand_over(motion, view, Manner { waits: false, yields: false, drives: true })
    }

    /// Like [`Mailbox::publish`], for a table's swap, which is no drive.
    ///
    /// # Errors
    /// As [`Mailbox::publish`].
    pub fn publish_swap(&self, motion: &Motion, view: &View) -> Result<(), NotPublished> {
        self.hand_over(motion, view, Manner { waits: false, yields: false, drives: false })
    }

    /// Like [`Mailbox::publish_swap`], for levels that any later motion may replace until they begin.
    ///
    /// # Errors
    /// As [`Mailbox::publish`].
    pub fn publish_levels(&self, motion: &Motion, view: &View) -> Result<(), NotPublished> {
        self.hand_over(motion, view, Manner { waits: false, yields: true, drives: false })
    }

    /// As [`Mailbox::publish`] a motion that begins with the first block after a rise of the trigger input. The rise
    /// counts from the rendering of the block at the motion's start on; the motion of `view` must have ended there.
    ///
    /// # Errors
    /// As [`Mailbox::publish`].
    pub fn publish_waiting(&self, motion: &Motion, view: &View) -> Result<(), NotPublished> {
        self.hand_over(motion, view, Manner { waits: true, yields: true, drives: true })
    }

    /// Drops what has been published by [`Mailbox::publish_levels`] and has not begun; returns whether there was any.
    pub fn drop_levels(&self) -> bool {
        self.shared.lock(|shared| {
            let waits = shared.pending.get().is_some_and(|pending| pending.yields && !pending.waits);
            if waits {
                shared.pending.set(None);
            }
            waits
        })
    }

    fn hand_over(&self, motion: &Motion, view: &View, manner: Manner) -> Result<(), NotPublished> {
        let refusal = |shared: &Shared| {
            let is_late = motion.start() < shared.next.get()
                || shared.changes.get() != view.changes
                || shared.stop.get().is_some();
            if shared.pending.get().is_some_and(|pending| !pending.yields) {
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
            // It may be one that yields: from here on it cannot begin any more.
            shared.pending.set(None);
            shared.is_publishing.set(true);
            Ok(shared.live.get().other())
        })?;
        spare.of(&self.motions).store(motion);
        self.shared.lock(|shared| {
            shared.is_publishing.set(false);
            refusal(shared)?;
            spare.of(&shared.outlines).set(motion.outline());
            shared.pending.set(Some(Pending {
                at: motion.start(),
                slot: motion.table().slot,
                sounds: !motion.ends_silent(),
                waits: manner.waits,
                yields: manner.yields,
                drives: manner.drives,
            }));
            Ok(())
        })
    }
}
