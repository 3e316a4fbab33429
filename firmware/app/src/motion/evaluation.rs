//! The values of all trajectories at one sample index.

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::table::Setting;
use slipline_protocol::units::SampleIndex;

use super::outline::Outline;
use super::placement::Placement;
use super::trajectory::{SettingTrajectory, ToneTrajectory, between_levels, between_positions, blend};
use crate::ramp::{ONE, RampShape};
use crate::slots::TableSlots;

/// Writes where each tone is at an index to `places`.
#[inline(always)]
pub(super) fn place(
    outline: &Outline,
    tones: impl Iterator<Item = ToneTrajectory> + Clone,
    index: SampleIndex,
    slots: &TableSlots,
    shape: &RampShape,
    places: &mut [Placement; MAX_TONES],
) {
    let u = outline.share_of_time(index);
    let s = shape.at(u);
    let table = slots.table(outline.table);
    // In three rounds: a processor has too few registers for all at once.
    for (place, tone) in places.iter_mut().zip(tones.clone()) {
        place.position = between_positions(tone.from, tone.to, u);
        place.level = between_levels(tone.from_level, tone.to_level, s);
    }
    for (place, tone) in places.iter_mut().zip(tones.clone()) {
        place.setting = match tone.setting {
            SettingTrajectory::Hold { step, gain } => Setting { step, gain },
            SettingTrajectory::Along | SettingTrajectory::Join { .. } => table.evaluate(place.position),
        };
    }
    let left = ONE.saturating_sub(s);
    for (place, tone) in places.iter_mut().zip(tones) {
        if let SettingTrajectory::Join { step_upper, step_lower, gain } = tone.setting {
            place.setting = blend(place.setting, (step_upper, step_lower), gain, left);
        }
    }
}
