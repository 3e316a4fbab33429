//! The texture page: a target is drawn, typed or read; the reachable texture is described, played and saved.

use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, Pos2, Rect, accesskit::Role, pos2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_model::setup::file::{self as setup_file, Opened};
use std::path::PathBuf;

/// The texture page, with its first draft made.
pub(crate) fn open_textures(app: &mut TestApp) {
    app.click_button("Texture", 300);
}

pub(crate) fn choose(app: &mut TestApp, kind: &str) {
    app.click_button(kind, 300);
}

/// Opens a profile with the page's button.
pub(crate) fn open_profile(app: &mut TestApp, name: &str, bytes: Result<Vec<u8>, String>) {
    *app.files.profiles.borrow_mut() = vec![(PathBuf::from(name), bytes)];
    app.click("Open profile…", 300);
}

fn has(app: &TestApp, part: &str) -> bool {
    app.has_part(part)
}

/// Place in mm of each breakpoint.
fn breakpoints_mm(app: &TestApp) -> Vec<f64> {
    let point = |number: usize| {
        let name = format!("Breakpoint {number}");
        let handle = app.window.query_by_role_and_label(Role::Slider, &name)?;
        handle.accesskit_node().numeric_value()
    };
    (1..).map_while(point).collect()
}

fn breakpoint_at(app: &TestApp, number: usize) -> Pos2 {
    app.window.get_by_role_and_label(Role::Slider, &format!("Breakpoint {number}")).rect().center()
}

fn drag(app: &mut TestApp, from: Pos2, to: Pos2) {
    app.grab(from, 50);
    app.hover(to, 50);
    app.release(to, 300);
}

#[test]
fn a_profile_is_drawn_played_undone_and_saved() {
    let mut app = TestApp::driving();
    open_textures(&mut app);
    let plot = app.window.get_by_label("Texture over the plate").rect();
    assert_eq!(breakpoints_mm(&app).len(), 4);
    // Pressing between two points adds one there, which the pointer holds.
    let between = breakpoint_at(&app, 1) + 0.5 * (breakpoint_at(&app, 2) - breakpoint_at(&app, 1));
    drag(&mut app, between, between + 0.2 * (plot.left_bottom() - plot.left_top()));
    let five = breakpoints_mm(&app);
    assert!(five.len() == 5 && five.is_sorted(), "{five:?}");
    // A breakpoint stays between its neighbours, and its amplitude at most 1.
    let last = breakpoint_at(&app, 4);
    drag(&mut app, last, pos2(plot.left(), plot.top() - 300.0));
    let dragged = breakpoints_mm(&app);
    assert!((dragged[3] - dragged[2] - 1.0).abs() < 1e-6, "{dragged:?}");
    app.window.key_press(Key::ArrowRight);
    app.key(Key::ArrowDown, 300);
    assert!((breakpoints_mm(&app)[3] - dragged[3] - 1.0).abs() < 1e-6, "{:?}", breakpoints_mm(&app));
    app.key(Key::Delete, 300);
    assert_eq!(breakpoints_mm(&app).len(), 4);

    let before = app.window.state().setup().clone();
    app.click("Play this", 600);
    let played = app.window.state().setup().clone();
    assert!(played.tones.len() > 1 && app.is_driving(), "{:?}", played.tones);
    assert!(app.window.state().notice().is_none(), "{:?}", app.window.state().notice());
    app.click("Save setup…", 100);
    let (name, bytes) = app.files.saved.borrow()[0].clone();
    let Ok(Opened::Setup(saved)) = setup_file::read(&String::from_utf8(bytes).unwrap()) else {
        panic!("{name} is no setup")
    };
    assert_eq!(*saved, played);
    app.keys(Modifiers::COMMAND, Key::Z, 300);
    assert_eq!(app.window.state().setup(), &before);
}

#[test]
fn what_is_out_of_reach_is_reported_at_once_and_nothing_else() {
    let mut app = TestApp::driving();
    open_textures(&mut app);
    open_profile(&mut app, "rising.csv", Ok(b"0.01,0.1\n0.25,1\n".to_vec()));
    assert!(has(&app, "The target cannot be reached exactly: any number of tones leaves an error of"));
    open_profile(&mut app, "falling.csv", Ok(b"place_m,rms\n0.01,1\n0.28,0.1\n".to_vec()));
    assert_eq!(breakpoints_mm(&app), [10.0, 280.0]);
    assert!(!has(&app, "in reach"));
    for column in ["its tones", "any number", "worst", "Error", "RMS at most", "Sum, of full scale"] {
        assert!(app.window.query_all_by_label(column).next().is_some(), "{column}");
    }
    type_into(&mut app, "Tones at most", "1");
    app.wait(300);
    assert!(has(&app, "1 tone leaves an error of"));
    type_into(&mut app, "Tones at most", "17");
    assert!(has(&app, "must be 1 to 16"));
    open_profile(&mut app, "gone.csv", Err("there is no such file".to_owned()));
    let notice = app.window.state().notice().cloned().unwrap();
    let reason = "no such file";
    assert!(
        notice.is_error && notice.text.contains("gone.csv") && notice.text.contains(reason),
        "{notice:?}"
    );
    assert_eq!(breakpoints_mm(&app), [10.0, 280.0]);
}

#[test]
fn an_area_stripes_and_a_beat_are_typed_and_bad_values_are_reported() {
    let mut app = TestApp::driving();
    open_textures(&mut app);
    choose(&mut app, "Solid");
    type_into(&mut app, "Felt to", "260 mm");
    app.wait(600);
    assert!(has(&app, "Contrast") && has(&app, "Ripple"));
    type_into(&mut app, "Felt to", "20 mm");
    app.wait(300);
    assert!(has(&app, "felt edge = 20 mm: must be"), "the reason is under the plot");

    choose(&mut app, "Stripes");
    type_into(&mut app, "Distance", "50 mm");
    app.wait(300);
    assert!(has(&app, "Stripes, in the middle") && has(&app, "1 tone"));
    type_into(&mut app, "Distance", "1 mm");
    app.wait(300);
    assert!(has(&app, "stripes = 1 mm: must be"));

    choose(&mut app, "Beat");
    type_into(&mut app, "Place", "150 mm");
    type_into(&mut app, "Beat", "30 Hz");
    app.wait(300);
    app.click("Play this", 300);
    let setup = app.window.state().setup();
    let hertz = |i: usize| setup.plate.frequency_for_boundary_hz(setup.tones[i].position_m);
    assert!(setup.tones.len() == 2 && ((hertz(0) - hertz(1)).abs() - 30.0).abs() < 0.5);
}

/// The parts of the page lie inside the panel, however small the window is.
#[test]
fn the_page_lies_inside_its_panel() {
    let mut app = TestApp::driving();
    open_textures(&mut app);
    let window: Rect = app.window.ctx.content_rect();
    for name in
        ["Boundary", "Tones", "Texture", "Plate", "Device", "Play", "Solid", "Profile", "Stripes", "Beat"]
    {
        let rect = app.window.get_by_role_and_label(Role::Button, name).rect();
        assert!(window.contains_rect(rect), "{name}: {rect:?}");
    }
    let page = app.window.get_by_label("Texture over the plate").rect();
    assert!(page.right() <= window.right() && page.width() > 250.0, "{page:?}");
}

#[test]
fn the_tones_of_a_texture_are_ticks_under_the_strip_and_the_selected_line_ends_above_it() {
    let mut app = TestApp::driving();
    open_textures(&mut app);
    choose(&mut app, "Solid");
    app.wait(600);
    app.click("Play this", 400);
    let tones = app.window.state().setup().tones.len();
    assert!(tones >= 2, "{tones}");
    let strip = app.window.get_by_label_contains("felt to").rect();
    let names = (1..=tones)
        .map(|tone| if tone == 1 { "Boundary".to_owned() } else { format!("Peak of tone {tone}") });
    let places = |app: &TestApp| -> Vec<(String, Rect)> {
        let at = |name: String| {
            let rect = app.window.get_by_role_and_label(Role::Slider, &name).rect();
            (name, rect)
        };
        names.clone().map(at).collect()
    };
    let (whole, ticks): (Vec<_>, Vec<_>) =
        places(&app).into_iter().partition(|(_, rect)| rect.height() > 100.0);
    assert_eq!((whole.len(), ticks.len()), (1, tones - 1));
    assert!(whole[0].1.bottom() < strip.top(), "{whole:?} {strip}");
    for (name, tick) in &ticks {
        assert!(tick.top() >= strip.bottom() - 1.0 && tick.height() >= 24.0, "{name}: {tick} {strip}");
    }
    // A press on a tick selects it, and its line is whole then.
    let (pressed, tick) = &ticks[0];
    app.grab(tick.center(), 50);
    app.release(tick.center(), 200);
    let now = places(&app).into_iter().find(|(name, _)| name == pressed).unwrap().1;
    assert!(now.height() > 100.0 && now.bottom() < strip.top(), "{now}");
}

/// The words that are painted in amber.
fn amber(app: &TestApp) -> Vec<String> {
    let warn = eframe::egui::Color32::from_rgb(0x96, 0x5a, 0x00);
    let texts = app.window.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        eframe::egui::Shape::Text(text) => Some(&text.galley),
        _ => None,
    });
    let is_amber = |galley: &&std::sync::Arc<eframe::egui::Galley>| {
        galley.job.sections.iter().any(|section| section.format.color == warn)
    };
    texts.filter(is_amber).map(|galley| galley.text().to_owned()).collect()
}

#[test]
fn the_page_opens_without_amber_for_every_kind() {
    let mut app = TestApp::driving();
    open_textures(&mut app);
    for kind in ["Profile", "Solid", "Stripes", "Beat"] {
        choose(&mut app, kind);
        app.wait(600);
        assert_eq!(amber(&app), Vec::<String>::new(), "{kind}");
    }
}
