//! The window, used by accessible names on a simulated device in virtual time.

mod actions;
mod actual_plate;
mod air;
mod background;
mod brush;
mod calibrate;
mod chords;
mod dialogs;
mod drive_check;
mod drive_time;
mod drops;
mod exports;
mod fake_files;
mod fake_speaker;
mod feeling;
mod finger;
mod finger_trace;
#[path = "../../../instrument/tests/in_use/fixed_link.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod fixed_link;
mod focus;
mod foreign;
mod frames;
mod glow;
mod glyphs;
mod hang;
mod holding;
mod in_use;
mod kiosk;
mod known_results;
mod light_marks;
mod measure;
mod measuring;
mod moving_picture;
mod notices;
mod openings;
mod painter;
mod paths;
mod places;
mod plane_check;
mod play;
mod plots;
#[path = "../../../instrument/tests/in_use/pluggable_port.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod pluggable_port;
mod port_help;
mod reasons;
#[path = "../../../instrument/tests/in_use/script.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod script;
mod selftest;
#[path = "../../../instrument/tests/in_use/sensors.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod sensors;
#[path = "../../../instrument/tests/in_use/session.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod session;
mod sizes;
mod sliders;
mod small_screens;
mod snapshots;
mod sound;
mod stage;
mod states;
mod stop;
mod stop_keys;
mod tab_order;
mod test_app;
mod texts;
mod textures;
mod tooltips;
mod tour;
mod track;
mod unknown_values;
mod upkeep;

use eframe::egui::{Key, Modifiers, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use fixed_link::{FixedLink, real_device};
use slipline_link::protocol::event::State;
use slipline_link::{LinkState, Request, Sounding};
use test_app::{TestApp, click, opened};

/// Types into the field with this name and presses Enter.
fn type_into(app: &mut TestApp, name: &str, text: &str) {
    app.window.get_by_role_and_label(Role::TextInput, name).focus();
    app.window.step();
    app.keys(Modifiers::COMMAND, Key::A, 0);
    app.window.get_by_role_and_label(Role::TextInput, name).type_text(text);
    app.window.step();
    app.key(Key::Enter, 0);
    app.window.step();
}

/// Adds a tone on the page of tones, which stays open.
fn add_tone(app: &mut TestApp) {
    app.click("Tones", 50);
    app.click("Add tone", 200);
}

/// The rectangle of the boundary's handle.
fn line_rect(app: &TestApp) -> eframe::egui::Rect {
    app.window.get_by_role_and_label(Role::Slider, "Boundary").rect()
}

fn boundary_mm(app: &TestApp) -> f64 {
    app.window.state().setup().tones[0].position_m * 1e3
}

/// Moves the boundary by a millimetre.
fn arrow_right(app: &mut TestApp) {
    app.key(Key::ArrowRight, 0);
}

fn drives(requests: &[Request]) -> Vec<f64> {
    let boundary = |request: &Request| match request {
        Request::Play(Sounding::Drive(drive)) => Some(drive.tones[0].boundary_m * 1e3),
        _ => None,
    };
    requests.iter().filter_map(boundary).collect()
}

#[test]
fn the_first_start_shows_the_plate_already_moving() {
    let app = TestApp::driving();
    assert!(app.has("State: driving"));
    assert!(app.has("STOP"));
    let snapshot = app.snapshot();
    assert_eq!(snapshot.table.upload_verified, Some(true));
    assert!(
        snapshot.record.log.iter().all(|entry| entry.severity < slipline_link::Severity::Warning),
        "{:?}",
        snapshot.record.log
    );
}

#[test]
fn dragging_the_line_sends_the_boundary_with_every_move_of_the_pointer() {
    let mut app = TestApp::driving();
    let line = line_rect(&app);
    assert!(line.width() >= 24.0, "the handle can be touched");
    let before = boundary_mm(&app);
    app.take_sent();
    app.grab(line.center(), 0);
    let mut sent = Vec::new();
    for step in 1..=8 {
        app.hover(line.center() + vec2(5.0 * step as f32, 0.0), 0);
        sent.extend(drives(&app.take_sent()));
    }
    app.release(line.center() + vec2(40.0, 0.0), 0);
    assert_eq!(sent.len(), 8, "one drive for each move: {sent:?}");
    assert!(sent.windows(2).all(|pair| pair[1] > pair[0]));
    // The line is at the pixel where the pointer released it.
    let moved = line_rect(&app).center().x - line.center().x;
    assert!((moved - 40.0).abs() <= 1.0, "{moved}");
    assert!((sent[7] - boundary_mm(&app)).abs() < 1e-9 && boundary_mm(&app) > before + 10.0);
    // The device has the same place.
    app.wait(200);
    let mm = app.window.get_by_role_and_label(Role::TextInput, "Boundary position").value().unwrap();
    assert_eq!(mm, format!("{:.1} mm", boundary_mm(&app)));
    assert!(app.is_driving());
}

#[test]
fn the_line_can_be_grabbed_over_the_envelope_and_the_strip() {
    for share in [0.15, 0.7, 0.97] {
        let mut app = TestApp::driving();
        let line = line_rect(&app);
        let before = boundary_mm(&app);
        let grip = line.left_top() + vec2(0.5 * line.width(), share * line.height());
        app.drag(grip, grip - vec2(30.0, 0.0));
        assert!(boundary_mm(&app) < before - 5.0, "at {share} of the height");
    }
}

#[test]
fn arrow_keys_move_the_boundary_by_a_millimetre_and_with_shift_by_a_tenth() {
    let mut app = TestApp::driving();
    let before = boundary_mm(&app);
    app.key(Key::ArrowRight, 0);
    assert!((boundary_mm(&app) - before - 1.0).abs() < 1e-9);
    app.keys(Modifiers::SHIFT, Key::ArrowLeft, 0);
    assert!((boundary_mm(&app) - before - 0.9).abs() < 1e-9);
}

#[test]
fn a_typed_place_or_frequency_moves_the_boundary() {
    let mut app = TestApp::driving();
    type_into(&mut app, "Boundary position", "120,5 mm");
    assert!((boundary_mm(&app) - 120.5).abs() < 1e-6);
    type_into(&mut app, "Boundary position", "0,151 kHz");
    assert!((boundary_mm(&app) - 200.0).abs() < 1.0, "{}", boundary_mm(&app));
}

#[test]
fn a_bad_file_gives_a_clear_message_and_loses_nothing() {
    let mut app = TestApp::driving();
    let good = app.setup_text();
    let huge = Err("the file is too big: must be at most 1048576 bytes".to_owned());
    let cases = [
        (Ok("\u{0}\u{1}nonsense".to_owned()), "Line 1"),
        (Ok(good.replace("master_db = 0.0", "master_db = nan")), "Master level"),
        (Ok(good.replace("length_m = 0.32", "length_m = 1e300")), "length_m"),
        (huge, "too big"),
    ];
    app.click("Open the log", 100);
    for (text, reason) in cases {
        app.open("bad.toml", text);
        assert_eq!(app.setup_text(), good, "{reason}");
        let notice = app.window.state().notice().cloned().unwrap();
        assert!(
            notice.is_error && notice.text.contains("bad.toml") && notice.text.contains(reason),
            "{notice:?}"
        );
        // In the message and in the log.
        assert!(app.window.query_all_by_label_contains("nothing has changed").count() >= 2);
        app.click("Dismiss", 50);
        assert!(app.window.state().notice().is_none());
    }
    assert!(app.is_driving());
}

#[test]
fn a_saved_setup_opens_again_with_its_tones() {
    let mut app = TestApp::driving();
    add_tone(&mut app);
    assert_eq!(app.window.state().setup().tones.len(), 2);
    assert!(app.has("Peak of tone 2"));
    app.keys(Modifiers::COMMAND, Key::S, 50);
    let (name, bytes) = app.files.saved.borrow()[0].clone();
    let saved = app.window.state().setup().clone();
    app.click("Remove tone 2", 50);
    assert_eq!(app.window.state().setup().tones.len(), 1);
    let text = String::from_utf8(bytes).unwrap();
    app.open(&name, Ok(text));
    assert_eq!(app.window.state().setup(), &saved);
    assert!(!app.window.state().settings().recent.is_empty());
}

#[test]
fn a_lost_link_is_shown_and_comes_back_by_itself() {
    let mut app = TestApp::driving();
    app.plug(false);
    app.wait(1500);
    assert!(matches!(app.snapshot().link.state, LinkState::Reconnecting(_) | LinkState::Lost(_)));
    assert!(app.has("State: reconnecting"));
    assert!(app.has("STOP"));
    let setup = app.setup_text();
    app.plug(true);
    app.wait(2000);
    assert!(app.snapshot().is_connected());
    assert!(!app.is_driving(), "it comes back silent");
    assert_eq!(app.setup_text(), setup);
    app.click_button("Drive", 300);
    assert!(app.is_driving());
}

#[test]
fn a_port_that_is_missing_at_the_start_is_waited_for_and_connected_when_it_appears() {
    let mut app = TestApp::unplugged();
    app.wait(1500);
    assert!(app.has("State: waiting for port"));
    let told = app.window.state().notice().cloned().unwrap();
    assert!(told.is_error && told.text.contains("There is no port"), "{told:?}");
    app.click("Device", 50);
    assert!(app.has_part("Waiting for it."), "the line under the state");
    app.plug(true);
    app.wait(1500);
    assert!(app.snapshot().is_connected());
    assert!(!app.has_part("There is no port"), "the message is obsolete");
}

#[test]
fn a_port_that_is_waited_for_can_be_given_up() {
    let mut app = TestApp::unplugged();
    app.wait(500);
    app.click("Cancel", 100);
    assert!(app.has("State: disconnected"));
    app.plug(true);
    app.wait(1500);
    assert!(!app.snapshot().is_connected());
    app.click("Connect", 500);
    assert!(app.snapshot().is_connected());
}

#[test]
fn another_plate_gets_its_table_made_sent_and_verified() {
    let mut app = TestApp::driving();
    let before = app.snapshot().table.report.active.unwrap().crc;
    app.click("Plate", 50);
    type_into(&mut app, "Wave speed", "13 m/s");
    app.wait(1500);
    let snapshot = app.snapshot();
    assert_ne!(snapshot.table.report.active.unwrap().crc, before);
    assert_eq!(snapshot.table.upload_verified, Some(true));
    assert_eq!(snapshot.drive.status.unwrap().state, State::Driving);
}

#[test]
fn a_real_device_is_armed_only_after_a_confirmation_and_never_driven_by_itself() {
    let link = real_device(State::Idle);
    let mut window = opened(link.clone(), [1280.0, 800.0]);
    let asked = |link: &FixedLink, want: fn(&Request) -> bool| link.sent.borrow().iter().any(want);
    click(&mut window, "Arm…");
    assert!(!asked(&link, |request| matches!(request, Request::Arm | Request::ArmFor(_))));
    click(&mut window, "Cancel");
    assert!(
        !asked(&link, |request| matches!(request, Request::Arm | Request::ArmFor(_))),
        "cancelled is not confirmed"
    );
    click(&mut window, "Arm…");
    click(&mut window, "Arm");
    assert!(asked(&link, |request| matches!(request, Request::Arm | Request::ArmFor(_))));
    assert!(!asked(&link, |request| matches!(
        request,
        Request::Play(Sounding::Drive(_)) | Request::Upload(_)
    )));
}

#[test]
fn every_control_has_an_accessible_name() {
    let mut app = TestApp::driving();
    for tab in ["Boundary", "Tones", "Texture", "Plate", "Device", "Play"] {
        app.click_button(tab, 50);
        for role in
            [Role::Button, Role::Slider, Role::TextInput, Role::ComboBox, Role::CheckBox, Role::RadioButton]
        {
            for node in app.window.query_all_by_role(role) {
                let access = node.accesskit_node();
                let is_named = access.label().is_some_and(|label| !label.is_empty())
                    || access.labelled_by().next().is_some();
                assert!(is_named, "{tab}: {role:?} at {:?}", node.rect());
            }
        }
    }
}
