//! Arming and driving: makes motions and hands them over.

use core::cell::Cell;

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::command::{Apply, ArmLease, Chord, Comb, Drive};
use slipline_protocol::event::{Accepted, AcceptedUntil, Event, Fault};
use slipline_protocol::limits;
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::units::SampleIndex;

use super::Controller;
use crate::mailbox::View;
use crate::mailbox::{Mailbox, NotPublished};
use crate::motion::Motion;
use crate::planning::plan::Planner;
use crate::ports::{FlashPages, SampleClock, StopInput, System, UserButton};
use crate::range::{in_range, within};
use crate::safety::faults::FaultLatch;
use crate::timing::{BLOCK_SAMPLES, block_at_or_after};

/// How many blocks later each further attempt to publish a program begins at least, should planning take longer than a block.
const LEADS: [u64; 6] = [0, 1, 2, 4, 16, LONGEST_LEAD];
const LONGEST_LEAD: u64 = 64;

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// `on_bench`: the amplifier stays muted.
    pub(super) fn arm<M: RawMutex>(
        &mut self,
        on_bench: bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        if self.is_stopped_on_the_desk() {
            mailbox.latch(Fault::DeskStop);
        }
        let view = mailbox.view();
        self.refuse_if_unfit(view.faults)?;
        if view.armed {
            if mailbox.is_on_bench() != on_bench {
                return Err(Refusal::Armed);
            }
            return Ok(view.ready_at.max(view.next));
        }
        // Only a table swap can be pending while disarmed, and it makes no sound.
        if !view.report.silent || view.stopping {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        Ok(if on_bench { mailbox.bench() } else { mailbox.arm() })
    }

    pub(super) fn arm_for<M: RawMutex>(
        &mut self,
        ArmLease { lease_ms }: ArmLease,
        on_bench: bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        within(Field::Lease, limits::LEASE_MS, lease_ms)?;
        let ready = self.arm(on_bench, mailbox)?;
        // In an armed device only the lease restarts: the longest drive counts from the user's own drive.
        mailbox.lease(self.timing.samples(lease_ms));
        Ok(ready)
    }

    /// Whether the user holds the button, or the stop input is open.
    pub(super) fn is_stopped_on_the_desk(&self) -> bool {
        let board = self.system.board();
        board.user_button == UserButton::Pressed || board.stop_input == StopInput::Open
    }

    pub(super) fn refuse_unless_armed(&self, armed: bool, faults: FaultLatch) -> Result<(), Refusal> {
        self.refuse_if_unfit(faults)?;
        if armed { Ok(()) } else { Err(Refusal::NotArmed) }
    }

    fn refuse_if_unfit(&self, faults: FaultLatch) -> Result<(), Refusal> {
        if self.boot.safe_mode {
            return Err(Refusal::SafeMode);
        }
        if self.system.board().sample_clock == SampleClock::Internal {
            return Err(Refusal::NoClock);
        }
        let faults = faults.set();
        if faults.is_empty() { Ok(()) } else { Err(Refusal::Faulted { faults }) }
    }

    /// The planner with this device's tables and times.
    pub(super) fn planner<'a, M: RawMutex>(
        &'a self,
        mailbox: &'a Mailbox<M>,
        is_stopped: &'a mut dyn FnMut() -> bool,
    ) -> Planner<'a> {
        Planner { slots: mailbox.slots(), timing: &self.timing, is_stopped }
    }

    /// Never inlined: its motions would lie on the stack under every other command, and under the level hold.
    #[inline(never)]
    pub(super) fn drive<M: RawMutex>(
        &mut self,
        drive: &Drive,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<AcceptedUntil, Refusal> {
        self.refuse_unless_drivable(drive.glide, drive.apply, mailbox)?;
        if is_stopped() {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        let published = publish(mailbox, &self.lead, hand_over(drive.apply), |view, lead| {
            self.refuse_unless_armed(view.armed, view.faults)?;
            let at = self.begin(drive.apply, view.next.max(view.ready_at), view, lead)?;
            let motion = self.planner(mailbox, is_stopped).drive(drive, at, self.active, &view.motion)?;
            self.check_motion(&motion, false, mailbox)?;
            Ok(motion)
        })?;
        self.end_hold(mailbox);
        self.holding.forget_drive();
        Ok(published)
    }

    /// Never inlined: a chord's tones would lie on the stack under every other command.
    #[inline(never)]
    pub(super) fn chord<M: RawMutex>(
        &mut self,
        chord: &Chord,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        self.refuse_unless_drivable(chord.glide, chord.apply, mailbox)?;
        let planner = Planner { slots: mailbox.slots(), timing: &self.timing, is_stopped };
        planner.place_chord(chord, self.active, &mut self.candidate.tones)?;
        refuse_unless_fading(mailbox)?;
        self.candidate.check(self.bounds.ceiling(), is_stopped)?;
        self.rise(chord.glide, chord.apply, true, is_stopped, mailbox)
    }

    /// Never inlined, as [`Controller::chord`].
    #[inline(never)]
    pub(super) fn comb<M: RawMutex>(
        &mut self,
        comb: &Comb,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        self.refuse_unless_drivable(comb.glide, comb.apply, mailbox)?;
        let planner = Planner { slots: mailbox.slots(), timing: &self.timing, is_stopped };
        planner.place_comb(comb, self.active, &mut self.candidate.tones)?;
        refuse_unless_fading(mailbox)?;
        self.rise(comb.glide, comb.apply, false, is_stopped, mailbox)
    }

    /// Lets the candidate's tones rise from silence; `is_proven`: their peak is known to be within the bounds.
    fn rise<M: RawMutex>(
        &mut self,
        glide: u32,
        apply: Apply,
        is_proven: bool,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        let AcceptedUntil { at, .. } = publish(mailbox, &self.lead, hand_over(apply), |view, lead| {
            self.refuse_unless_armed(view.armed, view.faults)?;
            let mut earliest = view.next.max(view.ready_at);
            if view.motion.ends_silent() && !view.motion.is_silent_from(earliest) {
                // What sounds fades already: they begin where that ends.
                earliest = block_at_or_after(view.motion.end());
            }
            let at = self.begin(apply, earliest, view, lead)?;
            let mut planner = self.planner(mailbox, is_stopped);
            let motion = planner.chord(&self.candidate.tones, at, glide, self.active, &view.motion)?;
            self.check_motion(&motion, is_proven, mailbox)?;
            Ok(motion)
        })?;
        self.end_hold(mailbox);
        self.holding.forget_drive();
        Ok(at)
    }

    fn refuse_unless_drivable<M: RawMutex>(
        &self,
        glide: u32,
        apply: Apply,
        mailbox: &Mailbox<M>,
    ) -> Result<(), Refusal> {
        // Before anything else, and again at each attempt, because the renderer may disarm at any moment.
        let (armed, faults) = mailbox.standing();
        self.refuse_unless_armed(armed, faults)?;
        self.excursion.check_glide(glide, &self.timing)?;
        self.bounds.travel.check_glide(glide, &self.timing)?;
        if apply == Apply::AtTrigger && !self.system.has_trigger_input() {
            return Err(Refusal::NotSupported);
        }
        Ok(())
    }

    /// Where a change begins that may begin from `earliest` on, `lead` samples later if nobody asks for an index.
    fn begin(
        &self,
        apply: Apply,
        earliest: SampleIndex,
        view: &View,
        lead: u64,
    ) -> Result<SampleIndex, Refusal> {
        Ok(match apply {
            Apply::Next => earliest.saturating_add(lead),
            Apply::At(at) => {
                let latest = view.next.saturating_add(self.timing.max_apply_ahead);
                in_range(Field::ApplyAt, earliest, latest, at)?;
                block_at_or_after(at)
            }
            // At the end of the glide under way: nothing moves after it, so the plan holds at every later index.
            Apply::AtTrigger if view.motion.is_silent_from(earliest) => earliest.saturating_add(lead),
            Apply::AtTrigger => block_at_or_after(earliest.max(view.motion.end())).saturating_add(lead),
        })
    }
}

/// Refuses unless what sounds fades, or nothing sounds. Never inlined: the copy would stay on the stack.
#[inline(never)]
fn refuse_unless_fading<M: RawMutex>(mailbox: &Mailbox<M>) -> Result<(), Refusal> {
    if mailbox.view().motion.ends_silent() { Ok(()) } else { Err(Refusal::Busy(Busy::DriveActive)) }
}

/// The answer to a drive that orders a glide of `glide` samples. It states the end of the glide if the device makes it longer.
pub(super) const fn answer(published: AcceptedUntil, glide: u32) -> Event {
    let AcceptedUntil { at, until } = published;
    if until > at.saturating_add(glide as u64) {
        return Event::AcceptedUntil(published);
    }
    Event::Accepted(Accepted { at })
}

/// How a motion is handed over.
type HandOver<M> = fn(&Mailbox<M>, &Motion, &View) -> Result<(), NotPublished>;

fn hand_over<M: RawMutex>(apply: Apply) -> HandOver<M> {
    match apply {
        Apply::AtTrigger => Mailbox::publish_waiting,
        Apply::Next | Apply::At(_) => Mailbox::publish,
    }
}

/// Makes a motion and publishes it; repeats with a later index if the renderer was faster.
///
/// `lead` remembers how many blocks the last attempt took: the next one begins so much later, and fails only if it takes longer,
/// for a failed attempt costs more time than that. It falls by a block with each program that takes less, to one block. Where
/// planning takes no time it stays 0.
///
/// Replaces a motion that waits for the trigger input, or one of the level hold, by the motion that `make` returns. Where that
/// begins and ends is returned.
pub(super) fn publish<M: RawMutex>(
    mailbox: &Mailbox<M>,
    lead: &Cell<u64>,
    hand_over: impl Fn(&Mailbox<M>, &Motion, &View) -> Result<(), NotPublished>,
    mut make: impl FnMut(&View, u64) -> Result<Motion, Refusal>,
) -> Result<AcceptedUntil, Refusal> {
    for least in LEADS {
        let view = mailbox.view();
        if view.stopping {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        if !view.has_room() {
            break;
        }
        let motion = make(&view, least.max(lead.get()).saturating_mul(BLOCK_SAMPLES))?;
        let handed_over = hand_over(mailbox, &motion, &view);
        let taken = mailbox.now().saturating_sub(view.next).checked_div(BLOCK_SAMPLES).unwrap_or(0);
        lead.set(taken.max(lead.get().saturating_sub(1)).clamp(lead.get().min(1), LONGEST_LEAD));
        match handed_over {
            Ok(()) => return Ok(AcceptedUntil { at: motion.start(), until: motion.end() }),
            Err(NotPublished::Pending) => break,
            Err(NotPublished::Late) => {}
        }
    }
    Err(Refusal::Busy(Busy::CommitPending))
}
