//! The page of the board's self-test.

use crate::test_app::TestApp;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;

#[test]
fn the_page_shows_the_steps_as_lights() {
    let mut app = TestApp::driving();
    app.click_button("Device", 200);
    app.window.get_by_role_and_label(Role::Button, "Test this board…").scroll_to_me();
    app.wait(300);
    app.click_button("Test this board…", 900);
    assert!(app.has("Test this board") && !app.has("supply: green"));
    app.click("In three seconds", 200);
    app.click_button("Test", 500);
    assert!(app.has("Cancel the test"));
    for _ in 0..150 {
        if app.has("Test") {
            break;
        }
        app.wait(200);
    }
    for (step, verdict) in
        [("supply", "green"), ("codes", "green"), ("DAC to ADC", "skipped"), ("stall", "skipped")]
    {
        assert!(app.has(&format!("{step}: {verdict}")), "{step}");
    }
    // The board is disarmed, and holds the plate's table again.
    assert!(!app.is_driving());
}
