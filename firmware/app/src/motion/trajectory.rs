//! One tone's trajectory: its place, its level, its setting, and the arithmetic on them.

use slipline_protocol::limits::MAX_KNOT_STEP;
use slipline_protocol::table::Setting;
use slipline_protocol::units::{FinePosition, Gain, PhaseStep};

use super::placement::{Onset, Placement};
use crate::planning::ramp::ONE;

/// How a tone's setting moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SettingTrajectory {
    /// Along the table.
    Along,
    /// To the table and along it, from what it was at the start: the differences there, in units of step and of gain.
    /// The step's upper half has its sign.
    Join { step_upper: i32, step_lower: u32, gain: i32 },
    /// Not at all.
    Hold { step: PhaseStep, gain: Gain },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ToneTrajectory {
    pub(crate) from: FinePosition,
    pub(crate) to: FinePosition,
    pub(crate) from_level: Gain,
    pub(crate) to_level: Gain,
    pub(crate) setting: SettingTrajectory,
    /// The phase it begins with if it starts from silence.
    pub(crate) phase: u64,
}

impl SettingTrajectory {
    pub(super) const fn hold(setting: Setting) -> Self {
        Self::Hold { step: setting.step, gain: setting.gain }
    }

    /// Along the table, which says `on_table` where the tone is.
    #[expect(clippy::cast_possible_truncation, reason = "halves are meant")]
    pub(super) fn from(placement: &Placement, on_table: Setting) -> Self {
        let gain = i64::from(placement.setting.gain.0) - i64::from(on_table.gain.0);
        if placement.setting == on_table {
            return Self::Along;
        }
        // Both steps lie below 2^63.
        let step = placement.setting.step.0.wrapping_sub(on_table.step.0);
        Self::Join {
            step_upper: ((step >> 32) as u32).cast_signed(),
            step_lower: step as u32,
            // A table's gains lie in 1..=2^31, so the difference from another such fits 32 bits.
            gain: i32::try_from(gain).unwrap_or(i32::MAX),
        }
    }
}

impl ToneTrajectory {
    pub(super) const SILENT: Self = Self {
        from: FinePosition::saturating(0),
        to: FinePosition::saturating(0),
        from_level: Gain(0),
        to_level: Gain(0),
        setting: SettingTrajectory::hold(Setting { step: PhaseStep(0), gain: Gain(0) }),
        phase: 0,
    };

    /// To silence from where the tone is.
    pub(super) const fn fading(placement: &Placement) -> Self {
        Self {
            from: placement.position,
            to: placement.position,
            from_level: placement.level,
            to_level: Gain(0),
            setting: SettingTrajectory::hold(placement.setting),
            phase: 0,
        }
    }

    /// How the tone begins if it starts from silence and is to sound.
    #[inline(always)]
    pub(super) fn onset(&self) -> Option<Onset> {
        match self.setting {
            SettingTrajectory::Hold { step, .. } if self.from_level.0 == 0 && self.to_level.0 != 0 => {
                Some(Onset { phase: self.phase, step })
            }
            _ => None,
        }
    }
}

/// `a + u (b - a)`, all Q1.31, rounded down; as a weighted sum, which takes no signs.
#[expect(clippy::cast_possible_truncation, reason = "the result lies between a and b")]
fn between(a: u32, b: u32, u: u32) -> u32 {
    // Both weights and both values are at most 2^31.
    let rest = ONE.saturating_sub(u);
    ((u64::from(a) * u64::from(rest) + u64::from(b) * u64::from(u)) >> 31) as u32
}

/// As [`between`], of two raw positions.
pub(super) fn between_positions(a: u32, b: u32, u: u32) -> FinePosition {
    FinePosition::saturating(between(a, b, u))
}

pub(super) fn between_levels(a: Gain, b: Gain, s: u32) -> Gain {
    Gain(between(a.0, b.0, s))
}

/// The table's setting and what `left` (Q1.31) leaves of the differences at the start, kept within the ranges of a
/// setting: the clamp of something continuous is continuous.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "halves are meant, and what is shifted down fits")]
pub(super) fn blend(setting: Setting, step: (i32, u32), gain: i32, left: u32) -> Setting {
    const MAX_STEP: u64 = (MAX_KNOT_STEP as u64) << 32;
    // All of -1..=0 fits a signed number, 1 would not; and a product of two such is one instruction.
    let minus_left = i64::from(left.wrapping_neg().cast_signed());
    // (step * left) >> 31 has 95 bits on its way, so it is formed in halves: the upper half is whole after the shift.
    let (upper, lower) = step;
    let lower = (u64::from(lower) * u64::from(left)) >> 31;
    let upper = (i64::from(upper) * minus_left) << 1;
    let step = lower.cast_signed().wrapping_sub(upper);
    let gain = ((i64::from(gain) * minus_left) >> 31).wrapping_neg() as i32;
    // A step and a step's change are less than 2^63, so a sum outside 0..MAX_STEP, taken without a sign, is above it
    // on either side; likewise a gain.
    let moved_step = setting.step.0.wrapping_add_signed(step);
    let moved_gain = setting.gain.0.wrapping_add_signed(gain);
    Setting {
        step: PhaseStep(match moved_step {
            MAX_STEP.. if step < 0 => 0,
            MAX_STEP.. => MAX_STEP,
            within => within,
        }),
        gain: Gain(match moved_gain {
            ONE.. if gain < 0 => 0,
            ONE.. => ONE,
            within => within,
        }),
    }
}
