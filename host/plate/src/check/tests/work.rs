//! The cost of the lights, by the solver's own count of its work.

use crate::check::prepared::SPAN_PLACES;
use crate::check::{Checker, Conditions};
use crate::frequency::driven_end::with_whole_end;
use crate::frequency::medium::LANES;
use crate::frequency::numerov::work;
use crate::{Progress, presets};

/// Every light over the span of a preset in 100 ms (`cargo bench -p slipline-plate` prints the time): a sweep of eight
/// frequencies takes about 0.2 ms on `al-bending`, and so does a grid.
#[test]
fn the_lights_of_a_preset_take_one_grid_for_each_plate_that_they_ask_about() {
    let groups = SPAN_PLACES.div_ceil(LANES);
    for preset in presets() {
        let plate = preset.plate().expect("a preset");
        let before = work::done();
        let checker = Checker::new(&plate, Conditions::default()).expect("checks");
        let prepared = work::done();
        // The plate itself, at most 8 other speeds and 2 losses, and the plate with the near field that its file
        // leaves out.
        let plates = prepared.grids - before.grids;
        assert!((7..=11).contains(&plates), "{}: {plates}", preset.name);
        let whole = usize::from(with_whole_end(&plate).is_some());
        let once = (2 * SPAN_PLACES - 1).div_ceil(LANES);
        assert_eq!(prepared.sweeps - before.sweeps, (1 + whole) * once, "{}", preset.name);
        checker.over_span(&mut Progress::unwatched()).expect("span");
        let all = work::done();
        // A level on each plate, and the amplitude of the plate itself.
        assert_eq!(all.sweeps - prepared.sweeps, groups * (plates + 1), "{}", preset.name);
        assert_eq!(all.grids - prepared.grids, groups, "{}", preset.name);
        // The finger load at each boundary.
        assert!(all.single - before.single <= SPAN_PLACES, "{}", preset.name);
    }
}

#[test]
fn a_boundary_on_a_prepared_plate_takes_one_sweep_for_each_plate() {
    let plate = crate::preset("al-bending").expect("preset");
    let checker = Checker::new(&plate, Conditions::default()).expect("checks");
    let before = work::done();
    checker.at(0.24).expect("on it");
    let after = work::done();
    assert_eq!((after.grids - before.grids, after.sweeps - before.sweeps), (1, 12));
    assert_eq!(after.single - before.single, 1, "the finger");
}
