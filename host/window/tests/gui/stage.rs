//! The stage: unreachable places are marked and named, and no text covers the views.

use crate::plots::words;
use crate::test_app::TestApp;
use crate::{add_tone, boundary_mm, line_rect};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, Rect, vec2};
use egui_kittest::kittest::Queryable as _;

fn painted(app: &TestApp, word: &str) -> Option<Rect> {
    let words = words(app.window.output());
    words.into_iter().find(|(painted, _)| painted.contains(word)).map(|(_, rect)| rect)
}

#[test]
fn a_drag_against_the_end_of_the_span_says_so() {
    let mut app = TestApp::driving();
    let line = line_rect(&app).center();
    app.grab(line, 0);
    app.hover(line + vec2(40.0, 0.0), 50);
    assert!(painted(&app, "the span ends here").is_none());
    app.hover(line + vec2(600.0, 0.0), 50);
    assert_eq!(boundary_mm(&app), 280.0);
    assert!(painted(&app, "the span ends here").is_some());
    app.hover(line - vec2(600.0, 0.0), 50);
    assert!(painted(&app, "the span begins here").is_some());
    app.release(line - vec2(600.0, 0.0), 50);
}

#[test]
fn the_words_about_what_is_felt_lie_below_the_strip() {
    for size in [[1280.0, 800.0], [900.0, 600.0]] {
        let mut app = TestApp::driving();
        app.resize(size.into(), 100);
        let (line, words) = (line_rect(&app), painted(&app, "vibration, illustrative").unwrap());
        assert!(words.top() >= line.bottom(), "{size:?}: {words} {line}");
        let number = painted(&app, "300").unwrap();
        assert!(!words.intersects(number), "{size:?}: {words} {number}");
        // The row of plots begins below.
        assert!(words.bottom() < app.window.get_by_label("Drive waveform").rect().top());
    }
}

#[test]
fn a_tones_number_is_seen_beside_the_boundarys_flag() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    // Just beside the other tone, below whose flag its number would be.
    let mut setup = app.window.state().setup().clone();
    setup.tones[1].position_m = setup.tones[0].position_m + 0.008;
    let text = slipline_model::setup::file::write(&setup);
    app.open("two.toml", Ok(text));
    app.wait(300);
    app.click("Select tone 1", 100);
    let flag = painted(&app, "   fall-off ").unwrap().expand2(vec2(10.0, 3.0));
    let number = app.window.get_by_label("Peak of tone 2").rect().center().x;
    let words = words(app.window.output());
    let (_, number) =
        words.iter().find(|(word, at)| word == "2" && (at.center().x - number).abs() < 2.0).unwrap();
    assert!(!flag.intersects(*number), "{flag} {number}");
}

#[test]
fn the_plates_name_and_the_filters_hint_are_whole_in_a_small_window() {
    let mut app = TestApp::driving();
    crate::background::open_plate(&mut app, slipline_plate::preset("al-bending").unwrap().to_toml());
    app.wait(1500);
    app.resize(vec2(960.0, 620.0), 100);
    assert!(painted(&app, "al-bending").is_some_and(|name| name.top() > 40.0));
    app.click("Open the log", 100);
    let filter = app.window.get_by_label("Filter the log").rect();
    let words = words(app.window.output());
    let hint = words.iter().find(|(_, at)| filter.contains(at.center()));
    assert!(hint.is_some_and(|(hint, _)| hint == "find"), "{hint:?}");
}

#[test]
fn the_pointer_reads_place_displacement_and_how_far_it_is_over_felt() {
    let mut app = TestApp::driving();
    let line = line_rect(&app);
    let read = |app: &mut TestApp, dx: f32| {
        app.hover(line.center() + vec2(dx, 0.05 * line.height()), 50);
        painted_words(app, "felt").into_iter().find(|words| words.contains(" mm   "))
    };
    let before = read(&mut app, -30.0).unwrap();
    assert!(before.contains("\u{b5}m   ") && before.ends_with(" dB over felt"), "{before}");
    let mm: f64 = before.split(' ').next().unwrap().parse().unwrap();
    assert!(mm < boundary_mm(&app) - 5.0 && mm > boundary_mm(&app) - 30.0, "{before}");
    let beyond = read(&mut app, 340.0).unwrap();
    assert!(beyond.ends_with(" dB below felt"), "{beyond}");
    app.hover(eframe::egui::pos2(1100.0, 300.0), 50);
    assert!(painted_words(&app, " dB over felt").is_empty());
}

fn painted_words(app: &TestApp, part: &str) -> Vec<String> {
    words(app.window.output()).into_iter().map(|(word, _)| word).filter(|word| word.contains(part)).collect()
}

#[test]
fn the_points_of_the_drive_before_stay_while_the_line_is_dragged() {
    let mut app = TestApp::driving();
    assert_eq!(painted_words(&app, "simulated plate"), ["simulated plate"]);
    app.hold_time_domain(true);
    let line = line_rect(&app).center();
    app.grab(line, 0);
    for step in 1..=4 {
        app.hover(line + vec2(10.0 * step as f32, 0.0), 50);
    }
    assert_eq!(painted_words(&app, "simulated plate"), ["simulated plate, before"]);
    app.hold_time_domain(false);
    app.hover(line + vec2(44.0, 0.0), 200);
    app.release(line + vec2(44.0, 0.0), 400);
    assert_eq!(painted_words(&app, "simulated plate"), ["simulated plate"]);
}

#[test]
fn the_plate_in_time_is_not_restarted_for_every_move_of_a_drag_and_follows_its_end() {
    let mut app = TestApp::driving();
    let line = line_rect(&app).center();
    app.grab(line, 50);
    let before = app.time_domain_jobs.get();
    for step in 1..=24 {
        app.hover(line + vec2(2.0 * step as f32, 0.0), 50);
    }
    let in_the_drag = app.time_domain_jobs.get() - before;
    // The harness counts a 60th of a second a frame: 0.4 s.
    assert!((1..=2).contains(&in_the_drag), "{in_the_drag} of 24");
    app.release(line + vec2(48.0, 0.0), 400);
    assert_eq!(painted_words(&app, "simulated plate"), ["simulated plate"]);
}

#[test]
fn new_is_undone_by_its_name() {
    let mut app = TestApp::driving();
    let press = |app: &mut TestApp, name: &str| {
        app.click(name, 200);
    };
    crate::type_into(&mut app, "Boundary position", "120 mm");
    press(&mut app, "File");
    app.click_part("New", 200);
    press(&mut app, "Edit");
    assert!(app.has_part("Undo new setup"));
}

#[test]
fn the_values_of_the_sliders_end_in_one_line() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    app.keys(Modifiers::COMMAND, Key::Num1, 100);
    let boxes: Vec<Rect> = ["Level", "Master", "Glide"]
        .map(|name| app.window.get_by_role_and_label(Role::TextInput, name).rect())
        .to_vec();
    let panel = app.window.get_by_label("Play").rect().right();
    for at in &boxes {
        assert!((at.right() - boxes[0].right()).abs() < 0.5 && at.right() <= panel, "{boxes:?}");
    }
    let words = words(app.window.output());
    let (_, master) = words.iter().find(|(_, at)| boxes[1].contains(at.center())).unwrap();
    assert!(boxes[1].contains_rect(*master), "{master} {boxes:?}");
}

#[test]
fn the_outputs_counters_stay_in_the_window_below_a_heading_level_with_the_others() {
    let app = TestApp::driving();
    let heading = |name: &str| app.window.get_by_label(name).rect().center().y;
    assert!(
        (heading("Output") - heading("Spectrum")).abs() < 1.0,
        "{} {}",
        heading("Output"),
        heading("Spectrum")
    );
    let last = app.window.get_by_label("Errors").rect();
    // The panel ends before the test's window does.
    assert!(last.bottom() <= 792.0 - 8.0, "{last}");
}

#[test]
fn the_logs_lines_begin_in_one_column() {
    let mut app = TestApp::driving();
    app.pass(12_000);
    app.click("Open the log", 100);
    app.click("Device", 100);
    app.click("Disconnect", 500);
    let left =
        |app: &TestApp, text: &str| app.window.get_all_by_label_contains(text).next().unwrap().rect().left();
    let (first, last) = (left(&app, "Connecting to sim."), left(&app, "Disconnected"));
    assert!((first - last).abs() < 0.5, "{first} {last}");
}

#[test]
fn the_choice_of_colours_is_one_of_the_settings_that_are_kept() {
    let mut app = TestApp::driving_with_sheet();
    assert!(!app.window.state().settings().show_amplitude);
    app.click("Amplitude", 100);
    assert!(app.window.state().settings().show_amplitude);
    assert!(app.has("2-D sheet, maximum over time"));
    app.click("Wave", 100);
    assert!(!app.window.state().settings().show_amplitude);
}

/// How high on the screen each vertex of the relief is.
fn heights(app: &TestApp) -> Vec<f32> {
    let meshes = app.window.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        eframe::egui::Shape::Mesh(mesh) if mesh.vertices.len() > 1000 => Some(mesh),
        _ => None,
    });
    meshes.flat_map(|mesh| mesh.vertices.iter().map(|vertex| vertex.pos.y)).collect()
}

#[test]
fn the_relief_lifts_the_plate_where_it_moves_and_is_flat_at_rest() {
    let mut app = TestApp::driving();
    app.click("Amplitude", 100);
    assert!(heights(&app).is_empty(), "off, it is not made");
    app.click("Relief", 100);
    assert!(app.window.state().settings().show_relief);
    let driven = heights(&app);
    app.key(Key::Space, 500);
    let rest = heights(&app);
    assert!(driven.len() > 1000 && rest.len() == driven.len());
    let lifts: Vec<f32> = rest.iter().zip(&driven).map(|(rest, driven)| rest - driven).collect();
    assert!(lifts.iter().all(|lift| *lift >= -0.01), "an amplitude lifts");
    let highest = lifts.iter().copied().fold(0.0, f32::max);
    assert!(highest > 30.0, "{highest}");
    app.click("Relief", 100);
    assert!(heights(&app).is_empty());
}

/// The labels of the envelope's axis, and the factor beside it.
fn factor(app: &TestApp) -> Option<String> {
    painted_words(app, "×").into_iter().find(|word| word.len() > "×".len())
}

#[test]
fn a_weak_drive_is_magnified_by_a_written_factor_that_stays_while_something_is_dragged() {
    let mut app = TestApp::driving();
    assert_eq!(factor(&app), None);
    let first = painted(&app, "µm").unwrap();
    crate::type_into(&mut app, "Level", "0.04");
    app.wait(600);
    assert_eq!(factor(&app).as_deref(), Some("×20"));
    assert!(painted(&app, "µm").is_some() || painted(&app, "nm").is_some(), "{first}");
    // While the pointer holds the line nothing is scaled again, unless it would be cut.
    let line = line_rect(&app).center();
    app.grab(line, 50);
    app.hover(line + vec2(60.0, 0.0), 100);
    assert_eq!(factor(&app).as_deref(), Some("×20"));
    app.release(line + vec2(60.0, 0.0), 200);
    crate::type_into(&mut app, "Level", "0.8");
    app.wait(600);
    assert_eq!(factor(&app), None);
}

/// The plate's pixels that are not those of a plate at rest, as a share.
#[test]
fn the_scene_of_two_tones_is_no_black_plate() {
    let scene = slipline_model::scenes::SCENES.iter().find(|scene| scene.name == "Two tones").unwrap();
    let size = egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]);
    let theme = slipline_window::settings::ThemeChoice::Dark;
    let app = TestApp::driving_setup(scene.setup().unwrap(), theme, size);
    let factor = factor(&app).unwrap();
    let factor: f64 = factor.trim_start_matches('×').parse().unwrap();
    assert!(factor >= 5.0, "{factor}");
}

#[test]
fn a_line_says_what_stands_at_its_place() {
    let mut app = TestApp::driving();
    assert!(painted(&app, "turning point 180.0 mm").is_some());
    crate::type_into(&mut app, "Level", "0.0001");
    app.wait(300);
    app.click("Felt edge", 300);
    assert!(painted(&app, "turning point ").is_some() && painted(&app, "not felt: too weak").is_some());
    crate::type_into(&mut app, "Level", "0.8");
    app.wait(300);
    assert!(painted(&app, "felt to ").is_some());
    app.click("Tones", 100);
    assert!(app.has("felt edge"), "in the list, too");
}

#[test]
fn the_switches_of_the_view_keep_their_places_whichever_is_pressed() {
    let mut app = TestApp::driving();
    let places = |app: &TestApp| {
        ["Wave", "Amplitude", "Relief"].map(|name| app.window.get_by_label(name).rect().left_top())
    };
    let before = places(&app);
    for name in ["Amplitude", "Relief", "Wave"] {
        app.click(name, 300);
        assert_eq!(places(&app), before, "{name}");
    }
    // A switch of its own beside a choice of two.
    let relief = app.window.get_by_label("Relief");
    assert_eq!(egui_kittest::kittest::NodeT::accesskit_node(&relief).role(), Role::CheckBox);
}

fn click(app: &mut TestApp, at: eframe::egui::Pos2) {
    app.grab(at, 0);
    app.release(at, 0);
}

/// A place this far from the line, at this share of the height from the plate to the strip.
fn beside_line(app: &TestApp, dx: f32, share: f32) -> eframe::egui::Pos2 {
    let line = line_rect(app);
    eframe::egui::pos2(line.center().x + dx, line.top() + share * line.height())
}

#[test]
fn a_click_on_the_plate_brings_the_line_and_a_double_click_moves_none() {
    let mut app = TestApp::driving();
    let at = beside_line(&app, -60.0, 0.3);
    let before = boundary_mm(&app);
    click(&mut app, at);
    // Longer than a double click takes, 0.3 s; the harness counts a 60th of a second a frame.
    app.wait(1200);
    let moved = boundary_mm(&app);
    assert!((line_rect(&app).center().x - at.x).abs() < 1.0 && moved < before - 10.0, "{before} {moved}");
    app.keys(Modifiers::COMMAND, Key::Z, 300);
    assert_eq!(boundary_mm(&app), before, "one step");
    app.window.run_steps(60);
    click(&mut app, at);
    click(&mut app, at);
    app.wait(300);
    let setup = app.window.state().setup();
    assert_eq!((setup.tones.len(), setup.tones[0].position_m * 1e3), (2, before));
}

#[test]
fn a_click_sends_nothing_while_a_second_click_may_follow() {
    let mut app = TestApp::driving();
    let at = beside_line(&app, -60.0, 0.3);
    app.take_sent();
    let (before, line) = (boundary_mm(&app), line_rect(&app));
    click(&mut app, at);
    for _ in 0..4 {
        app.window.step();
        assert_eq!((boundary_mm(&app), line_rect(&app)), (before, line));
    }
    click(&mut app, at);
    app.wait(1200);
    assert_eq!(line_rect(&app), line, "the line has not moved");
    let sent = crate::drives(&app.take_sent());
    assert!(sent.iter().all(|place_mm| (place_mm - before).abs() < 1e-9), "{sent:?}");
    app.keys(Modifiers::COMMAND, Key::Z, 300);
    assert_eq!(app.window.state().setup().tones.len(), 1, "one step");
}

#[test]
fn a_press_that_is_held_or_moves_takes_the_line_at_once_in_one_step_of_undo() {
    // On the plate and on the envelope.
    for share in [0.3, 0.75] {
        let mut app = TestApp::driving();
        let before = boundary_mm(&app);
        let at = beside_line(&app, -60.0, share);
        app.grab(at, 1000);
        assert!((line_rect(&app).center().x - at.x).abs() < 1.0, "held: {share}");
        app.hover(at + vec2(-30.0, 0.0), 100);
        app.hover(at + vec2(-40.0, 0.0), 100);
        assert!((line_rect(&app).center().x - at.x + 40.0).abs() < 1.0, "it follows: {share}");
        app.release(at + vec2(-40.0, 0.0), 1200);
        assert!((line_rect(&app).center().x - at.x + 40.0).abs() < 1.0, "it stays: {share}");
        app.keys(Modifiers::COMMAND, Key::Z, 300);
        assert_eq!(boundary_mm(&app), before, "one step: {share}");
        app.grab(at, 0);
        app.hover(at + vec2(20.0, 0.0), 100);
        assert!((line_rect(&app).center().x - at.x - 20.0).abs() < 1.0, "moved: {share}");
        app.release(at + vec2(20.0, 0.0), 100);
    }
}

#[test]
fn a_press_moves_the_selected_tones_line_unless_a_handle_takes_it() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    let places = |app: &TestApp| -> Vec<f64> {
        app.window.state().setup().tones.iter().map(|tone| tone.position_m).collect()
    };
    app.click("Select tone 2", 100);
    let (before, at) = (places(&app), beside_line(&app, 90.0, 0.7));
    click(&mut app, at);
    app.wait(1200);
    assert!(places(&app)[0] == before[0] && places(&app)[1] != before[1], "{before:?} {:?}", places(&app));
    // On the line of the other tone: it is selected, and stays.
    let (before, at) = (places(&app), beside_line(&app, 0.0, 0.7));
    click(&mut app, at);
    app.wait(1200);
    assert_eq!(places(&app), before);
    // On the finger.
    app.click_button("Boundary", 100);
    crate::finger::choose(&mut app, "Light");
    let finger = app.window.get_by_role_and_label(Role::Slider, "Finger").rect().center();
    click(&mut app, finger);
    app.wait(1200);
    assert_eq!(places(&app), before);
}

#[test]
fn the_row_below_gives_its_room_to_the_plots_while_no_error_was_counted() {
    let app = TestApp::driving();
    let left = |name: &str| app.window.get_by_label(name).rect().left();
    let panel = app.window.get_by_role_and_label(Role::Button, "Boundary").rect().left();
    let (plot, row) = (left("Output") - left("Drive waveform"), panel - left("Drive waveform"));
    assert!(plot > 0.75 * row, "{plot} of {row}");
    assert!(app.has("Errors") && !app.has("CRC errors"));
}
