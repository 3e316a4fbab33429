//! The level hold: the host's orders, and the turn of the loop at the end of each window.
//!
//! ```text
//! tick --window over--> answers, room --> Hold --levels--> Planner --> travel --> Mailbox::publish
//!  |                                       ^                 |           |              |
//!  |                                       +---- refused ----+-----------+   accepted --+
//!  +-- what sounds is not the hold's own any more --> it has ended
//! ```
//! A window is over some blocks after its last sample; the tick detects that, so a turn runs on the thread side, where it
//! checks for a stop. The motion in force is the hold's own as long as nothing but the hold has changed it: the mailbox counts
//! the changes. So a stop, a fault or a lost host ends the hold without a message to it. The renderer does not know of the hold.

mod turn;

use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::Vec;
use slipline_dds::bank::TONES;
use slipline_dds::lock_in::{Shape, Window};
use slipline_protocol::Event;
use slipline_protocol::hold::{self as wire, Held, HoldProgress, HoldSetting};
use slipline_protocol::limits::{HELD_AMPLITUDE, HOLD_PAUSE_BLOCKS, MAX_AT_RISE_MS, MAX_HOLD_CDB, MAX_TONES};
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::units::{CentiDecibel, Gain, SampleIndex};

use super::Controller;
use super::listening::{check_input, existing};
use crate::listening::hold::{Hold, Limit, LoopSetting, LoopState, Loss, Octaves, SettingError, ToneToHold};
use crate::mailbox::{Course, Mailbox};
use crate::ports::{FlashPages, System};
use crate::range::in_range;
use crate::timing::{BLOCK_SAMPLES, block_at_or_after};

/// Blocks that planning a drive takes at most while a hold has all lock-ins at work, on a board.
const HOLDING_LEAD: u64 = 4;
/// The highest slot.
const HIGHEST_SLOT: i64 = MAX_TONES as i64 - 1;

/// The hold that was ordered last.
#[derive(Clone, Debug)]
pub(super) struct Holding {
    progress: HoldProgress,
    input: u8,
    /// The window under way, or the last one.
    window: Window,
    windows: u32,
    hold: Hold,
    /// Amplitudes that the last window has measured, in 1/256 code.
    amplitudes: [u32; TONES],
    /// The factor of each slot's level, and the amplitudes of the slots that are not held, Q1.31.
    gains: [Gain; TONES],
    others: u64,
    /// The drive's level of each slot that a hold has had since that drive; 0 of the others. It outlives a hold that leaves its
    /// levels behind, so that the next one cannot rise from there.
    drive_levels: [Gain; TONES],
    /// The mailbox's count of changes when the motion in force was last the hold's own.
    changes: u32,
    /// The start of the levels that were published last, until they are in force.
    published: Option<SampleIndex>,
}

impl Holding {
    /// No hold was ordered.
    pub(super) const NONE: Self = Self {
        progress: HoldProgress::Off,
        input: 0,
        window: Window { begin: 0, blocks: 0, shape: Shape::Hann, slots: 0, input: None },
        windows: 0,
        hold: Hold::NONE,
        amplitudes: [0; TONES],
        gains: [Gain(0); TONES],
        others: 0,
        drive_levels: [Gain(0); TONES],
        changes: 0,
        published: None,
    };

    /// Forgets the levels of the drive before: a new one is accepted.
    pub(super) fn forget_drive(&mut self) {
        self.drive_levels.fill(Gain(0));
    }

    /// Forgets the hold.
    pub(super) const fn clear(&mut self) {
        self.progress = HoldProgress::Off;
    }

    /// Whether what sounds is the hold's own: the drive that it began with, or what it has published.
    fn is_undisturbed(&mut self, course: &Course) -> bool {
        if !course.armed || course.stopping || course.ends_silent {
            return false;
        }
        let Some(at) = self.published else { return course.changes == self.changes };
        let has_begun = course.changes == self.changes.wrapping_add(1) && course.start == at;
        if has_begun {
            self.changes = course.changes;
            self.published = None;
        }
        has_begun || (course.changes == self.changes && course.is_pending)
    }

    const fn is_on(&self) -> bool {
        matches!(self.progress, HoldProgress::On)
    }
}

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// Begins a hold, or ends the one that is on; returns the first sample of the first window, or the index from which the
    /// levels return to those of the drive.
    ///
    /// Never inlined: the loops of all tones would lie on the stack under every other command.
    #[inline(never)]
    pub(super) fn hold<M: RawMutex>(
        &mut self,
        asked: &HoldSetting,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        let inputs = existing(mailbox)?;
        self.refresh_hold(mailbox);
        if asked.tones.is_empty() {
            return self.release(is_stopped, mailbox);
        }
        check_input(asked.input, inputs)?;
        let (armed, faults) = mailbox.standing();
        self.refuse_unless_armed(armed, faults)?;
        self.refuse_if_holding()?;
        in_range(Field::LockIns, 1, inputs.lock_ins as u64, asked.tones.len() as u64)?;
        in_range(Field::TimeConstant, 0, self.timing.max_apply_ahead, asked.time_constant.into())?;
        let setting = self.setting(asked)?;
        self.hold_what_sounds(asked, &setting, mailbox)?;
        let window = self.holding.window;
        // A change since the view was taken ends the hold at the next tick, because `changes` is the view's.
        let begin = mailbox.start_measurement(|next| {
            let begin = window.begin.max(next);
            Ok::<_, Refusal>(Window { begin, ..window })
        })?;
        self.holding.window.begin = begin;
        self.holding.progress = HoldProgress::On;
        Ok(begin)
    }

    /// The loops' parameters.
    fn setting(&self, asked: &HoldSetting) -> Result<LoopSetting, Refusal> {
        let timing = &self.timing;
        let limits = [self.excursion.limit(), self.bounds.travel.limit()].into_iter().flatten();
        let shortest = limits.map(|limit| timing.shortest_glide(&limit)).max().unwrap_or(timing.min_glide);
        // The levels glide for half a period.
        let blocks = |glide: u32| u64::from(glide).saturating_mul(2).div_ceil(BLOCK_SAMPLES);
        let pause = u64::from(HOLD_PAUSE_BLOCKS);
        let least = blocks(shortest).saturating_sub(pause).max(1);
        let most = blocks(timing.max_glide).saturating_sub(pause).min(u16::MAX.into());
        in_range(Field::WindowBlocks, least, most, asked.blocks.into())?;
        let level = |field, least: i16, most: i16, asked: CentiDecibel| {
            Refusal::check(field, least.into(), most.into(), asked.0.into()).map(|()| octaves(asked))
        };
        let period = u64::from(asked.blocks).saturating_add(pause).saturating_mul(BLOCK_SAMPLES);
        Ok(LoopSetting {
            period: u32::try_from(period).unwrap_or(u32::MAX),
            tau: asked.time_constant,
            max_rise: level(Field::MaxRise, 0, self.bounds.max_rise_cdb(), asked.max_rise)?,
            at_rise: u32::try_from(timing.samples(MAX_AT_RISE_MS)).unwrap_or(u32::MAX),
            slew: level(Field::Slew, 1, MAX_HOLD_CDB, asked.slew)?,
        })
    }

    /// Prepares the hold of tones that sound or are gliding to their places.
    ///
    /// Never inlined: the view would lie on the stack under what comes after.
    #[inline(never)]
    fn hold_what_sounds<M: RawMutex>(
        &mut self,
        asked: &HoldSetting,
        setting: &LoopSetting,
        mailbox: &Mailbox<M>,
    ) -> Result<(), Refusal> {
        let view = mailbox.view();
        if view.stopping || view.is_silent() {
            return Err(Refusal::SilentTone { slot: asked.tones.first().map_or(0, |tone| tone.slot) });
        }
        if view.pending.is_some() {
            return Err(Refusal::Busy(Busy::CommitPending));
        }
        let end = view.motion.end().max(view.next);
        let places = view.motion.at(end, mailbox.slots());
        let mut tones: Vec<ToneToHold, MAX_TONES> = Vec::new();
        let mut slots = 0;
        for &wire::HoldTone { slot, amplitude } in &asked.tones {
            // A slot that does not exist is refused below, as one that is silent is.
            let sounding = places.get(usize::from(slot)).map_or(Gain::FULL, |place| place.level);
            let held_before = self.holding.drive_levels.get(usize::from(slot)).filter(|level| level.0 > 0);
            let level = *held_before.unwrap_or(&sounding);
            // There is room: the firmware requests just as many.
            let _ = tones.push(ToneToHold { slot, amplitude, level, sounding });
            slots |= 1_u16.checked_shl(slot.into()).unwrap_or(0);
        }
        let holding = &mut self.holding;
        holding.hold.set(setting, &tones, self.timing.min_glide).map_err(refusal)?;
        for tone in &tones {
            if let Some(level) = holding.drive_levels.get_mut(usize::from(tone.slot)) {
                *level = tone.level;
            }
        }
        // After a refusal the last hold can still be read.
        holding.others = 0;
        for ((slot, place), gain) in places.iter().enumerate().zip(&mut holding.gains) {
            *gain = place.setting.gain;
            if holding.hold.state(slot).is_none() {
                // Sixteen 32-bit numbers: far from the end of 64 bits.
                holding.others = holding.others.saturating_add(place.amplitude().0.into());
            }
        }
        let begin = block_at_or_after(end.saturating_add(setting.tau.into()));
        let input = Some(asked.input);
        holding.window = Window { begin, blocks: asked.blocks, shape: Shape::Hann, slots, input };
        (holding.input, holding.windows) = (asked.input, 0);
        (holding.changes, holding.published) = (view.changes, None);
        holding.amplitudes.fill(0);
        Ok(())
    }

    /// Ends the hold by the host's command: the levels return to those of the drive.
    fn release<M: RawMutex>(
        &mut self,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        let mut at = mailbox.now();
        if self.holding.is_on() {
            let levels = self.holding.drive_levels.map(|level| (level.0 > 0).then_some(level));
            if levels != self.holding.hold.levels() {
                at = self.publish_levels(&levels, is_stopped, mailbox)?;
            }
            mailbox.drop_measurement();
        }
        self.holding.clear();
        Ok(at)
    }

    /// Ends the hold, because something else changes the output.
    pub(super) fn end_hold<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        if self.holding.is_on() {
            self.holding.progress = HoldProgress::Ended;
            mailbox.drop_measurement();
        }
    }

    /// Ends the hold if something else has changed the motion in force.
    pub(super) fn refresh_hold<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        if self.holding.is_on() && !self.holding.is_undisturbed(&mailbox.course()) {
            self.end_hold(mailbox);
        }
    }

    /// Drops the hold's own levels that have not begun, before a drive is planned: were they to begin meanwhile, it would have to be
    /// planned again. Returns whether there were any.
    pub(super) fn hold_back_levels<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> bool {
        self.refresh_hold(mailbox);
        if self.holding.is_on() && self.lead.get() > 0 {
            self.lead.set(self.lead.get().max(HOLDING_LEAD));
        }
        self.holding.is_on() && mailbox.drop_levels()
    }

    /// Publishes them again if the drive was refused: that has changed nothing.
    pub(super) fn go_on_if_refused<M: RawMutex>(
        &mut self,
        waited: bool,
        is_refused: bool,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) {
        if waited && is_refused {
            let levels = self.holding.hold.levels();
            match self.publish_levels(&levels, is_stopped, mailbox) {
                Ok(at) => self.holding.published = Some(at),
                Err(_) => self.end_hold(mailbox),
            }
        }
    }

    /// Refuses a measurement while the hold is on, which has the lock-ins for itself.
    pub(super) fn refuse_if_holding(&self) -> Result<(), Refusal> {
        if self.holding.is_on() { Err(Refusal::Busy(Busy::Holding)) } else { Ok(()) }
    }

    /// The hold's state.
    pub(super) fn held<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<Event, Refusal> {
        existing(mailbox)?;
        self.refresh_hold(mailbox);
        let holding = &self.holding;
        if holding.progress == HoldProgress::Off {
            return Ok(Event::Held(Held::default()));
        }
        let mut tones = Vec::new();
        for ((slot, number), amplitude) in (0..TONES).zip(0..).zip(holding.amplitudes) {
            let (Some(state), Some(correction)) = (holding.hold.state(slot), holding.hold.correction(slot))
            else {
                continue;
            };
            let correction = centi_decibel(correction);
            // There is room for all slots.
            let _ = tones.push(wire::HeldTone { slot: number, state: on_wire(state), correction, amplitude });
        }
        Ok(Event::Held(Held {
            progress: holding.progress,
            input: holding.input,
            begin: holding.window.begin,
            windows: holding.windows,
            tones,
        }))
    }
}

/// A level as a ratio, rounded towards none.
fn octaves(level: CentiDecibel) -> Octaves {
    Octaves(i32::from(level.0).saturating_mul(Octaves::DECIBEL.0) / 100)
}

/// A ratio as a level, rounded to the nearest hundredth of a decibel.
fn centi_decibel(ratio: Octaves) -> CentiDecibel {
    const DECIBEL: i32 = Octaves::DECIBEL.0;
    let half = if ratio < Octaves::NONE { -DECIBEL / 2 } else { DECIBEL / 2 };
    let hundredths = ratio.0.saturating_mul(100).saturating_add(half) / DECIBEL;
    CentiDecibel(i16::try_from(hundredths).unwrap_or(i16::MAX))
}

fn refusal(error: SettingError) -> Refusal {
    let (least, most) = HELD_AMPLITUDE;
    match error {
        SettingError::Slot { slot } => Refusal::out_of_range(Field::ToneSlot, 0, HIGHEST_SLOT, slot.into()),
        SettingError::SlotTwice { slot } => Refusal::SlotTwice { slot },
        SettingError::Amplitude { amplitude, .. } => {
            Refusal::out_of_range(Field::HeldAmplitude, least.into(), most.into(), amplitude.into())
        }
        SettingError::Level { slot } => Refusal::SilentTone { slot },
        // Checked before, by the fields of the message.
        SettingError::Period { .. } | SettingError::MaxRise | SettingError::Slew => Refusal::Malformed,
    }
}

const fn on_wire(state: LoopState) -> wire::HoldState {
    match state {
        LoopState::Settling => wire::HoldState::Settling,
        LoopState::Held => wire::HoldState::Held,
        LoopState::AtLimit(limit) => wire::HoldState::AtLimit(match limit {
            Limit::Rise => wire::HoldLimit::Rise,
            Limit::Level => wire::HoldLimit::Level,
            Limit::Headroom => wire::HoldLimit::Headroom,
            Limit::Thermal => wire::HoldLimit::Thermal,
            Limit::Travel => wire::HoldLimit::Travel,
            Limit::Fall => wire::HoldLimit::Fall,
        }),
        LoopState::Lost(loss) => wire::HoldState::Lost(match loss {
            Loss::NotFollowed => wire::HoldLoss::NotFollowed,
            Loss::TooWeak => wire::HoldLoss::TooWeak,
            Loss::Clipped => wire::HoldLoss::Clipped,
            Loss::Stuck => wire::HoldLoss::Stuck,
            Loss::Broken => wire::HoldLoss::Broken,
            Loss::AtRise => wire::HoldLoss::AtRise,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_correction_survives_the_conversion_to_octaves_and_back() {
        for cdb in -MAX_HOLD_CDB..=MAX_HOLD_CDB {
            let ratio = octaves(CentiDecibel(cdb));
            assert!(ratio >= Octaves(-Octaves::MAX.0) && ratio <= Octaves::MAX, "{cdb}");
            assert_eq!(centi_decibel(ratio), CentiDecibel(cdb));
            let exact = f64::from(cdb) / 2000.0 * 10_f64.log2() * 65_536.0;
            assert!((f64::from(ratio.0) - exact).abs() < 53.0, "{cdb}");
        }
    }
}
