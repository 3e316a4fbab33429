//! It is seen where the keys go.

use crate::bench::Bench;
use eframe::egui::{Rect, Shape, accesskit::Role};
use egui_kittest::kittest::Queryable as _;

/// Rings of 2 points and more that are painted.
fn rings(bench: &Bench) -> Vec<Rect> {
    let rings = bench.window.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Rect(rect) if rect.stroke.width >= 2.0 => Some(rect.rect),
        _ => None,
    });
    rings.collect()
}

#[test]
fn a_slider_that_has_the_keys_has_a_ring() {
    for (page, names) in [("Boundary", vec!["Level", "Master", "Glide"]), ("Tones", vec!["Level"])] {
        let mut bench = Bench::driving();
        bench.window.get_by_role_and_label(Role::Button, page).click();
        bench.wait(100);
        for name in names {
            let slider = bench.window.get_by_role_and_label(Role::Slider, name).rect();
            let around = |bench: &Bench| rings(bench).into_iter().any(|ring| ring.contains_rect(slider));
            assert!(!around(&bench), "{name}");
            bench.window.get_by_role_and_label(Role::Slider, name).focus();
            bench.wait(100);
            assert!(around(&bench), "{name}: {slider} {:?}", rings(&bench));
        }
    }
}
