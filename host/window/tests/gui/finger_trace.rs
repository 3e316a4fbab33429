//! The trace of the finger in the bottom row: amplitude, friction and speed over the last seconds.

use crate::background::open_plate;
use crate::finger::{choose, drag_by};
use crate::plots::words;
use crate::small_screens::{SIZES, screen, small};
use crate::test_app::TestApp;
use eframe::egui::{Key, Rect, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

/// What a lane says, and its place; `None` where there is no such lane.
fn lane(app: &TestApp, name: &str) -> Option<(String, Rect)> {
    let begins = format!("{name}: ");
    let node = app.window.query_by_label_contains(&begins)?;
    let said = node.accesskit_node().value()?;
    Some((said.strip_prefix(&begins)?.to_owned(), node.rect()))
}

/// The number that a lane says.
fn value(app: &TestApp, name: &str) -> f64 {
    let (said, _) = lane(app, name).unwrap();
    said.split(' ').next().unwrap().parse().unwrap()
}

fn says(app: &TestApp, text: &str) -> bool {
    words(app.window.output()).iter().any(|(word, _)| word == text)
}

#[test]
fn a_dragged_finger_leaves_a_trace_of_amplitude_and_speed_until_it_is_lifted() {
    let mut app = TestApp::driving();
    assert_eq!(lane(&app, "amplitude"), None);
    assert!(app.has("More: Drive waveform"));
    choose(&mut app, "Light");
    let at_peak = value(&app, "amplitude");
    assert!((10.0..180.0).contains(&at_peak), "micrometres, less than the free peak: {at_peak}");
    assert_eq!(value(&app, "speed"), 0.0);
    assert_eq!(lane(&app, "friction, illustrative"), None, "below 20 kHz");
    assert!(says(&app, "4 s ago") && says(&app, "now") && says(&app, "illustrative"));
    assert!(!app.has("More: Drive waveform"), "the trace stands in its place until a tab is chosen");
    drag_by(&mut app, &[4.0; 30]);
    assert!(value(&app, "speed") > 40.0, "{}", value(&app, "speed"));
    let beyond = value(&app, "amplitude");
    assert!(beyond < 0.7 * at_peak, "{at_peak} became {beyond}");
    app.wait(500);
    assert_eq!(value(&app, "speed"), 0.0, "it rests again");
    assert_eq!(value(&app, "amplitude"), beyond);
    choose(&mut app, "None");
    assert_eq!(lane(&app, "amplitude"), None);
    assert!(app.has("More: Drive waveform"));
    choose(&mut app, "Firm");
    look_back(&mut app, 0.3);
    assert_eq!(lane(&app, "amplitude").unwrap().0, "", "another touch, another trace");
}

#[test]
fn above_20_khz_the_trace_has_a_friction_that_is_called_illustrative() {
    let mut app = TestApp::driving();
    open_plate(&mut app, slipline_plate::preset("al-bending").unwrap().to_toml());
    app.wait(1500);
    choose(&mut app, "Firm");
    let friction = value(&app, "friction, illustrative");
    assert!((0.2..0.9).contains(&friction), "at the peak it slips: {friction}");
    drag_by(&mut app, &[5.0; 30]);
    assert!(value(&app, "friction, illustrative") > 0.95, "beyond the boundary it does not");
}

/// Holds the pointer over the time `seconds` before now.
fn look_back(app: &mut TestApp, seconds: f32) {
    let (_, rect) = lane(app, "speed").unwrap();
    app.hover(pos2(rect.right() - seconds / 4.0 * rect.width(), rect.center().y), 50);
}

#[test]
fn the_pointer_asks_for_what_was_met_at_a_time() {
    let mut app = TestApp::driving();
    choose(&mut app, "Light");
    let at_peak = value(&app, "amplitude");
    app.wait(1000);
    drag_by(&mut app, &[4.0; 20]);
    // Frames of the test's window are 1/60 s apart: the drag took 22 of them.
    look_back(&mut app, 0.5);
    assert!((value(&app, "amplitude") - at_peak).abs() < 0.5 && value(&app, "speed") == 0.0);
    assert!(says(&app, "0.5 s") && !says(&app, "illustrative"));
    look_back(&mut app, 0.2);
    assert!(value(&app, "amplitude") < at_peak - 1.0 && value(&app, "speed") > 60.0);
    look_back(&mut app, 3.0);
    assert_eq!(lane(&app, "amplitude").unwrap().0, "", "the trace began later");
}

#[test]
fn another_plate_begins_another_trace() {
    let mut app = TestApp::driving();
    choose(&mut app, "Light");
    app.wait(2500);
    look_back(&mut app, 0.6);
    assert_ne!(lane(&app, "amplitude").unwrap().0, "");
    app.window.hover_at(pos2(500.0, 500.0));
    let text = slipline_plate::preset("membrane").unwrap().to_toml();
    open_plate(&mut app, text.replace("name = \"membrane\"", "name = \"another\""));
    app.wait(500);
    assert!(app.is_driving() && value(&app, "amplitude") > 0.0);
    look_back(&mut app, 0.6);
    assert_eq!(lane(&app, "amplitude").unwrap().0, "", "nothing of the plate before");
}

#[test]
fn a_paused_trace_holds_and_one_at_rest_says_so() {
    let mut app = TestApp::driving();
    choose(&mut app, "Light");
    app.click("Pause: Finger trace", 100);
    let held = lane(&app, "amplitude").unwrap().0;
    drag_by(&mut app, &[4.0; 30]);
    assert_eq!(lane(&app, "amplitude").unwrap().0, held);
    app.click("Resume: Finger trace", 100);
    assert_ne!(lane(&app, "amplitude").unwrap().0, held);
    app.key(Key::Space, 500);
    assert_eq!(lane(&app, "amplitude"), None);
    let head = app.window.get_by_label("Drive waveform").rect();
    let resting = words(app.window.output());
    let (_, at) = resting.iter().find(|(word, _)| word == "nothing is driven").unwrap();
    assert!(at.center().y > head.bottom() && at.left() > head.left(), "{at} under {head}");
}

#[test]
fn the_lanes_fit_a_small_screen() {
    for size in SIZES {
        let mut app = small(size);
        open_plate(&mut app, slipline_plate::preset("al-bending").unwrap().to_toml());
        app.wait(1500);
        choose(&mut app, "Firm");
        // Where panel and plots take turns, the button that opens these.
        if let Some(plots) = app.window.query_by_label("Plots") {
            plots.click();
        }
        app.wait(100);
        let lanes = ["amplitude", "friction, illustrative", "speed"].map(|name| lane(&app, name).unwrap().1);
        for (i, rect) in lanes.iter().enumerate() {
            assert!(screen(size).contains_rect(*rect), "{size:?}: {rect}");
            assert!(rect.width() > 60.0 && rect.height() > 18.0, "{size:?}: {rect}");
            assert!(
                lanes.iter().skip(i + 1).all(|other| other.top() >= rect.bottom()),
                "{size:?}: {lanes:?}"
            );
        }
        let row = lanes[0].union(lanes[2]).expand2(vec2(80.0, 2.0));
        let inside = |(word, at): &(String, Rect)| !word.is_empty() && row.contains_rect(*at);
        let said: Vec<(String, Rect)> = words(app.window.output()).into_iter().filter(inside).collect();
        for part in ["amplitude", "friction", "speed", "µm", "mm/s"] {
            assert!(said.iter().any(|(word, _)| word.contains(part)), "{size:?} {part}: {said:?}");
        }
        for (i, (_, at)) in said.iter().enumerate() {
            // Lines of text lie close to each other, but not on each other.
            let clear = |other: &&(String, Rect)| !other.1.shrink(1.5).intersects(at.shrink(1.5));
            assert!(said.iter().skip(i + 1).all(|other| clear(&other)), "{size:?}: {said:?}");
        }
        let axis = words(app.window.output());
        let mut axis: Vec<&(String, Rect)> = axis
            .iter()
            .filter(|(word, _)| ["4 s ago", "illustrative", "now"].contains(&word.as_str()))
            .collect();
        axis.sort_by(|one, other| one.1.left().total_cmp(&other.1.left()));
        assert_eq!(axis.len(), 3);
        assert!(axis.windows(2).all(|pair| pair[0].1.right() + 2.0 < pair[1].1.left()), "{size:?}: {axis:?}");
        assert!(axis.iter().all(|(_, at)| at.top() > lanes[2].bottom() - 1.0), "{size:?}: {axis:?}");
    }
}
