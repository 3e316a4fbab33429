//! The order of short lists, in little code.
//!
//! The standard library compiles its stable sort again for each type and comparison, five kilobytes each time, which a browser
//! loads before the first picture. Here it is compiled once, for the places of the values.

use std::cmp::Ordering;

/// Sorts stably by `compare`, as [`slice::sort_by`] does: O(n log n) comparisons, one allocation.
pub fn sort_by<T>(values: &mut [T], compare: impl Fn(&T, &T) -> Ordering) {
    let mut order = places(values.len(), &|one, other| compare(&values[one], &values[other]));
    // Along each cycle of the permutation every value but one is moved once.
    for start in 0..order.len() {
        let mut at = start;
        loop {
            let from = std::mem::replace(&mut order[at], at);
            if from == start {
                break;
            }
            values.swap(at, from);
            at = from;
        }
    }
}

/// Sorts stably by a key, as [`slice::sort_by_key`] does.
pub fn sort_by_key<T, Key: Ord>(values: &mut [T], key: impl Fn(&T) -> Key) {
    sort_by(values, |one, other| key(one).cmp(&key(other)));
}

/// The middle one of the sorted values, the upper one of the two middle ones of an even number; `None` of an empty list.
#[must_use]
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The places of `count` values in the order of `compare`.
fn places(count: usize, compare: &dyn Fn(usize, usize) -> Ordering) -> Vec<usize> {
    let mut places: Vec<usize> = (0..count).collect();
    places.sort_by(|&one, &other| compare(one, other));
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_order_is_that_of_the_standard_library(keys in proptest::collection::vec(0_u8..20, 0..60)) {
            let numbered: Vec<(u8, usize)> = keys.into_iter().enumerate().map(|(at, key)| (key, at)).collect();
            let mut wanted = numbered.clone();
            wanted.sort_by_key(|&(key, _)| key);
            let mut sorted = numbered.clone();
            sort_by(&mut sorted, |one, other| one.0.cmp(&other.0));
            prop_assert_eq!(&sorted, &wanted);
            let mut sorted = numbered;
            sort_by_key(&mut sorted, |&(key, _)| key);
            prop_assert_eq!(sorted, wanted);
        }
    }
}
