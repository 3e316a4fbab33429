//! A window that hangs while it drives ends the drive; one that only looks idle does not.

use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, ViewportInfo, vec2};
use slipline_link::protocol::event::State;
use slipline_link::{Request, Severity};
use slipline_model::jobs::table;
use slipline_model::jobs::{JobQueue, Task};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn state(app: &TestApp) -> State {
    app.snapshot().drive.status.unwrap().state
}

/// The text of the message about the hang.
const MESSAGE: &str = "The window did not respond for 1 s, so the drive was stopped and the device disarmed. Press Drive to resume.";

#[test]
fn a_window_that_hangs_is_stopped_and_disarmed_and_says_so_when_it_comes_back() {
    let mut app = TestApp::driving();
    app.hang(1100);
    assert_eq!(state(&app), State::Idle, "while it still hangs");
    app.wait(100);
    assert!(app.has("State: idle"));
    assert!(app.has(MESSAGE), "{:?}", app.window.state().notice());
    let is_logged = |line: &slipline_link::LogEntry| {
        line.severity == Severity::Error && line.text.contains("gave no sign of life for 1 s")
    };
    assert!(app.snapshot().record.log.iter().any(is_logged));
    assert!(app.snapshot().record.log.iter().any(|line| line.text == MESSAGE), "whole, with what to do");
    // No change on the screen drives it again before the user requests it.
    app.key(Key::ArrowRight, 3000);
    assert_eq!(state(&app), State::Idle);
    app.click("Arm", 1000);
    assert_eq!(state(&app), State::Armed);
    assert!(app.has(MESSAGE), "it stays until something is driven");
    app.click("Drive", 600);
    assert!(app.is_driving());
    assert!(!app.has(MESSAGE));
}

#[test]
fn a_press_while_the_window_hung_does_not_drive() {
    let mut app = TestApp::driving();
    app.hang(1500);
    // A drag whose events have waited for the window.
    let line = crate::line_rect(&app).center();
    app.window.drag_at(line);
    app.window.hover_at(line + vec2(40.0, 0.0));
    app.release(line + vec2(40.0, 0.0), 1000);
    assert_eq!(state(&app), State::Idle);
}

#[test]
fn a_window_that_is_held_up_for_less_than_a_second_drives_on() {
    let mut app = TestApp::driving();
    for _ in 0..5 {
        app.hang(700);
        app.pass(300);
    }
    app.wait(100);
    assert!(app.is_driving());
    assert_eq!(app.snapshot().link.driver_stalls, 0);
}

#[test]
fn a_window_that_paints_nothing_is_no_hang() {
    // The event loop turns, and the app is not called.
    let mut app = TestApp::driving();
    app.pass(60_000);
    assert!(app.is_driving());
    assert_eq!(app.snapshot().link.driver_stalls, 0);
}

const MINIMISED: fn(&mut ViewportInfo) = |window| window.minimized = Some(true);
const COVERED: fn(&mut ViewportInfo) = |window| window.occluded = Some(true);

fn drives_on_while(hide: fn(&mut ViewportInfo)) {
    let mut app = TestApp::driving();
    app.wait_hidden(5000, hide);
    assert!(app.is_driving());
    app.wait(100);
    assert!(app.is_driving(), "it is seen again");
    assert_eq!(app.snapshot().link.driver_stalls, 0);
}

#[test]
fn a_minimised_window_is_no_hang() {
    drives_on_while(MINIMISED);
}

#[test]
fn a_covered_window_is_no_hang() {
    drives_on_while(COVERED);
}

#[test]
fn a_window_that_is_being_resized_is_no_hang() {
    let mut app = TestApp::driving();
    for step in 0..60u8 {
        app.window.set_size(vec2(640.0, 400.0) + vec2(10.0, 6.0) * f32::from(step));
        // Most systems have the app paint each size, some only the last one.
        if step < 30 { app.wait(50) } else { app.pass(50) }
    }
    app.wait(50);
    assert!(app.is_driving());
    assert_eq!(app.snapshot().link.driver_stalls, 0);
}

#[test]
fn a_stop_in_the_last_frame_before_the_window_is_hidden_is_one_press() {
    for hide in [MINIMISED, COVERED] {
        let mut app = TestApp::driving();
        app.take_sent();
        app.window.key_down(Key::Escape);
        app.window.step();
        app.wait_hidden(2000, hide);
        let sent = app.take_sent();
        assert!(matches!(sent[..], [Request::Stop, Request::Note(..)]), "{sent:?}");
        assert_eq!(state(&app), State::Armed);
    }
}

#[test]
fn an_open_file_dialog_is_no_hang() {
    let mut app = TestApp::driving();
    app.files.stays_open.set(true);
    for key in [Key::O, Key::S] {
        app.keys(Modifiers::COMMAND, key, 3000);
        assert!(app.is_driving(), "{key:?}");
    }
    assert_eq!(app.snapshot().link.driver_stalls, 0);
}

#[test]
fn a_job_that_takes_long_is_no_hang() {
    let is_held = Arc::new(AtomicBool::new(false));
    let held = Arc::clone(&is_held);
    let make = move |job, task: &Task| {
        while held.load(Ordering::Relaxed) {
            if !task.report(0.4) {
                return None;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        table::make(job, task)
    };
    let mut app = TestApp::with_tables(JobQueue::threaded("table", make, || ()).unwrap());
    app.until("driving", |app| app.is_driving());
    is_held.store(true, Ordering::Relaxed);
    crate::background::open_page(&mut app, "This plate");
    type_into(&mut app, "Wave speed", "13 m/s");
    app.until("a job that runs", |app| app.has_part("table 40 %"));
    app.wait(5000);
    assert!(app.has_part("table 40 %"), "it still runs");
    assert!(app.is_driving());
    assert_eq!(app.snapshot().link.driver_stalls, 0);
    is_held.store(false, Ordering::Relaxed);
}
