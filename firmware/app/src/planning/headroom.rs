//! The worst-case sum of a program, bounded in integers before it is accepted.
//!
//! A tone's amplitude on the way is `gain(u) * level(s)`. The gain never exceeds the largest knot crossed plus, while
//! a table swap blends, the difference at the start: `G`. All levels share one `s`, and `sum G_i level_i(s)` is
//! linear in `s`, so it is largest at one of the ends. Within a block the bank goes along the chord between two such
//! sums, which lies below the larger. So with `sum G_i l0_i <= 1` and `sum G_i l1_i <= 1` no sample can clip,
//! whatever the phases. The bound is tight for tones that stay and for one tone that fades while another rises.
//!
//! A chord may exceed the bound: its peak has been rendered ([`crate::planning::chord`]). So long as all its tones have one common
//! factor, as when all fade, that proof holds; any other change of them falls back to the bound.

#![cfg_attr(not(test), deny(clippy::float_arithmetic))]
#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use slipline_protocol::limits::MAX_TONES;
use slipline_protocol::refusal::Refusal;
use slipline_protocol::units::Gain;

use crate::motion::Placement;
use crate::planning::program::Program;
use crate::slots::{Extremes, TableSlots};

/// Checks that a program that starts from `placements` stays within full scale on its whole way; `ways` are the table's
/// extremes between each placement and its target.
///
/// # Errors
/// [`Refusal::Headroom`] with the worst-case sum.
pub(crate) fn check(
    program: &Program,
    placements: &[Placement; MAX_TONES],
    ways: &[Extremes; MAX_TONES],
    slots: &TableSlots,
) -> Result<(), Refusal> {
    if program.targets.iter().all(Option::is_none) {
        return Ok(());
    }
    let mut at_start: u64 = 0;
    let mut at_end: u64 = 0;
    for ((placement, way), target) in placements.iter().zip(ways).zip(&program.targets) {
        let Some(target) = target else {
            at_start = at_start.saturating_add(u64::from(placement.amplitude().0));
            continue;
        };
        // A tone that starts from silence starts at its target.
        let from = if placement.is_silent() { target.position } else { placement.position };
        let mut gain = if from == target.position {
            // At rest the interpolated value is exact, and lower than a knot beside it.
            slots.evaluate(program.table, from).gain.0
        } else {
            way.gain
        };
        if !placement.is_silent() {
            let here = slots.evaluate(program.table, placement.position).gain.0;
            let above = placement.setting.gain.0.saturating_sub(here);
            gain = gain.saturating_add(above).min(Gain::FULL.0);
        }
        at_start = at_start.saturating_add(u64::from(Gain(gain).times(placement.level).0));
        at_end = at_end.saturating_add(u64::from(Gain(gain).times(target.level).0));
    }
    Refusal::check_sum(at_start.max(at_end), Gain::FULL)
}
