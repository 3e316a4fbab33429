//! A board's brown-out level and the wear of its flash: a question before the first arming, and rows in the device panel.

use crate::fake_files::FakeFiles;
use crate::fixed_link::FixedLink;
use crate::real_device;
use crate::test_app::{TestApp, open_window};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::Queryable as _;
use slipline_link::Request;
use slipline_link::protocol::command::TravelLimit;
use slipline_link::protocol::event::{Maintenance, State};
use slipline_window::settings::ThemeChoice;
use std::sync::Arc;

/// A real device in this state, with this report of its maintenance.
fn telling(state: State, maintenance: Option<Maintenance>) -> FixedLink {
    let mut link = real_device(state);
    Arc::make_mut(&mut link.snapshot).maintenance = maintenance;
    link
}

const UNGUARDED: Maintenance =
    Maintenance { erasures: 3, erasures_promised: 20_000, brown_out_guarded: false };

fn arms(link: &FixedLink) -> usize {
    link.sent.borrow().iter().filter(|request| matches!(request, Request::Arm)).count()
}

#[test]
fn a_board_without_a_brown_out_level_asks_once_before_it_is_armed() {
    let link = telling(State::Idle, Some(UNGUARDED));
    let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
    let mut window = open_window(Box::new(link.clone()), &FakeFiles::default(), ThemeChoice::Light, builder);
    window.run_steps(5);
    window.get_by_label("Arm…").click();
    window.run_steps(5);
    assert!(window.query_by_label_contains("brown-out level of this board is not set").is_some());
    assert!(window.query_by_label("Arm").is_none(), "the button says what it does");
    window.get_by_label("Cancel").click();
    window.run_steps(5);
    assert_eq!((arms(&link), window.state().settings().unguarded_boards.len()), (0, 0));

    window.get_by_label("Arm…").click();
    window.run_steps(5);
    window.get_by_label("Arm anyway").click();
    window.run_steps(5);
    assert_eq!(arms(&link), 1);
    assert_eq!(window.state().settings().unguarded_boards, [link.snapshot.unit().unwrap()]);

    // From then on it is armed as any other board.
    window.get_by_label("Arm…").click();
    window.run_steps(5);
    assert!(window.query_by_label_contains("brown-out level of this board is not set").is_none());
    window.get_by_label("Arm").click();
    window.run_steps(5);
    assert_eq!(arms(&link), 2);
}

#[test]
fn a_board_with_its_brown_out_level_and_one_that_does_not_tell_ask_nothing_more() {
    for maintenance in [None, Some(Maintenance { brown_out_guarded: true, ..UNGUARDED })] {
        let link = telling(State::Idle, maintenance);
        let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
        let mut window =
            open_window(Box::new(link.clone()), &FakeFiles::default(), ThemeChoice::Light, builder);
        window.run_steps(5);
        window.get_by_label("Arm…").click();
        window.run_steps(5);
        assert!(window.query_by_label_contains("brown-out level").is_none());
        window.get_by_label("Arm").click();
        window.run_steps(5);
        assert_eq!((arms(&link), window.state().settings().unguarded_boards.len()), (1, 0));
    }
}

#[test]
fn the_device_panel_shows_the_wear_of_the_flash_and_the_brown_out_level() {
    let worn = Maintenance { erasures: 20_001, ..UNGUARDED };
    let link = telling(State::Idle, Some(worn));
    let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
    let mut window = open_window(Box::new(link), &FakeFiles::default(), ThemeChoice::Light, builder);
    window.run_steps(5);
    window.get_by_label("Device").click();
    window.run_steps(5);
    for text in ["20001 of 20000 times", "not set"] {
        assert!(window.query_by_label(text).is_some(), "{text}");
    }
    for text in ["flash has been erased 20001 times", "brown-out level of this board is not set"] {
        assert!(window.query_by_label_contains(text).is_some(), "{text}");
    }
}

#[test]
fn the_device_panel_tells_whether_the_actuators_travel_is_limited() {
    let limit = TravelLimit { resonance_uhz: 50_000_000, quality_per_mille: 4000, static_ppm: 2_000_000 };
    for (minor, limit, wanted) in [
        (1, Some(limit), "limited by the device"),
        (1, None, "not limited"),
        (0, None, "not limited: the firmware is too old"),
    ] {
        let mut link = real_device(State::Idle);
        let snapshot = Arc::make_mut(&mut link.snapshot);
        Arc::make_mut(snapshot.identity.as_mut().unwrap()).version.minor = minor;
        snapshot.travel_limit = limit;
        let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
        let mut window = open_window(Box::new(link), &FakeFiles::default(), ThemeChoice::Light, builder);
        window.run_steps(5);
        window.get_by_label("Device").click();
        window.run_steps(5);
        assert!(window.query_by_label(wanted).is_some(), "{wanted}");
    }
}

#[test]
fn a_table_is_kept_by_a_device_that_is_disarmed_first() {
    // High enough for the whole panel.
    let builder =
        HarnessBuilder::default().with_size([1280.0, 1400.0]).with_theme(eframe::egui::Theme::Light);
    let mut app = TestApp::driving_with(ThemeChoice::Light, builder);
    app.window.key_press(eframe::egui::Key::Space);
    app.wait(500);
    app.window.get_by_label("Device").click();
    app.wait(100);
    for written in [true, false] {
        app.take_sent();
        app.window.get_by_label("Keep table…").click();
        app.wait(300);
        app.window.get_by_label("Overwrite").click();
        app.wait(500);
        let sent = app.take_sent();
        let is_asked = |want: fn(&Request) -> bool| sent.iter().any(want);
        assert!(is_asked(|request| matches!(request, Request::Store)), "{sent:?}");
        assert_eq!(is_asked(|request| matches!(request, Request::Disarm)), written, "{sent:?}");
        let snapshot = app.snapshot();
        assert_eq!(snapshot.last_refusal, None);
        assert_eq!(snapshot.maintenance.map(|maintenance| maintenance.erasures), Some(1));
        let is_told = snapshot.log.iter().any(|line| line.text.contains("was not written again"));
        assert_eq!(is_told, !written, "{:?}", snapshot.log);
    }
}
