//! The keyboard focus is visible.

use crate::test_app::TestApp;
use eframe::egui::{Rect, Shape, accesskit::Role};
use egui_kittest::kittest::Queryable as _;

/// The painted rings with a width of at least 2 points.
fn rings(app: &TestApp) -> Vec<Rect> {
    let rings = app.window.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Rect(rect) if rect.stroke.width >= 2.0 => Some(rect.rect),
        _ => None,
    });
    rings.collect()
}

#[test]
fn a_slider_that_has_the_keys_has_a_ring() {
    for (page, names) in [("Boundary", vec!["Level", "Master", "Glide"]), ("Tones", vec!["Level"])] {
        let mut app = TestApp::driving();
        app.click_button(page, 100);
        for name in names {
            let slider = app.window.get_by_role_and_label(Role::Slider, name).rect();
            let around = |app: &TestApp| rings(app).into_iter().any(|ring| ring.contains_rect(slider));
            assert!(!around(&app), "{name}");
            app.window.get_by_role_and_label(Role::Slider, name).focus();
            app.wait(100);
            assert!(around(&app), "{name}: {slider} {:?}", rings(&app));
        }
    }
}
