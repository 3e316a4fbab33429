//! The light of the felt edge.

use super::light;
use crate::check::{Checker, Colour, Conditions};
use crate::preset;

#[test]
fn the_felt_edge_is_green_on_the_plate_and_amber_at_its_end_and_where_nothing_is_felt() {
    for (name, boundary_m, level, colour, words) in [
        ("membrane", 0.12, 1.0, Colour::Green, "feels the tone end at 224 mm"),
        ("membrane", 0.27, 1.0, Colour::Amber, "up to the plate's end"),
        ("al-sh", 0.45, 0.1, Colour::Amber, "too weak"),
        ("al-bending", 0.15, 1.0, Colour::Amber, "below 20 kHz"),
        ("al-bending", 0.25, 1.0, Colour::Green, "its wave turns at 250 mm"),
    ] {
        let plate = preset(name).expect("a preset");
        let conditions = Conditions { level, ..Conditions::default() };
        let report = Checker::new(&plate, conditions).expect("checks").at(boundary_m).expect("on the plate");
        let light = light(&report, "felt edge");
        assert!(light.colour == colour && light.sentence.contains(words), "{name} {boundary_m}: {light:?}");
        assert_eq!((light.value.is_some(), light.unit), (colour == Colour::Green, "mm"));
    }
}
