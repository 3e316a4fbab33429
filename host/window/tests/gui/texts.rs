//! No text lies over another and none is cut, at every size of window that is supported, on every page.

use crate::test_app::TestApp;
use eframe::egui::accesskit::Role;
use eframe::egui::epaint::ClippedShape;
use eframe::egui::{Color32, FullOutput, Key, Modifiers, Rect, Shape, Vec2, vec2};
use egui_kittest::kittest::Queryable as _;
use slipline_window::settings::ThemeChoice;
use std::collections::BTreeSet;

/// Sizes in points and pixels per point: a laptop, small panel displays, a telephone in both directions, the least width, and
/// 1280 x 800 pixels at 2 a point.
const SIZES: [([f32; 2], f32); 8] = [
    ([1280.0, 800.0], 1.0),
    ([1280.0, 720.0], 1.0),
    ([800.0, 480.0], 1.0),
    ([640.0, 480.0], 1.0),
    ([390.0, 844.0], 1.0),
    ([844.0, 390.0], 1.0),
    ([360.0, 740.0], 1.0),
    ([640.0, 400.0], 2.0),
];
/// Two texts lie over each other from this overlap on, in points, in both directions.
const OVERLAP: f32 = 1.5;
/// Height of the status line, in points.
const STATUS: f32 = 34.0;
/// A text counts as cut if more of its width than this is hidden, in points.
const CUT: f32 = 1.0;

/// A text that is painted, in points.
#[derive(Clone)]
struct Text {
    words: String,
    /// All of its ink, and the part that is not clipped away.
    whole: Rect,
    seen: Rect,
    /// Whether its end is replaced by an ellipsis.
    is_elided: bool,
}

/// The texts of a picture that can be seen, without those that a later area hides.
fn texts(picture: &FullOutput) -> Vec<Text> {
    fn collect(shape: &Shape, clip: Rect, texts: &mut Vec<Text>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, texts)),
            Shape::Rect(area) if area.fill.is_opaque() => {
                let hidden = area.rect.intersect(clip).expand(1.0);
                texts.retain(|text| !hidden.contains_rect(text.seen));
            }
            Shape::Text(text) => {
                let rows: Vec<String> = text.galley.rows.iter().map(|row| row.text()).collect();
                let (words, whole) = (rows.join(" "), text.visual_bounding_rect());
                let seen = whole.intersect(clip);
                let ink = text.override_text_color.unwrap_or(text.fallback_color);
                let is_seen = seen.is_positive() && ink != Color32::TRANSPARENT && text.opacity_factor > 0.0;
                if is_seen && !words.trim().is_empty() {
                    texts.push(Text { words, whole, seen, is_elided: text.galley.elided });
                }
            }
            _ => {}
        }
    }
    let mut texts = Vec::new();
    for ClippedShape { shape, clip_rect, .. } in &picture.shapes {
        collect(shape, *clip_rect, &mut texts);
    }
    texts
}

/// Whether the end of a text may be left out: names that a user gives may be of any length, and all of the name is shown under
/// the pointer; a message that two rows cannot hold opens when it is pressed.
fn may_be_elided(app: &TestApp, text: &Text) -> bool {
    let start = text.words.trim_end_matches('…');
    if text.seen.center().y > app.window.ctx.content_rect().bottom() - STATUS {
        return true;
    }
    app.window.state().setup().plate.name().starts_with(start)
}

/// What is wrong with the texts of the present picture.
fn wrong(app: &TestApp) -> BTreeSet<String> {
    let screen = app.window.ctx.content_rect();
    let texts = texts(app.window.output());
    let mut wrong = BTreeSet::new();
    // What is typed in a field scrolls there.
    let fields: Vec<Rect> = app.window.query_all_by_role(Role::TextInput).map(|node| node.rect()).collect();
    for (number, text) in texts.iter().enumerate() {
        let Text { words, whole, seen, is_elided } = text;
        if *is_elided && !may_be_elided(app, text) {
            wrong.insert(format!("{words:?} is shortened"));
        }
        let is_typed = fields.iter().any(|field| field.expand(2.0).contains(seen.center()));
        let is_cut = seen.left() > whole.left() + CUT || seen.right() < whole.right() - CUT;
        if is_cut && !is_typed {
            wrong.insert(format!("{words:?} is cut: {whole} to {seen}"));
        }
        if !screen.expand(CUT).contains_rect(*seen) {
            wrong.insert(format!("{words:?} is not on the screen: {seen}"));
        }
        for other in texts.iter().skip(number + 1) {
            let both = seen.intersect(other.seen);
            if both.width() > OVERLAP && both.height() > OVERLAP {
                wrong.insert(format!("{words:?} at {seen} and {:?} at {}", other.words, other.seen));
            }
        }
    }
    let stop = app.window.get_by_label("STOP").rect();
    if !screen.contains_rect(stop) {
        wrong.insert(format!("STOP is not on the screen: {stop}"));
    }
    let state = app.window.get_by_label_contains("State: ").rect();
    let status = app.window.get_by_label_contains("the log").rect();
    for (name, rect) in [("The state", state), ("The status line", status)] {
        if !screen.contains_rect(rect) {
            wrong.insert(format!("{name} is not on the screen: {rect}"));
        }
    }
    wrong
}

/// Opens a page of the panel, the plots, or takes the brush in the hand.
fn open(app: &mut TestApp, page: &str) {
    let tabs = ["Boundary", "Tones", "Texture", "Plate", "Device", "Play"];
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];
    let tab = match page {
        "Brush" => "Texture",
        "This plate" | "Validity" | "Designer" | "Measure" => "Plate",
        page => page,
    };
    if let Some((_, key)) = tabs.iter().zip(keys).find(|(name, _)| **name == tab) {
        app.keys(Modifiers::COMMAND, key, 100);
    }
    // In a large window the plots are always there.
    if tabs.contains(&page) || (page == "Plots" && !app.has("Plots")) {
        return;
    }
    // What was drawn at another size stays.
    if app.has("Drawing area") {
        return;
    }
    app.click_button(page, 100);
    if page == "Brush" {
        crate::brush::stroke(app, &[(0.06, 0.1), (0.8, 0.3)]);
    }
}

/// Shows the app at every size, on every page that `pages` opens; returns what is wrong.
fn check(start: impl Fn() -> TestApp, pages: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    let mut app = start();
    for (size, density) in SIZES {
        if density != 1.0 {
            // A density that changes while the window is open leaves another zoom.
            app = start();
        }
        app.window.set_pixels_per_point(density);
        // A low window is zoomed, as a system's window of this size is.
        for _ in 0..4 {
            let points = Vec2::from(size) / app.window.ctx.zoom_factor();
            app.resize(points, 50);
        }
        for page in pages {
            open(&mut app, page);
            app.wait(200);
            found.extend(wrong(&app).into_iter().map(|what| format!("{size:?} x {density}, {page}: {what}")));
        }
    }
    found
}

const PAGES: [&str; 10] = [
    "Boundary",
    "Tones",
    "Texture",
    "This plate",
    "Validity",
    "Designer",
    "Measure",
    "Device",
    "Play",
    "Plots",
];

fn assert_none(found: &[String]) {
    assert!(found.is_empty(), "{}\n{} in all", found.join("\n"), found.len());
}

#[test]
fn no_text_is_cut_or_lies_over_another_at_a_first_start() {
    let first = || {
        let builder = egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]);
        TestApp::first_start(ThemeChoice::Light, builder)
    };
    assert_none(&check(first, &PAGES));
}

#[test]
fn the_line_above_the_plate_is_whole_at_every_width() {
    let mut app = TestApp::first_start(ThemeChoice::Dark, egui_kittest::HarnessBuilder::default());
    let mut found = Vec::new();
    for width in (640..1280).step_by(40) {
        for _ in 0..4 {
            let points = vec2(width as f32, 320.0) / app.window.ctx.zoom_factor();
            app.resize(points, 50);
        }
        // What is drawn, and a port's name, may be shortened.
        let wrong = wrong(&app).into_iter().filter(|what| !what.ends_with("is shortened"));
        found.extend(wrong.map(|what| format!("{width}: {what}")));
    }
    assert_none(&found);
}

#[test]
fn no_text_is_cut_or_lies_over_another_with_ten_tones() {
    let ten = || {
        let mut app = TestApp::driving();
        for _ in 0..9 {
            crate::add_tone(&mut app);
        }
        app
    };
    assert_none(&check(ten, &["Boundary", "Tones", "Texture", "Plots"]));
}

#[test]
fn no_text_is_cut_or_lies_over_another_where_lights_fail_and_a_drawing_is_made() {
    let failing = || {
        let mut app = TestApp::driving();
        crate::light_marks::open(&mut app, "al-bending-displacement", 0.15);
        app
    };
    assert_none(&check(failing, &["Boundary", "Texture", "Validity", "Plots"]));
    // A stroke changes the tones: apart from the others.
    assert_none(&check(failing, &["Brush"]));
}

#[test]
fn no_text_is_cut_or_lies_over_another_over_a_time_line() {
    let recorded = || {
        let mut app = TestApp::driving();
        app.open("drag.csv", Ok("time_s,tone,place_m\n0,1,0.18\n1,1,0.2\n2,1,0.24\n".to_owned()));
        app.click("Dismiss", 300);
        app
    };
    assert_none(&check(recorded, &["Play", "Boundary"]));
}

/// What another program measured, with columns that must be chosen: the highest page of the panel.
#[test]
fn a_foreign_file_cuts_nothing_of_the_page_of_measurements() {
    let foreign = || {
        let mut app = TestApp::driving();
        let text = crate::measure::measured(&crate::measure::membrane(1.0), 0.032, 12.0).to_frd();
        crate::measure::open_measure(&mut app);
        crate::foreign::drop_file(
            &mut app,
            "what the laser vibrometer wrote on Tuesday.frd",
            text.as_bytes(),
        );
        app
    };
    assert_none(&check(foreign, &["Measure"]));
    let mut app = foreign();
    app.resize(vec2(1280.0, 720.0), 200);
    for name in ["Take it", "Leave it", "Open measurement…", "Calibrate…"] {
        let rect = app.window.get_by_role_and_label(Role::Button, name).rect();
        assert!(rect.right() <= 1280.0 && rect.bottom() <= 690.0 && rect.height() > 12.0, "{name}: {rect}");
    }
}

#[test]
fn the_page_boundary_is_whole_at_1280_by_720() {
    let bench = slipline_instrument::bench::Bench::default();
    let mut app = TestApp::unseen(bench.inputs(), bench);
    app.resize(vec2(1280.0, 720.0), 200);
    let screen = app.window.ctx.content_rect();
    let status = texts(app.window.output()).into_iter().find(|text| text.words.contains("The device drives"));
    let status = status.map_or(screen.bottom(), |status| status.seen.top());
    for name in ["Boundary position", "Level", "Master", "Glide", "Feeling, illustrative", "Hold the level"] {
        let nodes: Vec<Rect> = app.window.query_all_by_label(name).map(|node| node.rect()).collect();
        assert!(!nodes.is_empty(), "{name} is not shown");
        for rect in nodes {
            assert!(rect.height() > 10.0 && rect.bottom() <= status, "{name}: {rect} of {screen}");
        }
    }
    // Nothing of it is left to be scrolled to.
    let below = app.window.get_by_role_and_label(Role::CheckBox, "Hold the level").rect();
    app.turn_wheel(below.center(), -400.0);
    assert_eq!(app.window.get_by_role_and_label(Role::CheckBox, "Hold the level").rect(), below);
}

#[test]
fn a_refusal_a_recording_and_another_selected_tone_move_nothing() {
    let mut app = TestApp::driving();
    crate::add_tone(&mut app);
    let place = |app: &TestApp, name: &str| {
        app.window.query_all_by_label(name).map(|node| node.rect()).collect::<Vec<_>>()
    };
    let levels = ["Level of tone 1", "Level of tone 2", "Remove tone 2"];
    let before = levels.map(|name| place(&app, name));
    crate::type_into(&mut app, "Position of tone 1", "9 m");
    app.wait(100);
    assert!(app.shows("9 m"), "it is refused");
    assert_eq!(levels.map(|name| place(&app, name)), before, "a refused place");
    crate::type_into(&mut app, "Position of tone 1", "120 mm");
    app.keys(Modifiers::COMMAND, Key::Num1, 100);
    let fields = ["Boundary position", "Boundary frequency", "Level", "Master", "Finger: None"];
    let before = fields.map(|name| place(&app, name));
    app.keys(Modifiers::COMMAND, Key::Num2, 100);
    app.click("Select tone 1", 100);
    app.keys(Modifiers::COMMAND, Key::Num1, 100);
    assert_eq!(fields.map(|name| place(&app, name)), before, "another tone");
    app.keys(Modifiers::COMMAND, Key::Num6, 100);
    let views = ["Plate from above", "Envelope", "Speed", "Import…"];
    let before = views.map(|name| place(&app, name));
    app.open("drag.csv", Ok("time_s,tone,place_m\n0,1,0.18\n1,1,0.2\n2,1,0.24\n".to_owned()));
    app.click("Dismiss", 300);
    assert_eq!(views.map(|name| place(&app, name)), before, "a recording");
}
