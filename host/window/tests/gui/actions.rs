//! Each page has one action that is due at most, and it is filled with the accent colour.

use crate::calibrate::{go_through, open_calibration};
use crate::test_app::TestApp;
use eframe::egui::{Color32, Key, Modifiers, Rect, Shape, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

/// The accent colour of the light theme.
const ACCENT: Color32 = Color32::from_rgb(0x1f, 0x5f, 0xb4);

/// The buttons that are filled with the accent colour, of the dialog if there is one: what lies behind it is dimmed.
fn due(app: &TestApp) -> Vec<String> {
    let shapes = app.window.output().shapes.iter();
    let rects: Vec<(Rect, Color32)> = shapes
        .filter_map(|clipped| match &clipped.shape {
            Shape::Rect(shape) => Some((shape.rect, shape.fill)),
            _ => None,
        })
        .collect();
    let window = app.window.ctx.content_rect();
    let dims = |(rect, fill): &(Rect, Color32)| rect.contains_rect(window) && (1..255).contains(&fill.a());
    let front = rects.iter().rposition(dims).unwrap_or(0);
    let is_filled = |at: Rect| {
        rects[front..].iter().any(|(rect, fill)| {
            *fill == ACCENT && rect.height() > 16.0 && (rect.center() - at.center()).length() < 2.0
        })
    };
    let buttons = app.window.query_all_by_role(Role::Button);
    buttons.filter(|node| is_filled(node.rect())).filter_map(|node| node.accesskit_node().label()).collect()
}

#[test]
fn every_page_and_dialog_has_one_action_that_is_due_at_most() {
    let mut app = TestApp::driving();
    for (page, wanted) in [
        ("Boundary", None),
        ("Tones", Some("Add tone")),
        ("Texture", Some("Play this")),
        ("Device", None),
        ("Play", Some("Record")),
        ("Plate", None),
        ("Validity", Some("Check in two dimensions")),
        ("Designer", Some("Use this plate")),
        ("Measure", Some("Measure now")),
    ] {
        app.click_button(page, 200);
        assert_eq!(due(&app), Vec::from_iter(wanted), "{page}");
    }
    app.files.has_no_dialogs.set(true);
    app.window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    // It fades in.
    app.wait(900);
    assert_eq!(due(&app), ["Save"]);
    app.click_button("Cancel", 200);
    app.files.has_no_dialogs.set(false);
    open_calibration(&mut app);
    app.wait(900);
    assert_eq!(due(&app), ["Next"]);
    app.click_button("Next", 200);
    app.click_button("Next", 200);
    assert_eq!(due(&app), ["Measure now"], "before the answer arrives");
    app.click_button("Cancel", 200);
    go_through(&mut app, &crate::calibrate::answers(1.02));
    assert_eq!(due(&app), ["Use this plate"]);
}
