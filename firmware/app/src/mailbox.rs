//! The mailbox between thread side and interrupt side: all state that both use.
//!
//! ```text
//! thread side (link, controller)      Mailbox                     interrupt side (renderer)
//!   publish(motion) ----------->   pending, at its start   ---->  begin_block() -> Orders, place()
//!   publish_waiting(motion) --->   pending, at the trigger ---->
//!   stop(kind), arm(), feed() -->  stop, armed, fed        ---->
//!   stop_at_once(kind)       -->  wakes it                ---->  revised(), stop_in_last_block()
//!   view(), pulses()         <---  motion, report, faults  <----  end_block(Report), fade(), disarm_now()
//!   write_knot(slot, knot)   --->  table slots             ---->  evaluate
//!   start_measurement() ...  --->  listening               <--->  take_listen_orders(), set_reading() ...
//! ```
//! State that must agree lies under one lock, which on a board masks all interrupts. So nothing long happens under it: it
//! guards copies of a few words. The renderer's index moves on under that lock, so what is published for the next block
//! begins at the next block, exactly.
//!
//! The sixteen trajectories of a motion are too many for that. There are two motions, each with one writer at a time,
//! and the lock guards only which of them is in force:
//! - The motion *in force* is read and written by the interrupt side alone. It writes when it begins a ramp to silence:
//!   `is_fading` is set before and reset after, together with a new count of changes. [`Mailbox::view`] copies the
//!   motion without the lock and compares the count before and after: if it differs or a ramp is being written, it
//!   copies again (a sequence lock).
//! - The *spare* motion is written by the thread side alone, and only while none is pending. The interrupt side does not
//!   read it before it is pending: then it swaps the two under the lock.
//!
//! A reader that has seen any part of a ramp finds `is_fading` or the new count afterwards: the writer took the lock
//! before its first store, and had the reader's second look come before that, its loads would have happened before the
//! stores and could not have seen them.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

mod course;
mod hand;
mod interrupt_side;
mod listening;
mod orders;
mod pending;
mod publish;
mod pulses;
mod report;
mod shared;
mod stop;
mod stopping;
mod view;

use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use slipline_protocol::command::DigestWindow;
use slipline_protocol::event::{Fault, Faults};
use slipline_protocol::table::Knot;
use slipline_protocol::units::SampleIndex;

pub use self::course::Course;
pub use self::hand::Hand;
pub use self::listening::{CaptureReport, Inputs, MeasurementReport};
pub(crate) use self::listening::{ListenOrders, Order};
pub use self::orders::Orders;
pub use self::pending::Pending;
pub use self::publish::NotPublished;
pub use self::pulses::Pulses;
pub use self::report::Report;
use self::shared::{NO_LEASE, Shared};
pub use self::stop::Stop;
pub use self::view::View;
use crate::digest::DigestState;
use crate::motion::cell::MotionCell;
use crate::safety::faults::FaultLatch;
use crate::slots::{SlotIndex, TableSlots};
use crate::timing::{BLOCK_SAMPLES, SETTLE_BLOCKS};

/// A [`View`] without its motion.
struct Moment {
    next: SampleIndex,
    pending: Option<Pending>,
    stopping: bool,
    armed: bool,
    ready_at: SampleIndex,
    report: Report,
    faults: FaultLatch,
}

/// The state that both sides share: a `static` in a firmware, an `Arc` in a host.
pub struct Mailbox<M: RawMutex> {
    shared: Mutex<M, Shared>,
    motions: [MotionCell; 2],
    slots: TableSlots,
    tick: Signal<M, ()>,
    /// Wakes the renderer between two blocks.
    stopped: Signal<M, ()>,
    pulses: [AtomicU32; 3],
}

impl<M: RawMutex> Default for Mailbox<M> {
    fn default() -> Self {
        Self::new()
    }
}

impl<M: RawMutex> Mailbox<M> {
    /// Silent, disarmed, at index 0.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            shared: Mutex::new(Shared::new()),
            motions: [const { MotionCell::silent() }; 2],
            slots: TableSlots::new(),
            tick: Signal::new(),
            stopped: Signal::new(),
            pulses: [const { AtomicU32::new(0) }; 3],
        }
    }

    /// As [`Mailbox::new`], in its place: the table slots alone would take more stack than a small chip has.
    #[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
    #[inline(never)]
    pub fn new_in(place: &mut MaybeUninit<Self>) -> &mut Self {
        let at = place.as_mut_ptr();
        // SAFETY: every field is written. The slots consist of atomics, of which any bits are a value; zeros are empty slots, as in
        // `TableSlots::new`.
        unsafe {
            (&raw mut (*at).shared).write(Mutex::new(Shared::new()));
            (&raw mut (*at).motions).write([const { MotionCell::silent() }; 2]);
            (&raw mut (*at).slots).write_bytes(0, 1);
            (&raw mut (*at).tick).write(Signal::new());
            (&raw mut (*at).stopped).write(Signal::new());
            (&raw mut (*at).pulses).write([const { AtomicU32::new(0) }; 3]);
            place.assume_init_mut()
        }
    }

    /// The first index that is not rendered yet.
    pub fn now(&self) -> SampleIndex {
        self.shared.lock(|shared| shared.next.get())
    }

    /// Whether it is armed, and the faults: a part of [`Mailbox::view`] that costs little.
    pub fn standing(&self) -> (bool, FaultLatch) {
        self.shared.lock(|shared| (shared.armed.get(), shared.faults.get()))
    }

    /// Whether a motion waits for the trigger input, and where the last one began that had waited.
    pub fn trigger(&self) -> (bool, Option<SampleIndex>) {
        self.shared.lock(|shared| (shared.waits(), shared.began.get()))
    }

    /// The table slots.
    pub const fn slots(&self) -> &TableSlots {
        &self.slots
    }

    /// How often each task has run.
    pub fn pulses(&self) -> Pulses {
        let [renderer, link, safety] = &self.pulses;
        let read = |pulse: &AtomicU32| pulse.load(Ordering::Relaxed);
        Pulses { renderer: read(renderer), link: read(link), safety: read(safety) }
    }

    /// A consistent copy. Not for an interrupt above the renderer's: it would wait for ever for the renderer to go on.
    pub fn view(&self) -> View {
        loop {
            let Some((live, outline, changes)) = self.shared.lock(|shared| {
                (!shared.is_fading.get()).then(|| (shared.live.get(), shared.outline(), shared.changes.get()))
            }) else {
                // On a host with true parallelism only: the renderer is never interrupted by this side.
                core::hint::spin_loop();
                continue;
            };
            let motion = live.of(&self.motions).load(outline);
            let rest = self.shared.lock(|shared| {
                (!shared.is_fading.get() && shared.changes.get() == changes).then(|| Moment {
                    next: shared.next.get(),
                    pending: shared.pending.get(),
                    stopping: shared.stop.get().is_some() || shared.report.get().stopping,
                    armed: shared.armed.get(),
                    ready_at: shared.ready_at.get(),
                    report: shared.report.get(),
                    faults: shared.faults.get(),
                })
            });
            if let Some(Moment { next, pending, stopping, armed, ready_at, report, faults }) = rest {
                return View { next, motion, changes, pending, stopping, armed, ready_at, report, faults };
            }
            // The motion became another one meanwhile. That happens a few times at most: a motion begins, a ramp
            // begins, and a new motion would have to come from this side.
        }
    }

    /// Unmutes; drives may begin at the index returned, after some blocks of mid-scale. Starts the dead-man's
    /// time. Has no lease, unless the device is armed.
    pub fn arm(&self) -> SampleIndex {
        self.arm_as(false)
    }

    /// As [`Mailbox::arm`], but the amplifier stays muted until the device is disarmed.
    pub fn bench(&self) -> SampleIndex {
        self.arm_as(true)
    }

    /// Whether the device was armed by [`Mailbox::bench`].
    pub fn is_on_bench(&self) -> bool {
        self.shared.lock(Shared::is_on_bench)
    }

    fn arm_as(&self, on_bench: bool) -> SampleIndex {
        self.shared.lock(|shared| {
            let next = shared.next.get();
            if !shared.armed.get() {
                shared.ready_at.set(next.saturating_add(SETTLE_BLOCKS * BLOCK_SAMPLES));
                shared.armed.set(true);
                shared.on_bench.set(on_bench);
                shared.drive_began.set(next);
                shared.lease.set(NO_LEASE);
                shared.lease_ends.set(NO_LEASE);
            }
            shared.fed_at.set(next);
            shared.ready_at.get()
        })
    }

    /// Disarms the device `lease` samples from now, or after each drive that begins before that.
    pub fn lease(&self, lease: u64) {
        self.shared.lock(|shared| {
            shared.lease.set(lease);
            shared.lease_ends.set(shared.next.get().saturating_add(lease));
        });
    }

    /// Where the user's last drive began, or the device was armed after that.
    pub fn drive_began(&self) -> SampleIndex {
        self.shared.lock(|shared| shared.drive_began.get())
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

    /// Latches a fault at the present index.
    pub fn latch(&self, fault: Fault) {
        self.shared.lock(|shared| shared.faults.set(shared.faults.get().with(fault, shared.next.get())));
    }

    /// Clears all faults but those in `standing`.
    pub fn clear_faults(&self, standing: Faults) {
        self.shared.lock(|shared| shared.faults.set(shared.faults.get().cleared(standing)));
    }

    /// Sets the thermal fold-back factor (per mille). The first applies at once; later ones at the next period, slewed.
    pub fn set_limit(&self, per_mille: u16) {
        self.shared.lock(|shared| shared.limit_per_mille.set(Some(per_mille)));
    }

    /// Whether a slot may be written: neither the motion in force nor the pending one uses it.
    pub fn slot_is_free(&self, slot: SlotIndex) -> bool {
        self.shared.lock(|shared| {
            let outline = shared.outline();
            (outline.table.slot != slot || outline.is_silent_from(shared.next.get()))
                && shared.pending.get().is_none_or(|pending| pending.slot != slot)
        })
    }

    /// Writes a knot into a slot if it is free, and returns whether it was.
    pub fn write_knot(&self, slot: SlotIndex, index: u16, knot: Knot) -> bool {
        let is_free = self.slot_is_free(slot);
        if is_free {
            self.slots.write(slot, index, knot);
        }
        is_free
    }

    /// Begins a digest if `may_start` says so of the next index and of how the last digest stands. One step, so that
    /// the window has not begun when the renderer sees it.
    ///
    /// # Errors
    /// What `may_start` says.
    pub fn start_digest<T, E>(
        &self,
        window: DigestWindow,
        may_start: impl FnOnce(SampleIndex, DigestState) -> Result<T, E>,
    ) -> Result<T, E> {
        self.shared.lock(|shared| {
            let started = may_start(shared.next.get(), shared.digest.get())?;
            shared.digest.set(DigestState::Waiting(window));
            Ok(started)
        })
    }

    /// Forgets the digest.
    pub fn drop_digest(&self) {
        self.shared.lock(|shared| shared.digest.set(DigestState::None));
    }

    /// State of the digest.
    pub fn digest(&self) -> DigestState {
        self.shared.lock(|shared| shared.digest.get())
    }

    /// Waits for the renderer's tick, every [`TICK_BLOCKS`](crate::timing::TICK_BLOCKS) blocks.
    pub async fn tick(&self) {
        self.tick.wait().await;
    }

    /// Counts a turn of the link's loop.
    pub fn pulse_link(&self) {
        let [_, link, _] = &self.pulses;
        link.fetch_add(1, Ordering::Relaxed);
    }

    /// Counts a tick of the safety checks.
    pub fn pulse_safety(&self) {
        let [_, _, safety] = &self.pulses;
        safety.fetch_add(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests;
