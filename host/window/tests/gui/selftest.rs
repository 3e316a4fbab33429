//! The page of the board's self-test.

use crate::test_app::TestApp;
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;

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

#[test]
fn the_amplifier_is_tested_by_itself_on_the_same_page() {
    let bench = Bench::default();
    let mut app = TestApp::sensed(bench.inputs(), bench);
    app.click_button("Device", 200);
    app.window.get_by_role_and_label(Role::Button, "Test this board…").scroll_to_me();
    app.wait(300);
    app.click_button("Test this board…", 900);
    app.click("The amplifier is unplugged", 200);
    app.click("Test the amplifier, connected and switched on", 200);
    let unplugged = app.window.get_by_label("The amplifier is unplugged").accesskit_node().is_disabled();
    assert!(unplugged && app.shows("Quiet tones at -40 dB"));
    app.click_button("Test", 500);
    for _ in 0..150 {
        if app.has("Test") {
            break;
        }
        app.wait(200);
    }
    for (step, verdict) in [("amplifier", "green"), ("mute", "green"), ("codes", "skipped")] {
        assert!(app.has(&format!("{step}: {verdict}")), "{step}");
    }
    assert!(!app.is_driving());
}
