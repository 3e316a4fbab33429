//! What is heard: the finger on the simulated plate, the drive when it is asked for, and nothing of a real device unasked.

use crate::background::open_plate;
use crate::finger::{choose, drag_by};
use crate::real_device;
use crate::test_app::{TestApp, opened};
use eframe::egui::{self, Key, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::State;
use slipline_window::sound::SpeakerState;

#[test]
fn the_finger_sounds_where_the_plate_moves_and_not_beyond() {
    let mut app = TestApp::driving();
    assert_eq!(app.speaker.loudness(), 0.0, "there is no finger yet");
    assert!(app.window.query_by_role_and_label(Role::Slider, "Volume").is_none());
    choose(&mut app, "Light");
    app.wait(100);
    let at_peak = app.speaker.loudness();
    assert!(at_peak > 0.05, "{at_peak}");
    assert_eq!(app.speaker.played.borrow().1, 0.5, "the volume");
    drag_by(&mut app, &[200.0, 200.0]);
    app.wait(100);
    assert!(app.speaker.loudness() < 0.02 * at_peak, "beyond the boundary");
    drag_by(&mut app, &[-400.0]);
    app.wait(100);
    assert!(app.speaker.loudness() > 0.5 * at_peak);
    app.key(Key::Escape, 400);
    assert!(app.speaker.played.borrow().0.is_silent(), "after the stop");
}

#[test]
fn a_finger_that_slides_makes_a_noise() {
    let mut app = TestApp::driving();
    choose(&mut app, "Light");
    app.wait(300);
    assert_eq!(app.speaker.played.borrow().0.noise, 0.0);
    drag_by(&mut app, &[10.0, 10.0, 10.0]);
    assert!(app.speaker.played.borrow().0.noise > 0.0);
}

#[test]
fn a_wave_that_is_paused_and_a_choice_of_off_are_silent_and_the_choice_is_kept() {
    let mut app = TestApp::driving();
    choose(&mut app, "Light");
    app.wait(100);
    assert!(app.window.state().settings().hear_finger);
    choose(&mut app, "Sound: Off");
    app.wait(50);
    assert!(app.speaker.played.borrow().0.is_silent());
    assert!(!app.window.state().settings().hear_finger);
    assert!(app.window.query_by_role_and_label(Role::Slider, "Volume").is_none());
    choose(&mut app, "Sound: Finger");
    app.wait(50);
    assert!(app.speaker.loudness() > 0.05 && app.window.state().settings().hear_finger);
    app.click("Pause: Finger trace", 100);
    assert!(app.speaker.played.borrow().0.is_silent(), "paused");
}

#[test]
fn the_drive_is_played_when_it_is_asked_for_and_ends_with_the_stop() {
    let mut app = TestApp::driving();
    choose(&mut app, "Sound: Drive");
    app.wait(100);
    let (sound, _) = app.speaker.played.borrow().clone();
    let [partial] = sound.partials[..] else { panic!("{sound:?}") };
    let plate = &app.window.state().setup().plate;
    let wanted_hz = plate.frequency_for_boundary_hz(crate::boundary_mm(&app) * 1e-3);
    assert!((partial.frequency_hz / wanted_hz - 1.0).abs() < 1e-4, "{partial:?} {wanted_hz}");
    assert!(partial.amplitude > 0.01);
    app.click("STOP", 400);
    assert!(app.speaker.played.borrow().0.is_silent());
    assert!(app.window.state().settings().hear_finger, "the drive is never played at the next start");
}

#[test]
fn a_sound_card_plays_no_ultrasound_and_says_so() {
    let mut app = TestApp::driving();
    open_plate(&mut app, slipline_plate::preset("al-bending").unwrap().to_toml());
    app.wait(2000);
    choose(&mut app, "Sound: Drive");
    app.wait(100);
    assert!(app.is_driving() && app.speaker.played.borrow().0.is_silent());
    assert!(app.has_part("is left out"));
}

#[test]
fn a_sound_card_that_fails_says_why_and_can_be_tried_again() {
    let mut app = TestApp::driving();
    choose(&mut app, "Light");
    let reason = "neither PulseAudio nor PipeWire is running here";
    *app.speaker.state.borrow_mut() = SpeakerState::Failed(reason.to_owned());
    app.wait(50);
    assert!(app.has_part(&format!("No sound: {reason}.")));
    app.window.get_by_role_and_label(Role::Button, "Try again").click_accesskit();
    app.wait(100);
    assert_eq!(app.speaker.retries.get(), 1);
    assert!(!app.has_part("No sound"));
}

#[test]
fn a_real_device_makes_no_sound_unasked() {
    let link = real_device(State::Driving);
    let window = opened(link, [1280.0, 800.0]);
    let off = window.get_by_role_and_label(Role::RadioButton, "Sound: Off");
    assert_eq!(
        egui_kittest::kittest::NodeT::accesskit_node(&off).toggled(),
        Some(egui::accesskit::Toggled::True)
    );
}
