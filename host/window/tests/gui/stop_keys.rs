//! Esc, Space and STOP: one press stops and disarms a real device, two within a second are an emergency stop.

use crate::fixed_link::FixedLink;
use crate::real_device;
use crate::test_app::{TestApp, click, opened};
use eframe::egui::{Event, Key, Modifiers, accesskit::Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_link::protocol::event::{Fault, State};
use slipline_link::{LinkError, LinkState, Request, UploadProgress};
use slipline_window::app::App;
use std::sync::Arc;

/// More frames than a second has, and fewer: a frame takes 1/60 s.
const OVER_A_SECOND: usize = 66;
const UNDER_A_SECOND: usize = 54;

fn show(link: &FixedLink) -> Harness<'static, App> {
    let window = opened(link.clone(), [1280.0, 800.0]);
    link.sent.borrow_mut().clear();
    window
}

/// What was sent since the last call, each request by a letter.
fn sent(link: &FixedLink) -> String {
    let letter = |request: Request| match request {
        Request::Stop => 'S',
        Request::Disarm => 'D',
        Request::EmergencyStop => 'E',
        other => panic!("{other:?}"),
    };
    link.sent.borrow_mut().drain(..).map(letter).collect()
}

#[test]
fn a_key_stops_and_disarms_a_real_device_in_every_state() {
    for key in [Key::Escape, Key::Space] {
        for state in
            [State::Idle, State::Armed, State::Driving, State::Stopping, State::Fault, State::SafeMode]
        {
            let link = real_device(state);
            let mut window = show(&link);
            window.key_press(key);
            window.run_steps(3);
            assert_eq!(sent(&link), "SD", "{key:?} {state:?}");
        }
        let mut link = real_device(State::Driving);
        Arc::make_mut(&mut link.snapshot).table.upload = Some(UploadProgress { sent: 100, total: 256 });
        let mut window = show(&link);
        window.key_press(key);
        window.run_steps(3);
        assert_eq!(sent(&link), "SD", "{key:?} during an upload");
    }
}

#[test]
fn two_presses_are_as_far_apart_as_they_were_made_however_late_a_frame_comes() {
    // The first waited for its frame, so the frames are nearer to each other than the presses.
    for (waited_s, requests) in [(0.3, "SDSD"), (0.0, "SDE")] {
        let link = real_device(State::Driving);
        let mut window = show(&link);
        for (age_s, frames) in [(waited_s, UNDER_A_SECOND), (0.0, 3)] {
            window.state().press_ages().begin_frame(vec![age_s]);
            window.key_press(Key::Escape);
            window.run_steps(frames);
        }
        assert_eq!(sent(&link), requests, "{waited_s} s");
    }
}

#[test]
fn without_a_device_only_the_stop_is_sent() {
    for state in [
        LinkState::Disconnected,
        LinkState::Connecting,
        LinkState::Lost(LinkError::Gone),
        LinkState::Reconnecting(LinkError::Silent),
    ] {
        let mut link = real_device(State::Driving);
        Arc::make_mut(&mut link.snapshot).link.state = state.clone();
        let mut window = show(&link);
        window.key_press(Key::Escape);
        window.run_steps(3);
        assert_eq!(sent(&link), "S", "{state:?}");
    }
}

#[test]
fn two_presses_within_a_second_are_an_emergency_stop_by_whichever_of_the_three() {
    type Press = fn(&mut Harness<'static, App>);
    let presses: [(&str, Press); 3] = [
        ("Esc", |window| window.key_press(Key::Escape)),
        ("Space", |window| window.key_press(Key::Space)),
        ("STOP", |window| window.get_by_label("STOP").click()),
    ];
    for (first, press_first) in presses {
        for (second, press_second) in presses {
            let link = real_device(State::Driving);
            let mut window = show(&link);
            press_first(&mut window);
            window.run_steps(UNDER_A_SECOND);
            assert_eq!(sent(&link), "SD", "{first}");
            press_second(&mut window);
            window.run_steps(OVER_A_SECOND);
            assert_eq!(sent(&link), "E", "{first}, {second}");
            press_second(&mut window);
            window.run_steps(OVER_A_SECOND);
            assert_eq!(sent(&link), "SD", "{second}, more than a second later");
        }
    }
}

fn press_of(key: Key, pressed: bool) -> Event {
    Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE }
}

#[test]
fn two_presses_that_a_window_sees_in_one_frame_are_two_and_a_key_that_is_held_is_one() {
    let key = |pressed| press_of(Key::Space, pressed);
    let link = real_device(State::Driving);
    let mut window = show(&link);
    // Not by `event`, of which each makes a frame of its own.
    window.input_mut().events.extend([true, false, true, false].map(key));
    window.step();
    assert_eq!(sent(&link), "SDE");
    window.run_steps(OVER_A_SECOND);
    for _ in 0..30 {
        window.event(key(true));
        window.run_steps(2);
    }
    assert_eq!(sent(&link), "SD");
}

#[test]
fn a_space_that_was_typed_just_before_escape_is_no_press_and_one_after_it_is() {
    let key = |key| [true, false].map(|pressed| press_of(key, pressed));
    for (keys, expected) in [
        (vec![Key::Space, Key::Escape], "SD"),
        (vec![Key::Space, Key::Escape, Key::Space], "SDE"),
        (vec![Key::Escape, Key::Space], "SDE"),
    ] {
        let link = real_device(State::Driving);
        let mut window = show(&link);
        window.get_by_role_and_label(Role::TextInput, "Boundary position").focus();
        window.run_steps(2);
        // A frame that took long sees them all at once.
        window.input_mut().events.extend(keys.iter().flat_map(|&one| key(one)));
        window.step();
        assert_eq!(sent(&link), expected, "{keys:?}");
    }
}

#[test]
fn a_space_that_is_typed_is_a_space_and_escape_stops_while_typing() {
    let link = real_device(State::Driving);
    let mut window = show(&link);
    let field = |window: &Harness<'static, App>| {
        let node = window.get_by_role_and_label(Role::TextInput, "Boundary position");
        node.accesskit_node().value().unwrap_or_default()
    };
    window.get_by_role_and_label(Role::TextInput, "Boundary position").focus();
    window.run_steps(2);
    for _ in 0..2 {
        window.key_press(Key::Space);
        window.event(Event::Text(" ".to_owned()));
        window.run_steps(2);
    }
    assert_eq!(sent(&link), "");
    assert!(field(&window).contains("  "), "{:?}", field(&window));
    window.key_press(Key::Escape);
    window.run_steps(2);
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert_eq!(sent(&link), "SDE");
}

#[test]
fn a_page_in_front_passes_every_stop_to_the_device_and_arms_nothing() {
    for key in [Key::Escape, Key::Space] {
        let link = real_device(State::Idle);
        let mut window = show(&link);
        click(&mut window, "Arm…");
        // With the focus on the button that confirms.
        window.get_by_label("Arm").focus();
        window.run_steps(2);
        window.key_press(key);
        window.run_steps(5);
        assert_eq!(sent(&link), "SD", "{key:?}");
        let is_open = window.query_by_label("Arm the device?").is_some();
        assert_eq!(is_open, key == Key::Space, "Esc also closes the page");
    }
}

#[test]
fn the_simulated_device_stays_armed_after_one_press_and_latches_its_fault_after_two() {
    let mut app = TestApp::driving();
    app.key(Key::Space, 400);
    assert!(matches!(app.take_sent()[..], [.., Request::Stop, Request::Note(..)]));
    assert!(app.has("State: armed"));
    app.key(Key::Escape, 400);
    assert!(app.has("State: fault: emergency stop"));
    let status = app.snapshot().drive.status.unwrap();
    assert_eq!(status.first_fault, Some(Fault::EmergencyStop));
    app.click("Clear fault", 500);
    assert!(app.has("State: armed"));
    assert!(!app.is_driving(), "it is driven by a press of Drive only");
}

#[test]
fn the_stop_button_and_the_help_explain_two_presses() {
    let mut app = TestApp::driving();
    app.window.get_by_label("STOP").hover();
    app.wait(2000);
    let help = "Twice within a second: emergency stop";
    assert!(app.has_part(help));
    app.key(Key::F1, 300);
    for line in ["a real device is disarmed", "emergency stop, a fault to be cleared"] {
        assert!(app.has_part(line), "{line}");
    }
}

#[test]
fn escape_in_a_page_reports_what_else_it_did() {
    let mut app = TestApp::driving();
    app.key(Key::F1, 200);
    assert!(app.has("Esc closes it, too, and always stops the drive"));
    app.key(Key::Escape, 400);
    assert!(!app.is_driving());
    let message = "Esc closed the page and stopped the drive. Press Drive to resume.";
    assert!(app.has(message));
    // Later, and with nothing to stop, by the same key: nothing is said.
    app.wait(6000);
    // Labels with these words: the log keeps its line.
    let said = |app: &TestApp| app.window.query_all_by_label_contains("Esc closed the page").count();
    let before = said(&app);
    app.key(Key::F1, 200);
    app.key(Key::Escape, 200);
    assert_eq!(said(&app), before);
    for (state, message) in [
        (State::Driving, "Esc closed the page, stopped the drive and disarmed the device."),
        (State::Armed, "Esc closed the page and disarmed the device."),
        (State::Fault, ""),
    ] {
        let link = real_device(state);
        let mut window = show(&link);
        window.key_press(Key::F1);
        window.run_steps(3);
        window.key_press(Key::Escape);
        window.run_steps(3);
        assert_eq!(sent(&link), "SD", "{state:?}");
        let said = window.query_by_label_contains("Esc closed the page");
        let words =
            |node: egui_kittest::Node<'_>| node.accesskit_node().label().or(node.accesskit_node().value());
        let said = said.and_then(words).unwrap_or_default();
        assert_eq!(said, message, "{state:?}");
    }
}

#[test]
fn there_is_one_control_for_the_emergency_stop_on_every_page() {
    let mut app = TestApp::driving();
    for page in ["Boundary", "Tones", "Texture", "Plate", "Device", "Play"] {
        app.click_button(page, 100);
        let controls = app.window.query_all_by_role(Role::Button);
        let name = |label: String| label.to_lowercase();
        let stops: Vec<String> = controls
            .filter_map(|node| node.accesskit_node().label())
            .filter(|label| name(label.clone()).contains("stop"))
            .collect();
        assert_eq!(stops, ["STOP"], "{page}");
    }
}

#[test]
fn two_keys_on_a_silent_simulated_device_latch_no_fault_and_two_presses_of_the_button_do() {
    let mut app = TestApp::driving();
    app.key(Key::Space, 2000);
    assert!(app.has("State: armed"));
    // The window counts a 60th of a second a frame.
    app.window.run_steps(OVER_A_SECOND);
    app.take_sent();
    for key in [Key::Escape, Key::Escape, Key::Space, Key::Escape] {
        app.key(key, 100);
    }
    let sent = app.take_sent();
    assert!(!sent.iter().any(|request| matches!(request, Request::EmergencyStop)), "{sent:?}");
    assert_eq!(sent.iter().filter(|request| matches!(request, Request::Stop)).count(), 4, "each is a stop");
    assert!(app.has("State: armed"));
    for _ in 0..2 {
        app.click("STOP", 100);
    }
    app.wait(300);
    assert!(app.has("State: fault: emergency stop"));
    assert!(app.has("Clear fault"));
}

#[test]
fn two_keys_on_a_silent_real_device_are_an_emergency_stop() {
    for state in [State::Idle, State::Armed] {
        let link = real_device(state);
        let mut window = show(&link);
        for _ in 0..2 {
            window.key_press(Key::Escape);
            window.run_steps(3);
        }
        assert_eq!(sent(&link), "SDE", "{state:?}");
    }
}

#[test]
fn stop_wins_over_drive_in_the_same_picture_whichever_was_pressed_first() {
    let press =
        |key, modifiers| Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
    let (drive, stop) = (press(Key::Enter, Modifiers::COMMAND), press(Key::Escape, Modifiers::NONE));
    for keys in [[drive.clone(), stop.clone()], [stop, drive]] {
        let link = real_device(State::Armed);
        let mut window = show(&link);
        window.input_mut().events.extend(keys);
        window.run_steps(3);
        assert_eq!(sent(&link), "SD");
    }
}
