//! STOP is visible and can be pressed in every state of the window, at every size.

use crate::painter::Painter;
use crate::real_device;
use crate::test_app::{TestApp, click, opened};
use eframe::egui::{Color32, Key, Theme, Vec2, vec2};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::Queryable as _;
use slipline_link::Request;
use slipline_link::protocol::event::State;
use slipline_window::settings::ThemeChoice;

fn press_stop(app: &mut TestApp, while_what: &str) {
    app.take_sent();
    app.click("STOP", 200);
    assert!(app.take_sent().iter().any(|request| matches!(request, Request::Stop)), "{while_what}");
    assert!(!app.is_driving(), "{while_what}");
}

#[test]
fn one_click_on_stop_stops_with_any_page_or_menu_open() {
    for entry in ["Shortcuts", "Ports and permissions", "About Slipline"] {
        let mut app = TestApp::driving();
        app.click("Help", 200);
        app.click_part(entry, 200);
        assert!(app.has("Close"), "{entry} is open");
        press_stop(&mut app, entry);
    }
    for menu in ["File", "Edit", "View", "Help"] {
        let mut app = TestApp::driving();
        app.click(menu, 200);
        press_stop(&mut app, menu);
    }
}

#[test]
fn one_click_on_stop_stops_while_a_request_waits_for_confirmation() {
    let link = real_device(State::Idle);
    let mut window = opened(link.clone(), [1280.0, 800.0]);
    click(&mut window, "Arm…");
    assert!(window.query_by_label("Cancel").is_some());
    click(&mut window, "STOP");
    let sent = link.sent.borrow();
    assert!(sent.iter().any(|request| matches!(request, Request::Stop)), "{sent:?}");
    assert!(!sent.iter().any(|request| matches!(request, Request::Arm | Request::ArmFor(_))), "{sent:?}");
}

#[test]
fn stop_is_as_bright_behind_a_page_as_without_one() {
    let painter = Painter::default();
    let builder = HarnessBuilder::default()
        .with_size([1280.0, 800.0])
        .with_theme(Theme::Light)
        .renderer(painter.clone());
    let mut app = TestApp::driving_with(ThemeChoice::Light, builder);
    let look = |app: &mut TestApp| -> (Color32, Color32) {
        let seen = painter.paint(&app.window.ctx, app.window.output(), [1280, 800]);
        let stop = app.window.get_by_label("STOP").rect().left_center() + vec2(8.0, 0.0);
        let at = |x: f32, y: f32| seen.pixels[y as usize * 1280 + x as usize];
        (at(stop.x, stop.y), at(1100.0, 400.0))
    };
    let before = look(&mut app);
    app.key(Key::F1, 300);
    let behind = look(&mut app);
    assert_eq!(behind.0, before.0, "STOP");
    assert_ne!(behind.1, before.1, "the window behind the page is dimmed");
}

#[test]
fn stop_stays_in_a_window_that_is_too_small_for_the_rest() {
    let mut app = TestApp::driving();
    for size in [[960.0, 620.0], [640.0, 400.0], [500.0, 350.0], [256.0, 160.0]] {
        app.resize(Vec2::from(size), 100);
        let stop = app.window.get_by_label("STOP").rect();
        // A low window is shown smaller.
        assert!(app.window.ctx.content_rect().contains_rect(stop), "{size:?}: {stop}");
    }
    press_stop(&mut app, "in a small window");
}
