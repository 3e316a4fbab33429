//! After ten minutes without a request the device stops by itself, the window says so, and Drive starts it again.

use crate::fake_files::FakeFiles;
use crate::fixed_link::FixedLink;
use crate::real_device;
use crate::test_app::{TestApp, open_window};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::{Fault, Faults, State};
use slipline_link::protocol::limits::MAX_DRIVE_MS;
use slipline_link::{Request, Sounding};
use slipline_window::settings::ThemeChoice;
use std::sync::Arc;

#[test]
#[ignore = "ten minutes of a device's samples: .ci/run long_tests"]
fn the_simulated_plate_goes_on_with_one_press_after_ten_minutes() {
    let mut app = TestApp::driving();
    app.pass(u64::from(MAX_DRIVE_MS));
    app.wait(500);
    assert!(app.window.query_by_label("State: fault: 10 minutes without a command").is_some());
    let shows = |app: &TestApp| {
        let words = crate::plots::words(app.window.output());
        words.iter().any(|(words, _)| words == "fault: 10 minutes without a command")
    };
    assert!(shows(&app));
    // In a narrow bar the tooltip has the cause, and nothing is pushed out of the window.
    app.window.set_size([640.0, 480.0].into());
    app.wait(100);
    assert!(!shows(&app) && app.window.get_by_label("STOP").rect().right() <= 640.0);
    let told = "Stopped after 10 minutes without a command. Press Drive to go on.";
    assert!(app.window.query_by_label(told).is_some(), "{:?}", app.window.state().notice());
    assert!(app.snapshot().log.iter().any(|entry| entry.text == told), "whole, with what to do");
    assert!(app.window.query_by_label("Clear fault").is_none());
    app.wait(1000);
    assert!(!app.is_driving(), "not before it is asked to");
    app.window.get_by_label("Drive").click();
    app.wait(1000);
    assert!(app.is_driving());
    assert!(app.window.state().notice().is_none(), "{:?}", app.window.state().notice());
}

fn stopped(faults: Faults, is_simulated: bool) -> FixedLink {
    let mut link = real_device(State::Fault);
    let snapshot = Arc::make_mut(&mut link.snapshot);
    snapshot.status.as_mut().unwrap().faults = faults;
    Arc::make_mut(snapshot.identity.as_mut().unwrap()).simulated = is_simulated;
    link
}

#[test]
fn a_real_device_and_every_other_fault_are_cleared_by_hand() {
    let drive_time = Faults::NONE.with(Fault::DriveTime);
    for link in [stopped(drive_time, false), stopped(drive_time.with(Fault::Overheat), true)] {
        let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
        let mut window =
            open_window(Box::new(link.clone()), &FakeFiles::default(), ThemeChoice::Light, builder);
        window.run_steps(5);
        let told = window.state().notice().cloned().unwrap().text;
        assert!(told.starts_with("Stopped after 10 minutes") && told.contains("Clear fault"), "{told}");
        assert!(window.query_by_label("Drive").is_none());
        link.sent.borrow_mut().clear();
        window.key_press_modifiers(eframe::egui::Modifiers::COMMAND, eframe::egui::Key::Enter);
        window.run_steps(5);
        let sent = link.sent.borrow();
        let is_kept =
            |request: &Request| matches!(request, Request::ClearFaults | Request::Play(Sounding::Drive(_)));
        assert!(!sent.iter().any(is_kept), "{sent:?}");
    }
}

#[test]
fn a_simulated_drive_is_paused_before_its_limit_and_a_real_one_is_not() {
    for is_simulated in [true, false] {
        let mut link = real_device(State::Driving);
        let snapshot = Arc::make_mut(&mut link.snapshot);
        Arc::make_mut(snapshot.identity.as_mut().unwrap()).simulated = is_simulated;
        let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
        let mut window =
            open_window(Box::new(link.clone()), &FakeFiles::default(), ThemeChoice::Light, builder);
        window.run_steps(5);
        window.key_press_modifiers(eframe::egui::Modifiers::COMMAND, eframe::egui::Key::Enter);
        window.run_steps(5);
        let stops = |link: &FixedLink| {
            link.sent.borrow_mut().drain(..).filter(|request| matches!(request, Request::Stop)).count()
        };
        let later = |minutes: f64| {
            let mut snapshot = (*link.snapshot).clone();
            let rate_hz = f64::from(snapshot.identity.as_ref().unwrap().sample_rate_hz);
            snapshot.status.as_mut().unwrap().now = (60.0 * minutes * rate_hz) as u64;
            link.become_known(snapshot);
        };
        stops(&link);
        later(9.8);
        window.run_steps(5);
        assert_eq!(stops(&link), 0);
        later(9.95);
        window.run_steps(5);
        assert_eq!(stops(&link), usize::from(is_simulated));
        let text = window.state().notice().cloned().map(|notice| notice.text).unwrap_or_default();
        assert_eq!(text.starts_with("Paused: nothing was changed for 10 minutes."), is_simulated, "{text}");
    }
}
