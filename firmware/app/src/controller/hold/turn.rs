//! One turn of the hold: at the end of a window, new levels from the measured amplitudes.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_dds::bank::TONES;
use slipline_dds::lock_in::{self, Window};
use slipline_protocol::hold::HoldProgress;
use slipline_protocol::limits::HOLD_PAUSE_BLOCKS;
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::SampleIndex;

use super::{Controller, Holding};
use crate::controller::drive::publish;
use crate::listening::hold::{Answers, HoldAction, Levels, Limit, Octaves, Room, amplitude};
use crate::mailbox::{Course, Mailbox};
use crate::ports::{FlashPages, System};
use crate::timing::BLOCK_SAMPLES;

/// Blocks after a window's last sample until it counts as broken: the inputs have stopped.
const PATIENCE_BLOCKS: u64 = 64;

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// Takes a window of the hold that is over. Calls `is_stopped` repeatedly, since this takes as long as a drive.
    ///
    /// Neither this nor its callees are inlined: they would lie on the stack under every command.
    #[inline(never)]
    pub(in crate::controller) fn turn_hold<M: RawMutex>(
        &mut self,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) {
        self.refresh_hold(mailbox);
        if !self.holding.is_on() {
            return;
        }
        let mut step = self.take_window(is_stopped, mailbox);
        while let Some(HoldAction::Publish(levels)) = step {
            let published = self.publish_levels(&levels, is_stopped, mailbox);
            step = self.answer_proposal(published);
        }
        if self.holding.is_on() && self.holding.hold.is_over() {
            self.holding.progress = HoldProgress::Lost;
            mailbox.drop_measurement();
        }
    }

    /// What follows from a window that is over; `None` while it is under way.
    #[inline(never)]
    fn take_window<M: RawMutex>(
        &mut self,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Option<HoldAction> {
        let course = mailbox.course();
        let answers = self.holding.answers(course.next, is_stopped, mailbox)?;
        if self.holding.begin_window(mailbox).is_err() {
            self.end_hold(mailbox);
            return None;
        }
        let room = self.holding.room(&course, self.thermal.limit_per_mille());
        Some(self.holding.hold.take(answers.as_ref(), room))
    }

    /// The rest to publish after the levels were published or refused.
    fn answer_proposal(&mut self, published: Result<SampleIndex, Refusal>) -> Option<HoldAction> {
        let hold = &mut self.holding.hold;
        match published {
            Ok(at) => {
                hold.accepted();
                self.holding.published = Some(at);
                None
            }
            Err(Refusal::Headroom { .. }) => Some(hold.refused(Limit::Headroom)),
            Err(Refusal::Travel { .. }) => Some(hold.refused(Limit::Travel)),
            // A stop has come, or the last levels are not in force yet: the next window proposes again.
            Err(_) => {
                hold.dropped();
                None
            }
        }
    }

    /// Hands new levels over as a drive, but only while the motion in force is the hold's own. It does not count as an act of
    /// the user.
    ///
    /// Never inlined: the motion would lie on the stack under the whole turn.
    #[inline(never)]
    pub(super) fn publish_levels<M: RawMutex>(
        &self,
        levels: &Levels,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        let (changes, glide) = (self.holding.changes, self.holding.hold.glide());
        let published = publish(mailbox, &self.lead, Mailbox::publish_levels, |view, lead| {
            self.refuse_unless_armed(view.armed, view.faults)?;
            if view.pending.is_some() {
                return Err(Refusal::Busy(Busy::CommitPending));
            }
            if view.changes != changes || view.motion.ends_silent() {
                return Err(Refusal::Busy(Busy::DriveActive));
            }
            let at = view.next.saturating_add(lead);
            let motion = self.planner(mailbox, is_stopped).levels(levels, at, glide, &view.motion)?;
            self.check_motion(&motion, false, mailbox)?;
            Ok(motion)
        })?;
        Ok(published.at)
    }
}

impl Holding {
    /// The answers of a window that is over: `Some(None)` if it broke or never ended. `None` while it is under way, or if a stop
    /// has come.
    fn answers<M: RawMutex>(
        &mut self,
        next: SampleIndex,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Option<Option<Answers>> {
        let measurement = mailbox.measurement();
        let length =
            BLOCK_SAMPLES.saturating_mul(u64::from(self.window.blocks).saturating_add(PATIENCE_BLOCKS));
        match measurement.state {
            lock_in::State::Finished => {}
            lock_in::State::Measuring if next < self.window.begin.saturating_add(length) => return None,
            lock_in::State::Measuring | lock_in::State::Broken { .. } | lock_in::State::Idle => {
                return Some(None);
            }
        }
        let input = usize::from(self.input);
        let Some(span) = measurement.spans.get(input).copied().flatten() else { return Some(None) };
        let mut amplitudes = [None; TONES];
        for (slot, (measured, last)) in amplitudes.iter_mut().zip(&mut self.amplitudes).enumerate() {
            let answer = mailbox.answer(&measurement, input, slot);
            *measured = answer.and_then(|answer| amplitude(answer, measurement.weight));
            *last = measured.unwrap_or(0);
            if is_stopped() {
                return None;
            }
        }
        Some(Some(Answers { span, amplitudes }))
    }

    /// Orders the next window.
    fn begin_window<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<(), lock_in::StartError> {
        let blocks = u64::from(self.window.blocks).saturating_add(HOLD_PAUSE_BLOCKS.into());
        let due = self.window.begin.saturating_add(BLOCK_SAMPLES.saturating_mul(blocks));
        self.windows = self.windows.saturating_add(1);
        self.window.begin = mailbox.start_measurement(|next| {
            let window = Window { begin: due.max(next), ..self.window };
            window.check(next).map(|()| window)
        })?;
        Ok(())
    }

    /// The rise that is allowed now: none while the fold-back works, whose report lags behind the model of the coil.
    fn room(&self, course: &Course, limit_per_mille: u16) -> Room {
        if limit_per_mille.min(course.foldback_per_mille) < 1000 {
            return Room { rise: Octaves::NONE, limit: Limit::Thermal };
        }
        let levels = self.hold.levels();
        let amplitudes =
            levels.iter().zip(&self.gains).filter_map(|(level, gain)| Some(gain.times((*level)?).0));
        Room::in_headroom(amplitudes.map(u64::from).sum(), self.others)
    }
}
