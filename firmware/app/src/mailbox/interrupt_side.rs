//! The mailbox as the renderer uses it.

use core::sync::atomic::Ordering;

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::event::Fault;
use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::units::SampleIndex;

use super::{Mailbox, Orders, Report, Shared, Stop};
use crate::digest::DigestState;
use crate::motion::cell::MotionCell;
use crate::motion::outline::Outline;
use crate::motion::{Onset, Placement};
use crate::timing::BLOCK_SAMPLES;

/// Offset in samples of a ramp that is applied to a rendered block: it changes the block's second code first. A ramp of a
/// block that is not rendered yet begins at the block's first index, so the reported index shows which of the two it was.
const REVISED: u64 = 1;

impl<M: RawMutex> Mailbox<M> {
    /// Sets the index of the first block.
    pub fn begin_at(&self, index: SampleIndex) {
        self.shared.lock(|shared| {
            shared.next.set(index);
            shared.fed_at.set(index);
        });
    }

    /// Takes the orders for the block at `index`, and moves the index on: what is published from now on begins later.
    /// A motion that begins with this block comes into force if `may_begin` says so; else it is dropped. One that waits
    /// for the trigger input begins if that `has_risen` since the block before.
    ///
    /// All this is one step: a stop that comes a moment later finds the motion in force.
    pub(crate) fn begin_block(
        &self,
        index: SampleIndex,
        has_risen: bool,
        may_begin: impl FnOnce(&Orders) -> bool,
    ) -> Orders {
        let [renderer, _, _] = &self.pulses;
        renderer.fetch_add(1, Ordering::Relaxed);
        self.shared.lock(|shared| {
            shared.next.set(index.saturating_add(BLOCK_SAMPLES));
            let here = shared.pending.get().filter(|pending| pending.at <= index);
            // A rise before the block at its start has no effect, or belongs to the drive before it.
            let listens = here.is_some_and(|pending| pending.waits && (!has_risen || pending.at == index));
            let due = here.filter(|_| !listens);
            let mut orders = Orders {
                due,
                begins: false,
                listens,
                stop: shared.stop.take(),
                armed: shared.armed.get(),
                on_bench: shared.is_on_bench(),
                ready_at: shared.ready_at.get(),
                fed_at: shared.fed_at.get(),
                lease_ends: shared.lease_ends.get(),
                limit_per_mille: shared.limit_per_mille.get(),
                digest: shared.digest.get(),
            };
            if let Some(due) = due {
                shared.pending.set(None);
                orders.begins = may_begin(&orders);
                if orders.begins {
                    if due.waits {
                        shared.begin_waiting(index);
                    }
                    if due.drives {
                        shared.begin_drive(index);
                    }
                    shared.live.set(shared.live.get().other());
                    shared.count_change();
                }
            }
            orders
        })
    }

    /// Waits for a stop at once; may wake for one that is taken already.
    pub(crate) async fn stopped(&self) {
        self.stopped.wait().await;
    }

    /// Takes a stop at once that is to begin in the block at `last`, which was rendered last, if it may begin there. One
    /// that may not begins with the next block.
    pub(crate) fn stop_in_last_block(
        &self,
        last: SampleIndex,
        may_begin: impl FnOnce(Stop) -> bool,
    ) -> Option<Stop> {
        self.shared.lock(|shared| {
            if !shared.may_revise.take() {
                return None;
            }
            let stop = shared.stop.get().filter(|stop| may_begin(*stop))?;
            shared.stop.set(None);
            shared.stopped_at.set(last.saturating_add(REVISED));
            Some(stop)
        })
    }

    /// The outline of the motion in force.
    pub(crate) fn outline(&self) -> Outline {
        self.shared.lock(Shared::outline)
    }

    /// The trajectories of the motion in force. No lock guards them: this side alone decides which motion is in force,
    /// and alone writes it.
    fn live(&self) -> &MotionCell {
        self.shared.lock(|shared| shared.live.get()).of(&self.motions)
    }

    /// Calls `begin` with slot and onset of each tone that starts from silence.
    pub(crate) fn onsets(&self, mut begin: impl FnMut(usize, Onset)) {
        for (slot, onset) in self.live().onsets().enumerate() {
            if let Some(onset) = onset {
                begin(slot, onset);
            }
        }
    }

    /// Writes where each tone is at an index to `places`, by the motion in force and its outline.
    pub(crate) fn place(&self, outline: &Outline, index: SampleIndex, places: &mut [Placement; MAX_TONES]) {
        self.live().place(outline, index, &self.slots, places);
    }

    /// The motion in force becomes a ramp to silence from `here`, at an index, in `ramp` samples.
    pub(crate) fn fade(&self, here: &[Placement; MAX_TONES], index: SampleIndex, ramp: u32) {
        let table = self.shared.lock(|shared| {
            shared.is_fading.set(true);
            shared.outline().table
        });
        self.live().fade(here);
        // Computed outside the lock: a division takes long.
        let outline = Outline::fading(here, index, ramp, table);
        self.shared.lock(|shared| {
            shared.live.get().of(&shared.outlines).set(outline);
            shared.count_change();
            shared.is_fading.set(false);
        });
    }

    /// Publishes the block's report.
    pub(crate) fn end_block(&self, report: Report) {
        self.shared.lock(|shared| shared.report.set(report));
    }

    /// Publishes how the digest stands.
    pub(crate) fn set_digest(&self, state: DigestState) {
        self.shared.lock(|shared| shared.digest.set(state));
    }

    /// Disarms at once and drops what is pending; for the renderer, which ramps by itself.
    pub(crate) fn disarm_now(&self, fault: Option<(Fault, SampleIndex)>) {
        self.shared.lock(|shared| shared.disarm_now(fault));
    }

    /// As [`Self::disarm_now`] if the device is armed; returns whether it was.
    pub(crate) fn disarm_if_armed(&self, fault: (Fault, SampleIndex)) -> bool {
        self.shared.lock(|shared| {
            let armed = shared.armed.get();
            if armed {
                shared.disarm_now(Some(fault));
            }
            armed
        })
    }

    /// Wakes the thread side.
    pub(crate) fn signal_tick(&self) {
        self.tick.signal(());
    }
}
