//! The third place, whose measurement checks the calibration by two ([`crate::calibrate::from_checked_ratio`]).

use super::information::Information;
use crate::calibrate::fit::checked::SAME;
use crate::quantity::{show_length, show_place};
use std::fmt;

/// Share of the way over the tried places by which the third place is away from the two: next to one of them it shows the same wave
/// again.
const APART: f64 = 0.15;

/// A third place that checks the calibration by two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckPlace {
    /// The place, metres from the driven end.
    pub place_m: f64,
    /// Half of the 95 % interval of the boundary by this place and the one of the two that is farther from it, metres.
    pub boundary_tolerance_m: f64,
    /// The distance of both results' boundaries from which on the calibration is refused, metres. A shorter one widens the stated
    /// interval where it is beyond it.
    pub refuses_m: f64,
}

impl CheckPlace {
    /// The place of `tried_m`, apart from both of the pair, that leaves the least interval of the boundary with the one of them that is
    /// farther from it. `known` is the information of sensors at places, `noise` that of an answer.
    pub(crate) fn of(
        (pair_m, boundary_m): ([f64; 2], f64),
        tried_m: &[f64],
        noise: f64,
        known: impl Fn(&[f64]) -> Option<Information>,
    ) -> Option<Self> {
        let from_m = |at_m: f64| pair_m.map(|of_pair_m| (at_m - of_pair_m).abs());
        let apart_m = APART * (tried_m.last()? - tried_m.first()?);
        let is_apart = |at_m: &f64| from_m(*at_m).iter().all(|from_m| *from_m >= apart_m);
        let places_m: Vec<f64> = pair_m.into_iter().chain(tried_m.iter().copied().filter(is_apart)).collect();
        let known = known(&places_m)?;
        let reached = places_m.iter().enumerate().skip(pair_m.len()).filter_map(|(i, &place_m)| {
            let [from_near_m, from_far_m] = from_m(place_m);
            let with = usize::from(from_far_m > from_near_m);
            Some((place_m, known.reached([with, i], noise)?.boundary_m))
        });
        let (place_m, boundary_tolerance_m) = reached.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let refuses_m = SAME * boundary_m.hypot(boundary_tolerance_m);
        Some(Self { place_m, boundary_tolerance_m, refuses_m })
    }
}

impl fmt::Display for CheckPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place_m, refuses_m, .. } = *self;
        let (place, refused) = (show_place(place_m), show_length(refuses_m));
        write!(
            formatter,
            "a third measurement at {place} checks the two: from {refused} between both results on the calibration is refused"
        )
    }
}
