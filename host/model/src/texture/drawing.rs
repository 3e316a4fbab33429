//! A wanted amplitude that is drawn stroke by stroke: a stroke replaces the part of the profile over which it goes.

use super::draft::{BREAKPOINTS_DRAWN_MAX, WishDraft, WishKind};

/// Knots of a drawing, uniform from 0 to the plate's end: every second of the places at which a texture is fitted, so that
/// two neighbours cover at least two of these.
const KNOTS: usize = 101;

impl WishDraft {
    /// Begins a drawing: no place of the plate is drawn yet.
    pub fn begin_drawing(&mut self) {
        self.kind = WishKind::Profile;
        self.profile.clear();
        self.level_m = None;
    }

    /// Draws along a path of places with the RMS displacement that is wanted there, both in metres; a path of one point is
    /// a dab. Between two stretches that are drawn the profile is a straight line; before the first and beyond the last one
    /// it is free. Points that are not finite are left out.
    pub fn draw(&mut self, path: &[(f64, f64)], length_m: f64) {
        let step_m = length_m / (KNOTS - 1) as f64;
        let unit_m = self.level_m.unwrap_or(0.0);
        let mut knots: Vec<(f64, Option<f64>)> = (0..KNOTS)
            .map(|knot| length_m * knot as f64 / (KNOTS - 1) as f64)
            .map(|place_m| (place_m, value_at(&self.profile, place_m).map(|amplitude| amplitude * unit_m)))
            .collect();
        let points: Vec<(f64, f64)> = path
            .iter()
            .filter(|(place_m, rms_m)| place_m.is_finite() && rms_m.is_finite())
            .map(|&(place_m, rms_m)| (place_m.clamp(0.0, length_m), rms_m.max(0.0)))
            .collect();
        let dab = points.first().map(|&first| [first, first]).filter(|_| points.len() == 1);
        let moves = points.windows(2).filter_map(|pair| <[(f64, f64); 2]>::try_from(pair).ok());
        for [from, to] in dab.into_iter().chain(moves) {
            stroke(&mut knots, from, to, step_m);
        }
        let mut drawn: Vec<(f64, f64)> =
            knots.into_iter().filter_map(|(place_m, rms_m)| Some((place_m, rms_m?))).collect();
        thin(&mut drawn);
        let largest_m = drawn.iter().map(|&(_, rms_m)| rms_m).fold(0.0, f64::max);
        let scale = if largest_m > 0.0 { largest_m.recip() } else { 0.0 };
        self.profile = drawn.into_iter().map(|(place_m, rms_m)| (place_m, rms_m * scale)).collect();
        self.level_m = Some(largest_m);
    }

    /// The drawn RMS displacement at a place, both in metres; `None` where nothing is drawn, and for a profile of no level.
    #[must_use]
    pub fn drawn_m(&self, place_m: f64) -> Option<f64> {
        Some(value_at(&self.profile, place_m)? * self.level_m?)
    }
}

/// The value of a profile at a place; `None` before its first and beyond its last breakpoint.
fn value_at(profile: &[(f64, f64)], place_m: f64) -> Option<f64> {
    let after = profile.partition_point(|point| point.0 < place_m);
    let &(end_m, end) = profile.get(after)?;
    if end_m == place_m {
        return Some(end);
    }
    let &(start_m, start) = profile.get(after.checked_sub(1)?)?;
    Some(start + (end - start) * (place_m - start_m) / (end_m - start_m))
}

/// Draws from one point to another, and a knot farther, so that a point alone is drawn, too.
fn stroke(knots: &mut [(f64, Option<f64>)], from: (f64, f64), to: (f64, f64), step_m: f64) {
    let ((near_m, near), (far_m, far)) = if from.0 <= to.0 { (from, to) } else { (to, from) };
    // What lies behind the pointer was drawn by the move before.
    let low_m = if to.0 <= from.0 { near_m - step_m } else { near_m };
    let high_m = if to.0 >= from.0 { far_m + step_m } else { far_m };
    for (place_m, value) in knots.iter_mut().filter(|(place_m, _)| (low_m..=high_m).contains(place_m)) {
        let share = ((*place_m - near_m) / (far_m - near_m)).clamp(0.0, 1.0);
        *value = Some(if far_m > near_m { near + (far - near) * share } else { to.1 });
    }
}

/// Leaves out the points nearest to the line between their neighbours, until there are few enough to be dragged.
fn thin(points: &mut Vec<(f64, f64)>) {
    while points.len() > BREAKPOINTS_DRAWN_MAX {
        let off = |triple: &[(f64, f64)]| {
            let [before, point, after] = *triple else { return f64::INFINITY };
            let share = (point.0 - before.0) / (after.0 - before.0);
            (before.1 + (after.1 - before.1) * share - point.1).abs()
        };
        let least = (1..points.len() - 1)
            .min_by(|&a, &b| off(&points[a - 1..=a + 1]).total_cmp(&off(&points[b - 1..=b + 1])));
        let Some(least) = least else { return };
        points.remove(least);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENGTH_M: f64 = 0.32;

    fn drawn(strokes: &[&[(f64, f64)]]) -> WishDraft {
        let mut draft = WishDraft::of(&slipline_plate::preset("membrane").unwrap());
        draft.begin_drawing();
        for stroke in strokes {
            draft.draw(stroke, LENGTH_M);
        }
        draft
    }

    #[test]
    fn a_stroke_is_the_profile_where_it_goes_and_leaves_the_rest_free() {
        // Backwards and forwards, in steps of a pointer.
        let there = [(0.05, 4e-6), (0.1, 4e-6), (0.2, 2e-6)];
        let back = [(0.2, 2e-6), (0.1, 4e-6), (0.05, 4e-6)];
        for path in [there, back] {
            let draft = drawn(&[&path]);
            assert_eq!((draft.kind, draft.level_m), (WishKind::Profile, Some(4e-6)));
            for (place_m, wanted) in [(0.06, 4e-6), (0.1, 4e-6), (0.15, 3e-6), (0.19, 2.2e-6)] {
                let is = draft.drawn_m(place_m).unwrap();
                assert!((is - wanted).abs() < 5e-8, "{place_m}: {is}");
            }
            assert_eq!((draft.drawn_m(0.04), draft.drawn_m(0.21)), (None, None));
            let largest = draft.profile.iter().map(|point| point.1).fold(0.0, f64::max);
            assert!(draft.profile.len() <= BREAKPOINTS_DRAWN_MAX && largest == 1.0, "{:?}", draft.profile);
            assert!(draft.profile.is_sorted_by(|a, b| a.0 < b.0), "{:?}", draft.profile);
        }
    }

    #[test]
    fn a_later_stroke_replaces_what_it_goes_over_and_no_more() {
        let draft = drawn(&[&[(0.02, 1e-6), (0.3, 1e-6)], &[(0.1, 5e-6), (0.14, 5e-6)]]);
        assert_eq!(draft.level_m, Some(5e-6));
        for (place_m, wanted) in [(0.05, 1e-6), (0.09, 1e-6), (0.12, 5e-6), (0.16, 1e-6), (0.29, 1e-6)] {
            let is = draft.drawn_m(place_m).unwrap();
            assert!((is - wanted).abs() < 1e-9, "{place_m}: {is}");
        }
        // A lower one lets the level fall again.
        let draft = drawn(&[&[(0.02, 1e-6), (0.3, 1e-6)], &[(0.1, 5e-6)], &[(0.09, 2e-6), (0.11, 2e-6)]]);
        assert_eq!(draft.level_m, Some(2e-6));
    }

    #[test]
    fn a_dab_is_wide_enough_to_be_fitted_and_nonsense_draws_nothing() {
        let dab = drawn(&[&[(0.1234, 3e-6)]]);
        let (first, last) = (dab.profile[0].0, dab.profile[dab.profile.len() - 1].0);
        assert!(first < 0.1234 && 0.1234 < last && last - first < 0.01, "{:?}", dab.profile);
        let none = drawn(&[&[(f64::NAN, 1e-6), (0.1, f64::INFINITY)], &[]]);
        assert!(none.profile.is_empty());
        // Beyond the ends it is drawn at the end, and nothing is less than still.
        let ends = drawn(&[&[(-1.0, 1e-6), (9.0, -1.0)]]);
        assert_eq!((ends.drawn_m(0.0), ends.drawn_m(LENGTH_M)), (Some(1e-6), Some(0.0)));
        assert_eq!(drawn(&[&[(0.1, 0.0)]]).level_m, Some(0.0));
    }

    #[test]
    fn a_scribble_keeps_to_as_many_breakpoints_as_can_be_dragged() {
        let scribble: Vec<(f64, f64)> = (0..400)
            .map(|i| f64::from(i) / 400.0)
            .map(|t| (t * LENGTH_M, 1e-6 * (1.0 + (40.0 * t).sin())))
            .collect();
        let draft = drawn(&[&scribble]);
        assert_eq!(draft.profile.len(), BREAKPOINTS_DRAWN_MAX);
        let off = scribble.iter().map(|&(place_m, rms_m)| (draft.drawn_m(place_m).unwrap() - rms_m).abs());
        assert!(off.fold(0.0, f64::max) < 0.25e-6);
    }
}
