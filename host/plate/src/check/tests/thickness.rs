//! The light of a plate that is too thick for its wave or its width.

use super::{light, report, value};
use crate::check::{Checker, Colour, Conditions};
use crate::{DriveEnd, Model, Plate, preset};

#[test]
fn thin_plate_theory_is_off_by_what_mindlin_says() {
    // 2 mm aluminium: the thick plate's wavenumber is larger by 1.5 % at 20 kHz, 2.9 % at 40 kHz.
    let twenty = report("al-bending", 0.939 / 4.62);
    assert!((value(&twenty, "thin plate") - 1.5).abs() < 0.1, "{}", value(&twenty, "thin plate"));
    let forty = report("al-bending", 1.286 / 4.62);
    assert!((value(&forty, "thin plate") - 2.9).abs() < 0.25, "{}", value(&forty, "thin plate"));
    assert_eq!(light(&forty, "thin plate").colour, Colour::Amber);
    assert_eq!(light(&report("membrane", 0.16), "thin plate").colour, Colour::Green);
}

#[test]
fn steel_thicker_than_wide_is_no_plate_even_when_it_is_taken_as_thick() {
    let mut spec = preset("al-bending").expect("preset").spec().clone();
    spec.drive_end = DriveEnd::Displacement;
    for (thick_plate, thickness_m, wanted) in
        [(true, 1.8 * 0.0126, Colour::Red), (true, 0.003, Colour::Amber), (true, 0.002, Colour::Green)]
    {
        let Model::BendingSupported(bending) = &mut spec.model else { panic!("bending") };
        (bending.thick_plate, bending.thickness_m) = (thick_plate, thickness_m);
        let plate = Plate::new(spec.clone()).expect("plate");
        let report = Checker::new(&plate, Conditions::default()).expect("checks").at(0.25).expect("on it");
        assert_eq!(light(&report, "thin plate").colour, wanted, "{thickness_m}");
    }
}
