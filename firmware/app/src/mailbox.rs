//! The one thing both halves share.
//!
//! ```text
//! link's half                      Crossing                      renderer's half
//!   publish(program) ---------->   pending, at its index   ---->  begin_block() -> Orders
//!   stop(kind), arm(), feed() -->  stop, armed, fed        ---->
//!   view(), pulses()         <---  motion, report, faults  <----  end_block(Report), moved(Motion), fault()
//!   write(slot, knot)        --->  table slots             ---->  evaluate
//! ```
//! All that has to agree stands under one lock that is held for some copies only. The renderer's index moves on under
//! that lock, so what is published for the next block begins at the next block, exactly.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use slipline_protocol::command::DigestWindow;
use slipline_protocol::event::{Fault, Faults};
use slipline_protocol::table::Knot;
use slipline_protocol::units::SampleIndex;

use crate::digest::DigestState;
use crate::faults::FaultLatch;
use crate::motion::Motion;
pub use crate::orders::{Orders, Pulses, Report, Stop, View};
use crate::program::Program;
use crate::slots::{SlotIndex, TableSlots};
use crate::timing::{BLOCK_SAMPLES, SETTLE_BLOCKS};

/// Why a program could not be published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotPublished {
    /// Another one is pending.
    Pending,
    /// Its index has passed, or the motion it was made for has changed: make it anew.
    Late,
}

struct Shared {
    next: Cell<SampleIndex>,
    motion: Cell<Motion>,
    changes: Cell<u32>,
    /// The pending program; set with `set_pending`, so that its index stands beside it and need not be copied out.
    pending: Cell<Option<Program>>,
    pending_at: Cell<Option<SampleIndex>>,
    stop: Cell<Option<Stop>>,
    armed: Cell<bool>,
    ready_at: Cell<SampleIndex>,
    fed_at: Cell<SampleIndex>,
    limit_per_mille: Cell<Option<u16>>,
    report: Cell<Report>,
    faults: Cell<FaultLatch>,
    digest: Cell<DigestState>,
}

impl Shared {
    fn set_pending(&self, program: Option<Program>) {
        self.pending_at.set(program.map(|program| program.at));
        self.pending.set(program);
    }
}

/// What both halves share: a `static` in a firmware, an `Arc` in a host.
pub struct Crossing<M: RawMutex> {
    shared: Mutex<M, Shared>,
    slots: TableSlots,
    tick: Signal<M, ()>,
    pulses: [AtomicU32; 3],
}

impl<M: RawMutex> Default for Crossing<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> Crossing<M> {
    /// Silent, disarmed, at index 0.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            shared: Mutex::new(Shared {
                next: Cell::new(0),
                motion: Cell::new(Motion::silent()),
                changes: Cell::new(0),
                pending: Cell::new(None),
                pending_at: Cell::new(None),
                stop: Cell::new(None),
                armed: Cell::new(false),
                ready_at: Cell::new(0),
                fed_at: Cell::new(0),
                limit_per_mille: Cell::new(None),
                report: Cell::new(Report {
                    silent: true,
                    stopping: false,
                    sum: 0,
                    energy: 0,
                    clips: 0,
                    underruns: 0,
                    max_cycles: 0,
                    limit_per_mille: None,
                }),
                faults: Cell::new(FaultLatch::new()),
                digest: Cell::new(DigestState::None),
            }),
            slots: TableSlots::new(),
            tick: Signal::new(),
            pulses: [const { AtomicU32::new(0) }; 3],
        }
    }

    /// The first index that is not rendered yet.
    pub fn now(&self) -> SampleIndex {
        self.shared.lock(|shared| shared.next.get())
    }

    /// The table slots.
    pub const fn slots(&self) -> &TableSlots {
        &self.slots
    }

    /// The tasks' signs of life.
    pub fn pulses(&self) -> Pulses {
        let [renderer, link, safety] = &self.pulses;
        let read = |pulse: &AtomicU32| pulse.load(Ordering::Relaxed);
        Pulses { renderer: read(renderer), link: read(link), safety: read(safety) }
    }

    /// Everything at one moment.
    pub fn view(&self) -> View {
        self.shared.lock(|shared| View {
            next: shared.next.get(),
            motion: shared.motion.get(),
            changes: shared.changes.get(),
            pending: shared.pending_at.get(),
            stopping: shared.stop.get().is_some() || shared.report.get().stopping,
            armed: shared.armed.get(),
            ready_at: shared.ready_at.get(),
            report: shared.report.get(),
            faults: shared.faults.get(),
        })
    }

    // ---- what the link's half does -------------------------------------------------------------------------

    /// Hands a program over that was made for `view`.
    ///
    /// # Errors
    /// [`NotPublished`]; nothing has changed then.
    pub fn publish(&self, program: Program, view: &View) -> Result<(), NotPublished> {
        self.shared.lock(|shared| {
            if shared.pending_at.get().is_some() {
                return Err(NotPublished::Pending);
            }
            if program.at < shared.next.get()
                || shared.changes.get() != view.changes
                || shared.stop.get().is_some()
            {
                return Err(NotPublished::Late);
            }
            shared.set_pending(Some(program));
            Ok(())
        })
    }

    /// Orders a ramp to silence, drops what is pending, and returns the index at which the ramp begins.
    pub fn stop(&self, stop: Stop) -> SampleIndex {
        self.shared.lock(|shared| {
            shared.set_pending(None);
            // With what was pending gone, silence stays silence: there is nothing to ramp.
            if !shared.report.get().silent {
                shared.stop.set(Some(stop.quicker(shared.stop.get())));
            }
            shared.next.get()
        })
    }

    /// Orders a ramp to silence and then the mute; no drive begins until armed again.
    pub fn disarm(&self, stop: Stop) -> SampleIndex {
        let at = self.stop(stop);
        self.shared.lock(|shared| shared.armed.set(false));
        at
    }

    /// Unmutes; drives may begin at the index returned, after some blocks of mid-scale. Starts the dead-man's
    /// time.
    pub fn arm(&self) -> SampleIndex {
        self.shared.lock(|shared| {
            let next = shared.next.get();
            if !shared.armed.get() {
                shared.ready_at.set(next.saturating_add(SETTLE_BLOCKS * BLOCK_SAMPLES));
                shared.armed.set(true);
            }
            shared.fed_at.set(next);
            shared.ready_at.get()
        })
    }

    /// Accepts drives from `ready_at` on; for a mirror, which sounds what a device has accepted.
    pub fn arm_from(&self, ready_at: SampleIndex) {
        self.shared.lock(|shared| {
            shared.ready_at.set(ready_at);
            shared.armed.set(true);
        });
    }

    /// Feeds the dead-man.
    pub fn feed(&self) {
        self.shared.lock(|shared| shared.fed_at.set(shared.next.get()));
    }

    /// Latches a fault and disarms, with a ramp.
    pub fn fault(&self, fault: Fault, stop: Stop) -> SampleIndex {
        let at = self.disarm(stop);
        self.latch(fault);
        at
    }

    /// Latches a fault at the present index.
    pub fn latch(&self, fault: Fault) {
        self.shared.lock(|shared| shared.faults.set(shared.faults.get().with(fault, shared.next.get())));
    }

    /// Clears all faults but those in `standing`.
    pub fn clear_faults(&self, standing: Faults) {
        self.shared.lock(|shared| shared.faults.set(shared.faults.get().cleared(standing)));
    }

    /// Sets what the thermal fold-back leaves of every amplitude, per mille. The first one is in force at once, later
    /// ones from the next multiple of [`LIMIT_BLOCKS`](crate::timing::LIMIT_BLOCKS) on, and the renderer goes there
    /// slowly.
    pub fn set_limit(&self, per_mille: u16) {
        self.shared.lock(|shared| shared.limit_per_mille.set(Some(per_mille)));
    }

    /// Whether a slot may be written: neither what sounds nor what is pending goes by it.
    pub fn slot_is_free(&self, slot: SlotIndex) -> bool {
        self.shared.lock(|shared| {
            let motion = shared.motion.get();
            (motion.table().slot != slot || motion.is_silent_from(shared.next.get()))
                && shared.pending.get().is_none_or(|program| program.table.slot != slot)
        })
    }

    /// Writes a knot into a slot, if it is free.
    pub fn write_knot(&self, slot: SlotIndex, index: u16, knot: Knot) {
        if self.slot_is_free(slot) {
            self.slots.write(slot, index, knot);
        }
    }

    /// Begins a digest.
    pub fn start_digest(&self, window: DigestWindow) {
        self.shared.lock(|shared| shared.digest.set(DigestState::Waiting(window)));
    }

    /// Forgets the digest.
    pub fn drop_digest(&self) {
        self.shared.lock(|shared| shared.digest.set(DigestState::None));
    }

    /// How the digest stands.
    pub fn digest(&self) -> DigestState {
        self.shared.lock(|shared| shared.digest.get())
    }

    /// Waits for the renderer's tick, every [`TICK_BLOCKS`](crate::timing::TICK_BLOCKS) blocks.
    pub async fn tick(&self) {
        self.tick.wait().await;
    }

    /// The link's sign of life.
    pub fn pulse_link(&self) {
        let [_, link, _] = &self.pulses;
        link.fetch_add(1, Ordering::Relaxed);
    }

    /// Safety's sign of life.
    pub fn pulse_safety(&self) {
        let [_, _, safety] = &self.pulses;
        safety.fetch_add(1, Ordering::Relaxed);
    }

    // ---- what the renderer's half does ---------------------------------------------------------------------

    /// Sets the index of the first block.
    pub fn begin_at(&self, index: SampleIndex) {
        self.shared.lock(|shared| {
            shared.next.set(index);
            shared.fed_at.set(index);
        });
    }

    /// Takes the orders for the block at `index`, and moves the index on: what is published from now on begins later.
    pub(crate) fn begin_block(&self, index: SampleIndex) -> Orders {
        let [renderer, _, _] = &self.pulses;
        renderer.fetch_add(1, Ordering::Relaxed);
        self.shared.lock(|shared| {
            shared.next.set(index.saturating_add(BLOCK_SAMPLES));
            let due = shared.pending_at.get().is_some_and(|at| at <= index);
            let program = if due { shared.pending.get() } else { None };
            if due {
                shared.set_pending(None);
            }
            Orders {
                program,
                stop: shared.stop.take(),
                armed: shared.armed.get(),
                ready_at: shared.ready_at.get(),
                fed_at: shared.fed_at.get(),
                limit_per_mille: shared.limit_per_mille.get(),
            }
        })
    }

    /// Publishes the motion from this block on.
    pub(crate) fn moved(&self, motion: Motion) {
        self.shared.lock(|shared| {
            shared.motion.set(motion);
            shared.changes.set(shared.changes.get().wrapping_add(1));
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
        self.shared.lock(|shared| {
            shared.armed.set(false);
            shared.set_pending(None);
            if let Some((fault, at)) = fault {
                shared.faults.set(shared.faults.get().with(fault, at));
            }
        });
    }

    /// Wakes the link's half.
    pub(crate) fn signal_tick(&self) {
        self.tick.signal(());
    }
}

#[cfg(test)]
mod tests;
