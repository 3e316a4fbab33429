//! Every plan keeps the headroom and the bank's limits in every block on its way.

use std::boxed::Box;
use std::vec::Vec;

use proptest::prelude::*;
use slipline_protocol::command::{Apply, Tone};
use slipline_protocol::limits::MAX_KNOT_STEP;
use slipline_protocol::table::Knot;
use slipline_protocol::units::{CentiDecibel, Gain, Level, Phase, Position};

use super::*;
use crate::slots::SlotIndex;
use crate::timing::{BLOCK_SAMPLES, block_at_or_after};

/// A table with any steps in order and any gains.
fn knots() -> impl Strategy<Value = Vec<Knot>> {
    let knot = (1u32..=MAX_KNOT_STEP, 1u32..=1 << 31);
    (prop::collection::vec(knot, 2..40), any::<bool>()).prop_map(|(mut knots, falling)| {
        knots.sort_unstable();
        knots.dedup_by_key(|knot| knot.0);
        if knots.len() < 2 {
            knots = std::vec![(1, 1 << 30), (1 << 30, 1 << 29)];
        }
        if falling {
            knots.reverse();
        }
        knots.into_iter().map(|(step, gain)| Knot { step, gain: Gain(gain) }).collect()
    })
}

fn drives() -> impl Strategy<Value = Vec<(Drive, u64, bool)>> {
    let tone = (0..16u8, any::<u16>(), 0u16..40_000);
    let drive = (prop::collection::vec(tone, 0..5), -600i16..=0, 2000u32..30_000);
    prop::collection::vec((drive, 0u64..40_000, prop::bool::weighted(0.2)), 1..10).prop_map(|drives| {
        drives
            .into_iter()
            .map(|((mut tones, master, glide), later, swap)| {
                tones.sort_unstable();
                tones.dedup_by_key(|tone| tone.0);
                let tones = tones.into_iter().map(|(slot, position, level)| Tone {
                    slot,
                    position: Position(position),
                    level: Level(level),
                    phase: Phase(0),
                });
                let drive =
                    Drive { tones: tones.collect(), master: CentiDecibel(master), glide, apply: Apply::Next };
                (drive, later, swap)
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_block_of_any_plan_is_too_loud_or_changes_its_frequency_too_fast(
        first in knots(),
        second in knots(),
        drives in drives(),
    ) {
        let slots = Box::new(TableSlots::new());
        let mut tables = [SlotIndex::First, SlotIndex::Second].map(|slot| TableRef { slot, knots: 0 });
        for (table, knots) in tables.iter_mut().zip([&first, &second]) {
            for (index, &knot) in (0..).zip(knots) {
                slots.write(table.slot, index, knot);
            }
            table.knots = knots.len() as u16;
        }
        let timing = Timing::at(400_000);
        let (mut motion, mut at, mut active) = (Motion::silent(), 0, 0);
        for (drive, later, swap) in drives {
            let mut never = || false;
            let mut planner = Planner { slots: &slots, timing: &timing, is_stopped: &mut never };
            let planned = if swap {
                active = 1 - active;
                planner.swap(at, tables[active], &motion)
            } else {
                planner.drive(&drive, at, tables[active], &motion)
            };
            match planned {
                Ok(next) => motion = next,
                Err(Refusal::Headroom { sum_per_mille }) => {
                    prop_assert!(sum_per_mille > 1000);
                    // The table in force stays that of the motion.
                    if swap {
                        active = 1 - active;
                    }
                }
                other => prop_assert!(false, "{other:?}"),
            }
            let until = block_at_or_after(at + later);
            while at < until {
                let (start, end) = (motion.at(at, &slots), motion.at(at + BLOCK_SAMPLES, &slots));
                let sum: u64 = end.iter().map(|placement| u64::from(placement.amplitude().0)).sum();
                prop_assert!(sum <= u64::from(Gain::FULL.0), "{sum}");
                for (start, end) in start.iter().zip(&end) {
                    if start.is_silent() && end.is_silent() {
                        continue;
                    }
                    let change = start.setting.step.0.abs_diff(end.setting.step.0);
                    // Positions and shares are rounded to 31 bits.
                    prop_assert!(change <= MAX_STEP_CHANGE + (MAX_STEP_CHANGE >> 10), "{change:x}");
                    prop_assert!(end.setting.step.0 >> 32 <= u64::from(MAX_KNOT_STEP));
                }
                at += BLOCK_SAMPLES;
            }
        }
    }
}

#[test]
fn a_table_swap_leaves_a_glide_its_time() {
    let slots = Box::new(TableSlots::new());
    for (slot, gain) in [(SlotIndex::First, 1 << 30), (SlotIndex::Second, 1 << 29)] {
        for index in 0..2 {
            slots.write(slot, index, Knot { step: 1 << 28, gain: Gain(gain) });
        }
    }
    let table = |slot| TableRef { slot, knots: 2 };
    let timing = Timing::at(400_000);
    let tone = Tone { slot: 0, position: Position(0), level: Level::FULL, phase: Phase(0) };
    let glide = 100 * timing.table_glide;
    let drive =
        Drive { tones: [tone].into_iter().collect(), master: CentiDecibel(0), glide, apply: Apply::Next };
    let mut never = || false;
    let mut planner = Planner { slots: &slots, timing: &timing, is_stopped: &mut never };
    let rise = planner.drive(&drive, 0, table(SlotIndex::First), &Motion::silent()).unwrap();
    let mut swapped = |at| planner.swap(at, table(SlotIndex::Second), &rise).unwrap();
    let glide = u64::from(glide);
    assert_eq!(swapped(glide / 128 / 4 * 128).end(), glide);
    let after = glide.next_multiple_of(128);
    assert_eq!(swapped(after).end(), after + u64::from(timing.table_glide));
}
