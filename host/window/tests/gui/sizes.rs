//! The window at sizes and zooms that are too small for its content.

use crate::test_app::TestApp;
use eframe::egui::{Key, Modifiers, Vec2, vec2};
use egui_kittest::kittest::Queryable as _;

#[test]
fn no_window_is_too_small_to_be_shown() {
    let mut app = TestApp::driving();
    let zoomed = (10..=50).step_by(5).map(|tenths| vec2(1280.0, 800.0) * 10.0 / tenths as f32);
    let tiny = [[500.0, 350.0], [960.0, 100.0], [100.0, 620.0], [40.0, 40.0], [1.0, 1.0]].map(Vec2::from);
    for size in zoomed.chain(tiny) {
        app.window.set_size(size);
        for tab in [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6] {
            app.keys(Modifiers::COMMAND, tab, 100);
        }
    }
    for page in ["Validity", "Designer", "Measure"] {
        app.window.set_size(vec2(1280.0, 800.0));
        app.keys(Modifiers::COMMAND, Key::Num4, 100);
        app.click(page, 100);
        for size in tiny {
            app.resize(size, 100);
        }
    }
    assert!(app.is_driving());
}

/// Presses a key with Ctrl, in a window that keeps its size on the screen as a system's window does.
fn zoom(app: &mut TestApp, key: Key, size: Vec2) -> Vec2 {
    app.window.key_press_modifiers(Modifiers::COMMAND, key);
    for _ in 0..4 {
        app.wait(50);
        let points = size / app.window.ctx.zoom_factor();
        app.window.set_size(points);
    }
    app.window.ctx.content_rect().size()
}

#[test]
fn the_zoom_ends_where_the_window_could_not_be_used() {
    for (size, most) in [([1280.0, 800.0], 1.5), ([1920.0, 1080.0], 2.0), ([500.0, 420.0], 1.0)] {
        let mut app = TestApp::driving();
        let size = Vec2::from(size);
        for _ in 0..30 {
            zoom(&mut app, Key::Plus, size);
        }
        let seen = app.window.ctx.zoom_factor();
        assert!((seen - most).abs() < 1e-3, "{size}: {seen}");
        let room = zoom(&mut app, Key::Minus, size);
        assert!((room * (most - 0.1) - size).abs().max_elem() < 1.0, "{size}: {room}");
    }
}

#[test]
fn a_page_that_its_browser_magnifies_to_300_percent_keeps_a_plate() {
    let mut app = TestApp::driving();
    // 1280 x 720 pixels at 3 pixels a point.
    let resized = |app: &mut TestApp, size: Vec2| {
        for _ in 0..4 {
            let points = size / app.window.ctx.zoom_factor();
            app.resize(points, 50);
        }
        app.window.ctx.zoom_factor()
    };
    assert_eq!(resized(&mut app, vec2(427.0, 240.0)), 0.6);
    let screen = app.window.ctx.content_rect();
    let [line, stop] = [crate::line_rect(&app), app.window.get_by_label("STOP").rect()];
    assert!(line.height() > 150.0 && screen.contains_rect(line), "{line} {screen}");
    assert!(screen.contains_rect(stop), "{stop} {screen}");
    assert_eq!(resized(&mut app, vec2(1280.0, 800.0)), 1.0);
}

#[test]
fn what_is_in_the_top_bar_never_lies_over_its_neighbour() {
    let mut app = TestApp::driving();
    for width in (640..=1280).step_by(20) {
        app.resize(vec2(width as f32, 620.0), 100);
        let mut seen: Vec<(String, eframe::egui::Rect)> = Vec::new();
        for name in ["Slipline", "File", "Edit", "View", "Help", "Device: ", "State: ", "round trip", "STOP"]
        {
            let nodes = app.window.query_all_by_label_contains(name);
            seen.extend(
                nodes.map(|node| (name.to_owned(), node.rect())).filter(|(_, rect)| rect.top() < 40.0),
            );
        }
        assert!(seen.len() >= 7, "{width}: {seen:?}");
        for (i, (name, rect)) in seen.iter().enumerate() {
            assert!(rect.right() <= width as f32, "{width}: {name} {rect}");
            for (other, at) in seen.iter().skip(i + 1) {
                assert!(!rect.shrink(1.0).intersects(at.shrink(1.0)), "{width}: {name} {rect}, {other} {at}");
            }
        }
        let is_told = seen.iter().any(|(name, _)| name == "round trip");
        assert!(is_told || width < 900, "{width}: there is room for the round trip");
    }
}

#[test]
fn the_logs_controls_stay_in_the_window() {
    let mut app = TestApp::driving();
    for width in (360..=1280).step_by(40) {
        app.resize(vec2(width as f32, 620.0), 100);
        if !app.has("Log") {
            app.click("Open the log", 100);
        }
        let head = app.window.get_by_label("Log").rect();
        for name in ["Log level", "Copy"] {
            let rect = app.window.get_by_label(name).rect();
            assert!(
                rect.right() <= width as f32 && rect.left() >= head.right(),
                "{width}: {name} {rect} {head}"
            );
        }
        let filter = app.window.get_by_label("Filter the log").rect();
        assert!(filter.left() >= head.right(), "{width}: {filter} {head}");
    }
}

#[test]
fn explanations_are_no_smaller_than_twelve_points() {
    let app = TestApp::driving();
    let style = app.window.ctx.global_style();
    assert!(eframe::egui::TextStyle::Small.resolve(&style).size >= 12.0);
}
