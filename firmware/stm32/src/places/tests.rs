//! The places against a DAC and an ADC that count triggers, and a renderer that may be late.

use proptest::prelude::*;

use super::*;

/// The ADC's ring.
const RING: u32 = 512;

/// What the ADC has sampled up to a trigger.
fn sampled(until: u32) -> Sampled {
    Sampled { until, count: RING - 1 }
}

/// The trigger after the last one of a half's codes.
fn end(half: u32) -> u32 {
    half.wrapping_mul(128).wrapping_add(129)
}

#[test]
fn a_block_is_found_when_its_last_code_has_been_sampled_and_lost_when_its_first_is_overwritten() {
    let places = Places::new();
    places.take(2);
    assert_eq!(places.find(0, sampled(end(2) - 1)), Search::Pending);
    assert_eq!(
        places.find(0, sampled(end(2))),
        Search::Found(257),
        "a code from the holding register, two halves"
    );
    assert_eq!(places.find(0, sampled(257 + RING - 1)), Search::Found(257));
    assert_eq!(places.find(0, sampled(257 + RING)), Search::Lost(1));
    assert_eq!(places.find(1, sampled(257 + RING)), Search::Pending, "nothing else has been taken");
}

#[test]
fn a_ring_that_began_in_the_middle_of_a_block_does_not_have_it() {
    let places = Places::new();
    places.take(2);
    places.take(3);
    let begun = |trigger| Sampled { until: end(3), count: end(3) - trigger };
    assert_eq!(places.find(0, begun(257)), Search::Found(257));
    assert_eq!(places.find(0, begun(258)), Search::Lost(1));
    assert_eq!(places.find(1, begun(258)), Search::Found(385));
    assert_eq!(places.find(0, begun(386)), Search::Lost(2));
}

#[test]
fn blocks_that_the_ring_could_not_take_are_lost_with_those_before_them_and_halves_may_be_left_out() {
    let places = Places::new();
    for half in [2, 3, 5] {
        places.take(half);
    }
    assert_eq!(places.find(2, sampled(end(5))), Search::Found(5 * 128 + 1), "half 4 was no block's");
    // The ring restarts.
    places.skip();
    places.take(2);
    assert_eq!(places.find(2, sampled(0)), Search::Lost(2));
    assert_eq!(places.find(4, sampled(end(2))), Search::Found(257));
}

#[test]
fn blocks_that_are_no_longer_remembered_are_lost() {
    let places = Places::new();
    for half in 2..9 {
        places.take(half);
    }
    assert_eq!(places.find(0, sampled(end(6))), Search::Lost(3));
    assert_eq!(places.find(3, sampled(end(6))), Search::Found(5 * 128 + 1));
}

proptest! {
    /// Every block is read with its own codes, or lost, once, and none is passed over: whatever the counts, which wrap, and
    /// however late the renderer is.
    #[test]
    fn each_block_is_found_at_its_own_place_or_lost(
        first in prop_oneof![Just(2_u32), Just(u32::MAX - 5), Just(u32::MAX / 128 - 3), Just(u32::MAX / 256), any::<u32>()],
        late in prop::collection::vec(prop_oneof![8 => Just(0_u32), 1 => 1..4_u32], 40),
        looks in prop::collection::vec(0..3_usize, 40),
    ) {
        let places = Places::new();
        let (mut half, mut next, mut halves) = (first, 0, Vec::new());
        for (late, looks) in late.into_iter().zip(looks) {
            half = half.wrapping_add(late);
            places.take(half);
            halves.push(half);
            half = half.wrapping_add(1);
            // The half before plays, and its first code has just been sampled.
            let now = sampled(end(half.wrapping_sub(3)));
            for _ in 0..looks {
                match places.find(next as u32, now) {
                    Search::Pending => break,
                    Search::Found(trigger) => {
                        prop_assert_eq!(trigger, halves[next].wrapping_mul(128).wrapping_add(1));
                        prop_assert!(now.until.wrapping_sub(trigger) >= 128 && now.until.wrapping_sub(trigger) < RING);
                        next += 1;
                    }
                    Search::Lost(blocks) => {
                        for lost in &halves[next..next + blocks as usize] {
                            let ago = now.until.wrapping_sub(lost.wrapping_mul(128).wrapping_add(1));
                            let is_forgotten = halves.len() - next > REMEMBERED;
                            prop_assert!(is_forgotten || (RING..1 << 20).contains(&ago), "{} codes ago", ago);
                        }
                        next += blocks as usize;
                    }
                }
            }
            prop_assert!(next <= halves.len());
        }
    }
}
