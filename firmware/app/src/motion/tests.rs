//! Motions against their equations.

use std::boxed::Box;

use proptest::prelude::*;
use slipline_protocol::limits::MAX_KNOT_STEP;
use slipline_protocol::table::{Knot, Setting};
use slipline_protocol::units::{PhaseStep, Position};

use super::cell::MotionCell;
use super::trajectory::blend;
use super::*;
use crate::planning::ramp::ONE;
use crate::slots::SlotIndex;

const KNOTS: u16 = 65;

/// Two tables: a rising and a falling one.
fn slots() -> Box<TableSlots> {
    let slots = Box::new(TableSlots::new());
    for index in 0..KNOTS {
        let i = u32::from(index);
        slots.write(
            SlotIndex::First,
            index,
            Knot { step: 1_000_000 + i * 7_000_000, gain: Gain((1 << 30) + i * 1000) },
        );
        slots.write(
            SlotIndex::Second,
            index,
            Knot { step: 1_500_000_000 - i * 9_000_000, gain: Gain((1 << 31) - i * 9_000_000) },
        );
    }
    slots
}

fn table(slot: SlotIndex) -> TableRef {
    TableRef { slot, knots: KNOTS }
}

fn program(at: SampleIndex, glide: u32, slot: SlotIndex, targets: &[(usize, u16, u32)]) -> Program {
    let mut program = Program { at, glide, table: table(slot), targets: [None; MAX_TONES] };
    for &(slot, position, level) in targets {
        program.targets[slot] = Some(Target {
            position: Position(position).fine(),
            level: Gain(level),
            phase: 7 << 40,
            setting: None,
        });
    }
    program
}

fn targets() -> impl Strategy<Value = std::vec::Vec<(usize, u16, u32)>> {
    prop::collection::vec((0..MAX_TONES, any::<u16>(), 1..=1u32 << 31), 0..6)
}

proptest! {
    #[test]
    fn every_tone_goes_on_from_where_it_is(
        programs in prop::collection::vec((targets(), 2000u32..50_000, 0u64..60_000, any::<bool>()), 1..8),
    ) {
        let slots = slots();
        let mut motion = Motion::silent();
        let mut at = 0;
        for (targets, glide, later, second) in programs {
            at += later / 128 * 128;
            let slot = if second { SlotIndex::Second } else { SlotIndex::First };
            let before = motion.at(at, &slots);
            let next = motion.follow(&before, &program(at, glide, slot, &targets), &slots);
            let after = next.at(at, &slots);
            for ((before, after), onset) in before.iter().zip(&after).zip(next.tones.iter().map(ToneTrajectory::onset)) {
                prop_assert_eq!(before.level, after.level);
                if before.is_silent() {
                    prop_assert!(after.is_silent());
                } else {
                    prop_assert_eq!(before.position, after.position);
                    prop_assert_eq!(before.setting, after.setting);
                    prop_assert_eq!(onset, None, "a tone that sounds keeps its phase");
                }
            }
            let sounds = !before.iter().all(Placement::is_silent) || !targets.is_empty();
            prop_assert_eq!(next.is_silent_from(at), !sounds);
            prop_assert_eq!(next.is_silent_from(next.end()), targets.is_empty());
            motion = next;
        }
        // All arrive.
        let end = motion.at(motion.end(), &slots);
        for (placement, goal) in end.iter().zip(&motion.goals()) {
            match goal {
                None => prop_assert!(placement.is_silent()),
                Some(target) => {
                    prop_assert_eq!((placement.position, placement.level), (target.position, target.level));
                    prop_assert_eq!(placement.setting, slots.evaluate(motion.table(), target.position));
                }
            }
        }
        for later in [1, 1 << 32, (1 << 32) + 7, u64::MAX] {
            prop_assert_eq!(motion.at(motion.end().saturating_add(later), &slots), end);
        }
        let wrapped = at.saturating_add(1 << 32);
        prop_assert_eq!(motion.at(wrapped, &slots), end, "no 32-bit time");
    }

    #[test]
    fn a_fade_ends_in_silence_and_never_grows(targets in targets(), cut in 0u64..40_000, ramp in 1u32..30_000) {
        let slots = slots();
        let motion = Motion::silent().follow(&[Placement::default(); MAX_TONES], &program(0, 20_000, SlotIndex::First, &targets), &slots);
        let cell = MotionCell::silent();
        cell.store(&motion);
        let copy = cell.load(motion.outline());
        prop_assert_eq!(&copy, &motion);
        let here = motion.at(cut, &slots);
        cell.fade(&here);
        let fade = cell.load(Outline::fading(&here, cut, ramp, motion.table()));
        prop_assert!(fade.ends_silent());
        prop_assert!(fade.is_silent_from(fade.end()));
        let sounded = motion.at(cut, &slots).iter().any(|placement| !placement.is_silent());
        prop_assert_eq!(fade.is_silent_from(cut), !sounded);
        let mut last = motion.at(cut, &slots);
        for part in 0..=20u64 {
            let now = fade.at(cut + u64::from(ramp) * part / 20, &slots);
            for (now, last) in now.iter().zip(&last) {
                prop_assert!(now.amplitude() <= last.amplitude());
                prop_assert_eq!(now.setting, last.setting, "what fades keeps its frequency");
            }
            last = now;
        }
        prop_assert!(last.iter().all(Placement::is_silent));
    }

    #[test]
    fn a_position_moves_on_a_line_and_its_setting_along_the_table(from: u16, to: u16, share in 0u32..=1000) {
        let slots = slots();
        let start = Motion::silent().follow(&[Placement::default(); MAX_TONES], &program(0, 2000, SlotIndex::First, &[(3, from, 1 << 30)]), &slots);
        let motion = start.follow(&start.at(4096, &slots), &program(4096, 10_000, SlotIndex::First, &[(3, to, 1 << 30)]), &slots);
        let placement = motion.at(4096 + u64::from(share) * 10, &slots)[3];
        let (a, b) = (f64::from(from) / 65_535.0, f64::from(to) / 65_535.0);
        let want = a + (b - a) * f64::from(share) / 1000.0;
        let got = f64::from(placement.position.raw()) / f64::from(1u32 << 31);
        prop_assert!((got - want).abs() < 2e-9, "{got} {want}");
        prop_assert_eq!(placement.setting, slots.evaluate(motion.table(), placement.position));
    }

    #[test]
    fn a_join_leaves_its_share_of_the_difference_and_stays_in_range(
        at in (0..=u64::from(MAX_KNOT_STEP) << 32, 0..=ONE),
        by in (-(i64::from(MAX_KNOT_STEP) << 32)..=i64::from(MAX_KNOT_STEP) << 32, -(1i64 << 31)..1i64 << 31),
        left in 0..=ONE,
    ) {
        let (step, gain) = at;
        let (step_by, gain_by) = by;
        let setting = Setting { step: PhaseStep(step), gain: Gain(gain) };
        let blended = blend(setting, ((step_by >> 32) as i32, step_by as u32), gain_by as i32, left);
        let share = |by: i64| (i128::from(by) * i128::from(left)) >> 31;
        let step = (i128::from(step) + share(step_by)).clamp(0, i128::from(MAX_KNOT_STEP) << 32);
        // The gain's share is rounded up.
        let gain = (i128::from(gain) - share(-gain_by)).clamp(0, i128::from(ONE));
        prop_assert_eq!((i128::from(blended.step.0), i128::from(blended.gain.0)), (step, gain));
    }
}
