//! One tone's loop: from the error to the proposed correction, and its acceptance or refusal.

use super::law::{FINE, Law, fine};
use super::octaves::Octaves;
use super::{Limit, LoopState, Loss, Room, ToneToHold};
use slipline_protocol::units::Gain;

/// Windows after a refusal until a rise is proposed again, to save the planner's time.
pub(super) const RETRY_WINDOWS: u8 = 16;
/// The lowest correction.
const FLOOR: i64 = -fine(Octaves::MAX);
/// Error above which a tone is too weak: it would stay below a quarter of its set value even at the limit.
const TOO_WEAK: i64 = fine(Octaves(2 << 16));

/// A correction and the integral behind it, with the fractional bits of [`fine`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Stand {
    correction: i64,
    integral: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tone {
    /// The logarithm of the set amplitude in 1/256 code.
    set: Octaves,
    /// The drive's level, and how far above it level 1 lies.
    level: Gain,
    below_full: i64,
    /// The level in force, and the proposed one.
    accepted: Stand,
    proposed: Stand,
    /// Windows in which it was too weak, one after the other.
    weak: u32,
    /// Windows in which it was at its largest rise, one after the other.
    at_rise: u32,
    /// Windows in which no rise is proposed, and what refused it.
    frozen: u8,
    frozen_by: Limit,
    pub(super) state: LoopState,
}

impl Tone {
    pub(super) fn new(tone: &ToneToHold) -> Self {
        let above_drive = |level: Gain| {
            fine(Octaves(Octaves::log2(level.0.into()).0 - Octaves::log2(tone.level.0.into()).0))
        };
        // What an earlier hold has left.
        let correction = above_drive(tone.sounding);
        let begin = Stand { correction, integral: correction };
        Self {
            set: Octaves::log2(tone.amplitude.into()),
            level: tone.level,
            below_full: above_drive(Gain::FULL),
            accepted: begin,
            proposed: begin,
            weak: 0,
            at_rise: 0,
            frozen: 0,
            frozen_by: Limit::Rise,
            state: LoopState::Settling,
        }
    }

    /// Takes the amplitude that a window has measured, in 1/256 code; `None` if the slot was not followed.
    pub(super) fn take(&mut self, amplitude: Option<u32>, room: Room, law: &Law) {
        self.frozen = self.frozen.saturating_sub(1);
        if self.is_lost() {
            self.fall_back(room);
            return;
        }
        let Some(amplitude) = amplitude else {
            self.lose(Loss::NotFollowed, room);
            return;
        };
        // Both logarithms are between 0 and 32 octaves.
        let error = Octaves(self.set.0 - Octaves::log2(amplitude.into()).0);
        if error <= Octaves::NONE {
            self.frozen = 0;
        }
        let (ceiling, limit) = self.ceiling(room, law);
        let left = ceiling - self.accepted.correction;
        let is_weak = fine(error) - left > TOO_WEAK;
        self.weak = if is_weak { self.weak.saturating_add(1) } else { 0 };
        if self.weak > law.patience {
            self.lose(Loss::TooWeak, room);
            return;
        }
        // A sensor that is unplugged must not drive the plate up, so nothing rises while that may be the cause.
        let ceiling = if is_weak { self.accepted.correction } else { ceiling };
        let is_beyond = self.control(error, ceiling, law);
        self.state = if error.0.abs() <= Octaves::DECIBEL.0 {
            LoopState::Held
        } else if error > Octaves::NONE && (is_beyond && !is_weak || left <= 0) {
            LoopState::AtLimit(limit)
        } else if error < Octaves::NONE && self.proposed.correction == FLOOR {
            LoopState::AtLimit(Limit::Fall)
        } else {
            LoopState::Settling
        };
        let is_at_rise = self.state == LoopState::AtLimit(Limit::Rise);
        self.at_rise = if is_at_rise { self.at_rise.saturating_add(1) } else { 0 };
        if self.at_rise >= law.at_rise {
            self.lose(Loss::AtRise, room);
        }
    }

    /// Proposes a correction; returns whether a higher one was wanted than the ceiling.
    ///
    /// The integral never leaves the range of the corrections, whose upper end is the level in force where a rise has been
    /// refused, and waits while the slew holds the correction back: so there is nothing to unwind when the error changes
    /// its sign.
    fn control(&mut self, error: Octaves, ceiling: i64, law: &Law) -> bool {
        let Stand { correction, integral } = self.accepted;
        let error = i64::from(error.0);
        // The gains are at most 1, so each product has at most 6 + 16 + 24 bits.
        let summed = (integral + law.integral * error).clamp(FLOOR, ceiling);
        let wanted = summed + law.proportional * error;
        let limited = wanted.clamp(FLOOR, ceiling);
        let next = limited.clamp(correction - law.slew, correction + law.slew);
        let is_held_back = (limited - next).signum() * error.signum() > 0;
        let integral = if is_held_back { integral } else { summed };
        self.proposed = Stand { correction: next, integral };
        wanted > ceiling
    }

    /// The highest correction, and what makes it so. Below the one in force only where an earlier hold was allowed more.
    fn ceiling(&self, room: Room, law: &Law) -> (i64, Limit) {
        let accepted = self.accepted.correction;
        let limits = [
            (accepted + fine(room.rise.clamp(Octaves::NONE, Octaves::MAX)), room.limit),
            (law.max_rise, Limit::Rise),
            (self.below_full, Limit::Level),
        ];
        let frozen = (accepted, self.frozen_by);
        let first = if self.frozen > 0 { frozen } else { limits[0] };
        limits.into_iter().fold(first, |lowest, limit| if limit.0 < lowest.0 { limit } else { lowest })
    }

    /// Gives the tone up: it goes back to the table's level.
    pub(super) fn lose(&mut self, loss: Loss, room: Room) {
        if !self.is_lost() {
            self.state = LoopState::Lost(loss);
        }
        self.fall_back(room);
    }

    /// To the table's level, or as near to it as there is room for.
    fn fall_back(&mut self, room: Room) {
        let accepted = self.accepted.correction;
        let rise = if self.frozen > 0 { Octaves::NONE } else { room.rise.clamp(Octaves::NONE, Octaves::MAX) };
        self.proposed = Stand { correction: (accepted + fine(rise)).min(0), integral: 0 };
    }

    /// Whether what is proposed is another level than the one in force.
    pub(super) fn is_changed(&self) -> bool {
        level(self.level, self.proposed) != level(self.level, self.accepted)
    }

    /// The level in force.
    pub(super) fn level_in_force(&self) -> Gain {
        level(self.level, self.accepted)
    }

    /// The level that is proposed.
    pub(super) fn level(&self) -> Gain {
        level(self.level, self.proposed)
    }

    /// The correction in force.
    pub(super) fn correction(&self) -> Octaves {
        rounded(self.accepted)
    }

    pub(super) const fn is_lost(&self) -> bool {
        matches!(self.state, LoopState::Lost(_))
    }

    /// The proposed level is in force.
    pub(super) fn accept(&mut self) {
        self.accepted = self.proposed;
    }

    /// The proposed level did not come into force, for a reason that says nothing about the tones.
    pub(super) fn drop_proposal(&mut self) {
        self.proposed = self.accepted;
    }

    /// A limit refused the proposed level: revert the rise and pause before proposing another. Returns whether it was a
    /// rise.
    pub(super) fn refuse(&mut self, limit: Limit) -> bool {
        if self.proposed.correction <= self.accepted.correction {
            return false;
        }
        self.proposed = self.accepted;
        self.frozen = RETRY_WINDOWS;
        self.frozen_by = limit;
        if self.state == LoopState::Settling {
            self.state = LoopState::AtLimit(limit);
        }
        true
    }
}

fn rounded(stand: Stand) -> Octaves {
    // Rounded down, so never louder; at most 10 octaves.
    Octaves(i32::try_from(stand.correction >> FINE).unwrap_or(i32::MIN))
}

fn level(level: Gain, stand: Stand) -> Gain {
    rounded(stand).times(level)
}
