//! The level hold: keeps the measured amplitude of tones at their set values.
//!
//! ```text
//! lock-in window -> Answers -> log2(set / measured) -> PI, limits, slew -> levels -> caller: planner -> motion -> plate
//!                                                        ^                               |
//!                                                        +---- accepted, refused --------+
//! ```
//! A finger on the plate takes some of a wave's amplitude, a warm coil gives less: the hold gives it back by the tone's
//! level, up or down. Each held slot has a loop of its own; `law.rs` has its equations and margins.
//!
//! **Time.** Windows of one length follow each other, one per [period](LoopSetting::period). At the end of each the caller
//! calls [`Hold::take`] and publishes the levels that it gets, by a drive that glides for [`Hold::glide`] samples, half a
//! period. With `tau` the longer of the plate's time constant and the period, and 6 dB of room, a finger's -6 dB are back
//! within 1 dB after 4.8 `tau` at the latest, also on a plate 6 dB stronger or weaker than the table says, and the overshoot
//! is below 0.1 dB. The loop stays stable, with an overshoot below 3 dB, where the plate's amplitude is a power of 0.5 to 2
//! of the drive's (half and twice the loop gain), and where its time constant is 0.4 to 2.5 times [`LoopSetting::tau`].
//! A simulation in `tests/stability.rs` asserts this for time constants of 0.05 to 20 periods.
//!
//! With gaps between the windows the period is longer than a window; the figures above count in periods.
//!
//! The first window begins when the drive's own glide is over, and the plate has followed it: `tau` later.
//!
//! **Limits.** The hold decides nothing about what a drive may be. It proposes, and the planner that every drive goes
//! through accepts or refuses; a refusal keeps what is in force. The caller says how much more is allowed ([`Room`]), so
//! that refusals are rare and the limit is reached exactly: of the headroom what is left of full scale, nothing while the
//! thermal limit folds back. No tone rises above level 1 either, nor above [`LoopSetting::max_rise`], which counts from the drive's
//! level through all holds of that drive ([`ToneToHold::level`]). What falls is always proposed,
//! also after a refusal. At a limit the integral waits: when the finger leaves, the tone is louder by what the hold had
//! added until the loop has seen it, 5 `tau` later within 1 dB again, and never more than 0.1 dB below its set value. The
//! test of this has 3 dB of room.
//!
//! **Losing lock.** A window that broke, an input that is [clipped or stuck](Loss), a slot that was not followed and a tone
//! that would stay below a quarter of its set value even at the limit, for longer than the plate takes to answer: the
//! tone is lost for good, and goes back to the table's level by the next drive, without slew. Nothing rises while a tone is
//! that weak: an unplugged sensor does not drive the plate up. Only the window in which it is unplugged may look like that of
//! a finger, which is one step up at most. A sensor that slips slowly looks like a finger, too: the tone rises as far as it may.
//! One that stays there for [`LoopSetting::at_rise`] is lost.
//!
//! **Messages.** The protocol carries the input, `tau`, the blocks of a window, `max_rise`, `slew`, and of each tone the slot
//! and the amplitude; no gains, so that no host can make the loop unstable. `controller/hold.rs` takes them, has the windows
//! measured, and hands the levels to the planner. A drive, a chord, a comb, a table, a stop, a disarm, a fault and a new session
//! end the hold as they stand. Its own drives do not count as a user's act. While it is on, a host cannot know the codes.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]

mod answers;
mod law;
mod octaves;
mod setting;
mod tone;

use self::answers::Untrusted;
pub use self::answers::{Answers, amplitude};
use self::law::Law;
pub use self::octaves::Octaves;
pub use self::setting::{LoopSetting, MAX_AMPLITUDE, MIN_AMPLITUDE, SettingError, ToneToHold};
use self::tone::Tone;
use slipline_dds::bank::TONES;
use slipline_protocol::units::Gain;

/// The limit that keeps a tone from rising or falling further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// [`LoopSetting::max_rise`].
    Rise,
    /// Level 1.
    Level,
    /// The sum of all tones is full scale.
    Headroom,
    /// The thermal limit.
    Thermal,
    /// The travel limit.
    Travel,
    /// The lowest level: 60 dB below the table's.
    Fall,
}

/// Why a tone was lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// It was silent for a while, or its phase jumped.
    NotFollowed,
    /// Its answer stays below a quarter of the set value: the sensor is unplugged, or the plate is held fast.
    TooWeak,
    /// A code of the input was at an end of its range.
    Clipped,
    /// All codes of the input were the same.
    Stuck,
    /// Samples of the window were lost.
    Broken,
    /// It has been [at its largest rise](Limit::Rise) for [`LoopSetting::at_rise`]: the sensor has slipped.
    AtRise,
}

/// State of a held tone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoopState {
    /// It is on its way to the set amplitude.
    Settling,
    /// It is within 1 dB of it.
    Held,
    /// It is further off, and a limit keeps it there.
    AtLimit(Limit),
    /// It is no longer held and has the table's level.
    Lost(Loss),
}

/// The allowed rise above the levels in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// The ratio by which all held tones may rise together.
    pub rise: Octaves,
    /// The limit that sets it.
    pub limit: Limit,
}

impl Room {
    /// The headroom to full scale: `held` is the sum of the held tones' amplitudes in force, `others` that of all others at
    /// their largest, both Q1.31. If no held tone rises by more than this ratio, the sum is full scale at most.
    #[must_use]
    pub fn in_headroom(held: u64, others: u64) -> Self {
        let left = u64::from(Gain::FULL.0).saturating_sub(others);
        // Both logarithms are rounded down: with one unit less the ratio is, too.
        let rise = Octaves::log2(left).0 - Octaves::log2(held).0 - 1;
        Self { rise: Octaves(rise.max(0)), limit: Limit::Headroom }
    }
}

/// The levels of the held slots, master included; `None` for the others, which stay as they are.
pub type Levels = [Option<Gain>; TONES];

/// The caller's task at the end of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldAction {
    /// Nothing: the levels in force are right.
    Keep,
    /// Publishes these levels, and reports the outcome: [`Hold::accepted`], [`Hold::refused`] or [`Hold::dropped`].
    Publish(Levels),
}

/// The loops of all held tones.
#[derive(Clone, Debug)]
pub struct Hold {
    law: Law,
    glide: u32,
    tones: [Option<Tone>; TONES],
}

impl Hold {
    /// No tone is held.
    pub const NONE: Self = Self { law: Law::NONE, glide: 0, tones: [None; TONES] };

    /// A hold of tones that sound at their table's levels. `min_glide` is the shortest glide of a drive, in samples.
    ///
    /// # Errors
    /// [`SettingError`], with what is out of range.
    pub fn new(setting: &LoopSetting, held: &[ToneToHold], min_glide: u32) -> Result<Self, SettingError> {
        let mut hold = Self::NONE;
        hold.set(setting, held, min_glide).map(|()| hold)
    }

    /// As [`Hold::new`], in place: a firmware has no room for another copy on its stack. After an error it is as before.
    ///
    /// # Errors
    /// As [`Hold::new`].
    pub fn set(
        &mut self,
        setting: &LoopSetting,
        held: &[ToneToHold],
        min_glide: u32,
    ) -> Result<(), SettingError> {
        setting.check(min_glide)?;
        let mut slots = 0_u16;
        for tone in held {
            let slot = tone.slot;
            tone.check()?;
            let bit = 1_u16.checked_shl(slot.into()).ok_or(SettingError::Slot { slot })?;
            if slots & bit != 0 {
                return Err(SettingError::SlotTwice { slot });
            }
            slots |= bit;
        }
        self.tones.fill(None);
        for tone in held {
            if let Some(place) = self.tones.get_mut(usize::from(tone.slot)) {
                *place = Some(Tone::new(tone));
            }
        }
        self.law = Law::new(setting);
        self.glide = setting.period / 2;
        Ok(())
    }

    /// The glide of the drives that bring new levels, in samples.
    #[must_use]
    pub const fn glide(&self) -> u32 {
        self.glide
    }

    /// Takes the answers of a window that is finished, or `None` if it broke. A proposal of the window before that nobody
    /// has answered is [dropped](Self::dropped).
    pub fn take(&mut self, answers: Option<&Answers>, room: Room) -> HoldAction {
        self.dropped();
        let loss = match answers.map(Answers::check) {
            None => Some(Loss::Broken),
            Some(Err(Untrusted::Stuck)) => Some(Loss::Stuck),
            Some(Err(Untrusted::Clipped)) => Some(Loss::Clipped),
            Some(Ok(())) => None,
        };
        let amplitudes = answers.map_or([None; TONES], |answers| answers.amplitudes);
        for (tone, amplitude) in self.tones.iter_mut().zip(amplitudes) {
            let Some(tone) = tone else { continue };
            match loss {
                Some(loss) => tone.lose(loss, room),
                None => tone.take(amplitude, room, &self.law),
            }
        }
        self.step()
    }

    /// The levels are published, and will be in force.
    pub fn accepted(&mut self) {
        self.tones.iter_mut().flatten().for_each(Tone::accept);
    }

    /// A limit has refused the levels. The tones that were to rise stay as they are for some windows, or until they need to
    /// rise no more. Returns what is left to publish: the tones that fall.
    pub fn refused(&mut self, limit: Limit) -> HoldAction {
        let rose = self.tones.iter_mut().flatten().fold(false, |rose, tone| tone.refuse(limit) | rose);
        if !rose {
            // None was to rise: the falling levels are refused, too.
            self.dropped();
        }
        self.step()
    }

    /// The levels were not published, for a reason that has nothing to do with them, such as another change under way.
    pub fn dropped(&mut self) {
        self.tones.iter_mut().flatten().for_each(Tone::drop_proposal);
    }

    /// A slot's state; `None` if it is not held.
    #[must_use]
    pub fn state(&self, slot: usize) -> Option<LoopState> {
        Some(self.tones.get(slot)?.as_ref()?.state)
    }

    /// A slot's correction in force, relative to its level by the table; `None` if it is not held.
    #[must_use]
    pub fn correction(&self, slot: usize) -> Option<Octaves> {
        Some(self.tones.get(slot)?.as_ref()?.correction())
    }

    /// The levels in force of the held slots.
    #[must_use]
    pub fn levels(&self) -> Levels {
        self.tones.map(|tone| tone.map(|tone| tone.level_in_force()))
    }

    /// Whether there is nothing left to do: every tone is lost, and back at the table's level.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.tones.iter().flatten().all(|tone| tone.is_lost() && tone.correction() == Octaves::NONE)
    }

    /// Proposes the next levels. Corrections too small for a level's last bit come into force without a drive.
    fn step(&mut self) -> HoldAction {
        if self.tones.iter().flatten().any(Tone::is_changed) {
            return HoldAction::Publish(self.tones.map(|tone| tone.map(|tone| tone.level())));
        }
        self.accepted();
        HoldAction::Keep
    }
}

#[cfg(test)]
mod tests;
