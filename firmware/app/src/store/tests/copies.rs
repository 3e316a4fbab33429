//! The two copies: a lost one is reported and repaired, a whole one is not written again, erasures are counted.

use std::format;

use super::*;
use crate::store::{erasures, has_lost_a_copy, holds, holds_nothing};

/// Flash after `times` stores, the last one of `last`.
fn stored_times(times: u32, last: &Kept) -> Flash {
    let mut flash = Flash::new();
    for before in 1..times {
        keep(&mut flash, &table(4, 10 * before)).unwrap();
    }
    keep(&mut flash, last).unwrap();
    flash.powered_up()
}

fn is_held(flash: &mut Flash, (header, knots): &Kept) -> bool {
    holds(flash, header, |index| knots[usize::from(index)])
}

#[test]
fn a_store_that_was_cut_short_is_reported_and_counted_if_it_left_a_trace() {
    let (old, new) = (table(9, 7), table(6, 1_000_000));
    let (mut traces, mut none) = (0, 0);
    for times in 1..=3 {
        let mut start = stored_times(times, &old);
        assert_eq!(
            (has_lost_a_copy(&mut start, FlashSlot::A), erasures(&mut start, FlashSlot::A)),
            (false, times)
        );
        let mut whole = start.clone().powered_up();
        keep(&mut whole, &new).unwrap();
        for first in 0..whole.operations {
            for tear in TEARS {
                let mut torn = start.clone().powered_up();
                torn.cut = Some((first, tear));
                assert_eq!(keep(&mut torn, &new), Err(FlashError));
                let mut torn = torn.powered_up();
                let is_done = read_back(&mut torn) == Ok(new.clone());
                let is_untouched = torn.slots == start.slots && torn.unreadable == start.unreadable;
                let has_trace = !is_done && !is_untouched;
                let what = format!("{times} stores, cut {first} {tear:?}");
                assert_eq!(has_lost_a_copy(&mut torn, FlashSlot::A), has_trace, "{what}");
                assert_eq!(
                    is_held(&mut torn, &old),
                    !is_done && !has_trace,
                    "a torn place is mended: {what}"
                );
                traces += u32::from(has_trace);
                none += u32::from(is_untouched);

                let before = erasures(&mut torn, FlashSlot::A);
                keep(&mut torn, &table(5, 99)).unwrap();
                assert_eq!(erasures(&mut torn, FlashSlot::A), before + 1 + u32::from(has_trace), "{what}");
                assert!(!has_lost_a_copy(&mut torn, FlashSlot::A), "{what}");
            }
        }
    }
    assert!(traces > 50 && none > 3, "{traces} {none}");
}

#[test]
fn what_is_stored_is_held_and_anything_else_is_not() {
    let kept = table(7, 99);
    let mut flash = stored_times(3, &kept);
    assert!(is_held(&mut flash, &kept));
    let mut other = kept.clone();
    other.1[6].gain = Gain(other.1[6].gain.0 ^ 1);
    assert!(!is_held(&mut flash, &other), "another knot");
    let other = (TableHeader { span_end_um: 2001, ..kept.0 }, kept.1.clone());
    assert!(!is_held(&mut flash, &other), "another span");
    // What has decayed is written again.
    for at in 0..FLASH_WORD * 4 {
        let mut rotten = flash.clone();
        rotten.slots[0][at] ^= 1;
        assert!(!is_held(&mut rotten, &kept), "byte {at}");
    }
    assert!(!holds_nothing(&mut flash));
    forget(&mut flash).unwrap();
    assert!(holds_nothing(&mut flash) && !is_held(&mut flash, &kept));
    assert!(holds_nothing(&mut Flash::new()));
}

#[test]
fn a_store_over_two_lost_records_leaves_nothing_that_looks_like_a_loss() {
    let mut flash = stored_times(2, &table(7, 99));
    for slot in &mut flash.slots {
        slot[0] ^= 1;
    }
    assert_eq!((read_back(&mut flash), erasures(&mut flash, FlashSlot::A)), (Err(StoredConfig::Damaged), 0));
    assert!(!has_lost_a_copy(&mut flash, FlashSlot::A) && !holds_nothing(&mut flash));
    let kept = table(8, 5);
    keep(&mut flash, &kept).unwrap();
    assert_eq!((read_back(&mut flash), has_lost_a_copy(&mut flash, FlashSlot::A)), (Ok(kept), false));
}
