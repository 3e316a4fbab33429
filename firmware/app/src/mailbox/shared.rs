//! What both sides share under the mailbox's one lock, and which of its two motions is in force.

use core::cell::Cell;

use slipline_protocol::event::Fault;
use slipline_protocol::units::SampleIndex;

use super::hand::Hand;
use super::listening::Listening;
use super::{Pending, Report, Stop};
use crate::digest::DigestState;
use crate::motion::outline::Outline;
use crate::safety::faults::FaultLatch;

/// The lease of a device that was armed without one.
pub(super) const NO_LEASE: u64 = u64::MAX;

/// The state under the lock.
pub(super) struct Shared {
    pub(super) next: Cell<SampleIndex>,
    /// The outlines of the two motions, in force and pending.
    pub(super) outlines: [Cell<Outline>; 2],
    /// Which of the two motions is in force; the other one is pending or spare.
    pub(super) live: Cell<Which>,
    /// Number of changes of the motion in force.
    pub(super) changes: Cell<u32>,
    /// The renderer is writing the trajectories of the motion in force.
    pub(super) is_fading: Cell<bool>,
    /// The thread side is writing the trajectories of the spare motion.
    pub(super) is_publishing: Cell<bool>,
    /// The pending program. Its motion stands in the slot that is not in force.
    pub(super) pending: Cell<Option<Pending>>,
    /// Where the last motion began that had waited for the trigger input.
    pub(super) began: Cell<Option<SampleIndex>>,
    pub(super) stop: Cell<Option<Stop>>,
    /// Whether the ramp of `stop` may begin in the block that was rendered last.
    pub(super) may_revise: Cell<bool>,
    /// Where the last stop at once takes effect.
    pub(super) stopped_at: Cell<SampleIndex>,
    pub(super) armed: Cell<bool>,
    /// Whether the amplifier stays muted while the device is armed.
    pub(super) on_bench: Cell<bool>,
    pub(super) ready_at: Cell<SampleIndex>,
    pub(super) fed_at: Cell<SampleIndex>,
    /// Where the user's last drive began, or the device was armed.
    pub(super) drive_began: Cell<SampleIndex>,
    /// How long the device stays armed without a drive, in samples; [`NO_LEASE`] for ever.
    pub(super) lease: Cell<u64>,
    /// The index at which that is over.
    pub(super) lease_ends: Cell<SampleIndex>,
    pub(super) limit_per_mille: Cell<Option<u16>>,
    pub(super) report: Cell<Report>,
    pub(super) faults: Cell<FaultLatch>,
    pub(super) hand: Cell<Hand>,
    pub(super) digest: Cell<DigestState>,
    pub(super) listening: Listening,
}

/// One of the two motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    First,
    Second,
}

impl Which {
    pub(super) const fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }

    /// Its element of a pair.
    pub(super) const fn of<T>(self, [first, second]: &[T; 2]) -> &T {
        match self {
            Self::First => first,
            Self::Second => second,
        }
    }
}

impl Shared {
    /// Silent, disarmed, at index 0.
    pub(super) const fn new() -> Self {
        Self {
            next: Cell::new(0),
            outlines: [const { Cell::new(Outline::SILENT) }; 2],
            live: Cell::new(Which::First),
            changes: Cell::new(0),
            is_fading: Cell::new(false),
            is_publishing: Cell::new(false),
            pending: Cell::new(None),
            began: Cell::new(None),
            stop: Cell::new(None),
            may_revise: Cell::new(false),
            stopped_at: Cell::new(0),
            armed: Cell::new(false),
            on_bench: Cell::new(false),
            ready_at: Cell::new(0),
            fed_at: Cell::new(0),
            drive_began: Cell::new(0),
            lease: Cell::new(NO_LEASE),
            lease_ends: Cell::new(NO_LEASE),
            limit_per_mille: Cell::new(None),
            report: Cell::new(Report::SILENT),
            faults: Cell::new(FaultLatch::new()),
            hand: Cell::new(Hand { since: None, last: None }),
            digest: Cell::new(DigestState::None),
            listening: Listening::new(),
        }
    }

    /// The outline of the motion in force.
    pub(super) fn outline(&self) -> Outline {
        self.live.get().of(&self.outlines).get()
    }

    /// Whether the device is armed with the amplifier muted.
    pub(super) fn is_on_bench(&self) -> bool {
        self.armed.get() && self.on_bench.get()
    }

    /// Whether what is pending waits for the trigger input.
    pub(super) fn waits(&self) -> bool {
        self.pending.get().is_some_and(|pending| pending.waits)
    }

    pub(super) fn count_change(&self) {
        self.changes.set(self.changes.get().wrapping_add(1));
    }

    /// The pending motion, which has waited for the trigger input, begins at an index. It was planned from tones that do
    /// not move any more, so all of it holds there, too.
    ///
    /// Never inlined: it would cost every other block time, too.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_waiting(&self, index: SampleIndex) {
        let outline = self.live.get().other().of(&self.outlines);
        outline.set(outline.get().starting_at(index));
        self.began.set(Some(index));
    }

    /// A drive of the user's begins at an index, and with it drive time and lease.
    pub(super) fn begin_drive(&self, index: SampleIndex) {
        self.drive_began.set(index);
        self.lease_ends.set(index.saturating_add(self.lease.get()));
    }

    pub(super) fn disarm_now(&self, fault: Option<(Fault, SampleIndex)>) {
        self.armed.set(false);
        self.pending.set(None);
        // A drive that is being planned right now was for an armed device: it must not be published any more.
        self.count_change();
        if let Some((fault, at)) = fault {
            self.faults.set(self.faults.get().with(fault, at));
        }
    }
}
