//! The values of all trajectories at one sample index.

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::table::Setting;
use slipline_protocol::units::{Gain, SampleIndex};

use super::outline::Outline;
use super::placement::Placement;
use super::trajectory::{SettingTrajectory, ToneTrajectory, between_levels, between_positions, blend};
use crate::planning::ramp::{ONE, progress};
use crate::slots::TableSlots;

/// One tone's trajectory, read part by part, so that only the requested parts are loaded.
pub(super) trait TrajectoryRead {
    /// From where to where, Q1.31.
    fn positions(&self) -> (u32, u32);
    /// From which level to which.
    fn levels(&self) -> (Gain, Gain);
    fn setting(&self) -> SettingTrajectory;
    /// The setting, if it does not move.
    fn held(&self) -> Option<Setting>;
}

impl TrajectoryRead for ToneTrajectory {
    #[inline(always)]
    fn positions(&self) -> (u32, u32) {
        (self.from.raw(), self.to.raw())
    }

    #[inline(always)]
    fn levels(&self) -> (Gain, Gain) {
        (self.from_level, self.to_level)
    }

    #[inline(always)]
    fn setting(&self) -> SettingTrajectory {
        self.setting
    }

    #[inline(always)]
    fn held(&self) -> Option<Setting> {
        match self.setting {
            SettingTrajectory::Hold { step, gain } => Some(Setting { step, gain }),
            SettingTrajectory::Along | SettingTrajectory::Join { .. } => None,
        }
    }
}

/// Writes where each tone is at an index to `places`.
#[inline(always)]
pub(super) fn place(
    outline: &Outline,
    tones: &[impl TrajectoryRead; MAX_TONES],
    index: SampleIndex,
    slots: &TableSlots,
    places: &mut [Placement; MAX_TONES],
) {
    let u = outline.share_of_time(index);
    let s = progress(u);
    let table = slots.table(outline.table);
    // In three rounds: a processor has too few registers for all at once.
    for (place, tone) in places.iter_mut().zip(tones) {
        let (from, to) = tone.positions();
        place.position = between_positions(from, to, u);
        let (from, to) = tone.levels();
        place.level = between_levels(from, to, s);
    }
    for (place, tone) in places.iter_mut().zip(tones) {
        place.setting = match tone.held() {
            Some(setting) => setting,
            None => table.evaluate(place.position),
        };
    }
    let left = ONE.saturating_sub(s);
    for (place, tone) in places.iter_mut().zip(tones) {
        if let SettingTrajectory::Join { step_upper, step_lower, gain } = tone.setting() {
            place.setting = blend(place.setting, (step_upper, step_lower), gain, left);
        }
    }
}
