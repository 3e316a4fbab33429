//! The trajectories of a motion, where thread and interrupt reach them without a lock.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::table::Setting;
use slipline_protocol::units::{FinePosition, Gain, PhaseStep, SampleIndex};

use super::Motion;
use super::evaluation::{TrajectoryRead, place};
use super::outline::Outline;
use super::placement::{Onset, Placement};
use super::trajectory::{SettingTrajectory, ToneTrajectory};
use crate::slots::TableSlots;

/// Sixteen trajectories in 32-bit atomics.
///
/// The atomics make the sharing sound, they do not make it consistent: one trajectory takes ten of them. Who may write
/// when, and how a reader notices that it has read while someone wrote, is the mailbox's work.
pub(crate) struct MotionCell([TrajectoryCell; MAX_TONES]);

struct TrajectoryCell {
    from: AtomicU32,
    to: AtomicU32,
    from_level: AtomicU32,
    to_level: AtomicU32,
    /// One of [`ALONG`], [`JOIN`], [`HOLD`]; then the numbers of the variant.
    kind: AtomicU32,
    step_upper: AtomicU32,
    step_lower: AtomicU32,
    gain: AtomicU32,
    phase_upper: AtomicU32,
    phase_lower: AtomicU32,
}

const ALONG: u32 = 0;
const JOIN: u32 = 1;
const HOLD: u32 = 2;

impl MotionCell {
    pub(crate) const fn silent() -> Self {
        // As `ToneTrajectory::SILENT`.
        Self(
            [const {
                TrajectoryCell {
                    from: AtomicU32::new(0),
                    to: AtomicU32::new(0),
                    from_level: AtomicU32::new(0),
                    to_level: AtomicU32::new(0),
                    kind: AtomicU32::new(HOLD),
                    step_upper: AtomicU32::new(0),
                    step_lower: AtomicU32::new(0),
                    gain: AtomicU32::new(0),
                    phase_upper: AtomicU32::new(0),
                    phase_lower: AtomicU32::new(0),
                }
            }; MAX_TONES],
        )
    }

    /// A copy of the trajectories as a motion with this outline, which is kept apart.
    pub(crate) fn load(&self, outline: Outline) -> Motion {
        Motion { outline, tones: self.0.each_ref().map(TrajectoryCell::load) }
    }

    pub(crate) fn store(&self, motion: &Motion) {
        for (to, from) in self.0.iter().zip(&motion.tones) {
            to.store(from);
        }
    }

    /// How each tone begins that starts from silence and is to sound.
    pub(crate) fn onsets(&self) -> impl Iterator<Item = Option<Onset>> {
        self.0.iter().map(|tone| tone.load().onset())
    }

    /// As [`Motion::at`], in place.
    pub(crate) fn place(
        &self,
        outline: &Outline,
        index: SampleIndex,
        slots: &TableSlots,
        places: &mut [Placement; MAX_TONES],
    ) {
        place(outline, &self.0, index, slots, places);
    }

    /// Takes every tone to silence from `here`.
    pub(crate) fn fade(&self, here: &[Placement; MAX_TONES]) {
        for (tone, placement) in self.0.iter().zip(here) {
            tone.store(&ToneTrajectory::fading(placement));
        }
    }
}

impl TrajectoryCell {
    #[inline(always)]
    fn load(&self) -> ToneTrajectory {
        let (from, to) = self.positions();
        let (from_level, to_level) = self.levels();
        ToneTrajectory {
            from: FinePosition::saturating(from),
            to: FinePosition::saturating(to),
            from_level,
            to_level,
            setting: self.setting(),
            phase: joined(&self.phase_upper, &self.phase_lower),
        }
    }

    /// The setting of a trajectory that holds.
    #[inline(always)]
    fn constant(&self) -> Setting {
        Setting {
            step: PhaseStep(joined(&self.step_upper, &self.step_lower)),
            gain: Gain(self.gain.load(Relaxed)),
        }
    }

    fn store(&self, tone: &ToneTrajectory) {
        self.from.store(tone.from.raw(), Relaxed);
        self.to.store(tone.to.raw(), Relaxed);
        self.from_level.store(tone.from_level.0, Relaxed);
        self.to_level.store(tone.to_level.0, Relaxed);
        let (kind, (step_upper, step_lower), gain) = match tone.setting {
            SettingTrajectory::Along => (ALONG, (0, 0), 0),
            SettingTrajectory::Join { step_upper, step_lower, gain } => {
                (JOIN, (step_upper.cast_unsigned(), step_lower), gain.cast_unsigned())
            }
            SettingTrajectory::Hold { step, gain } => (HOLD, parts(step.0), gain.0),
        };
        self.kind.store(kind, Relaxed);
        self.step_upper.store(step_upper, Relaxed);
        self.step_lower.store(step_lower, Relaxed);
        self.gain.store(gain, Relaxed);
        let (phase_upper, phase_lower) = parts(tone.phase);
        self.phase_upper.store(phase_upper, Relaxed);
        self.phase_lower.store(phase_lower, Relaxed);
    }
}

impl TrajectoryRead for TrajectoryCell {
    #[inline(always)]
    fn positions(&self) -> (u32, u32) {
        (self.from.load(Relaxed), self.to.load(Relaxed))
    }

    #[inline(always)]
    fn levels(&self) -> (Gain, Gain) {
        (Gain(self.from_level.load(Relaxed)), Gain(self.to_level.load(Relaxed)))
    }

    #[inline(always)]
    fn setting(&self) -> SettingTrajectory {
        match self.kind.load(Relaxed) {
            ALONG => SettingTrajectory::Along,
            JOIN => SettingTrajectory::Join {
                step_upper: self.step_upper.load(Relaxed).cast_signed(),
                step_lower: self.step_lower.load(Relaxed),
                gain: self.gain.load(Relaxed).cast_signed(),
            },
            _ => {
                let Setting { step, gain } = self.constant();
                SettingTrajectory::Hold { step, gain }
            }
        }
    }

    #[inline(always)]
    fn held(&self) -> Option<Setting> {
        match self.kind.load(Relaxed) {
            ALONG | JOIN => None,
            _ => Some(self.constant()),
        }
    }
}

#[inline(always)]
fn joined(upper: &AtomicU32, lower: &AtomicU32) -> u64 {
    (u64::from(upper.load(Relaxed)) << 32) | u64::from(lower.load(Relaxed))
}

#[expect(clippy::cast_possible_truncation, reason = "halves are meant")]
const fn parts(value: u64) -> (u32, u32) {
    ((value >> 32) as u32, value as u32)
}
