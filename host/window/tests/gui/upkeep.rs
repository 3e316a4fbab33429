//! A board's brown-out level and the wear of its flash: a question before the first arming, and rows in the device panel.

use crate::fake_files::FakeFiles;
use crate::fixed_link::FixedLink;
use crate::real_device;
use crate::test_app::{TestApp, click, open_window, opened};
use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, HarnessBuilder};
use slipline_link::protocol::board::{Analogue, BoardReport, MuteResistor};
use slipline_link::protocol::command::TravelLimit;
use slipline_link::protocol::event::{Maintenance, State};
use slipline_link::{Request, Snapshot};
use slipline_window::app::App;
use slipline_window::settings::ThemeChoice;
use std::sync::Arc;

/// A real device in this state, with this report of its maintenance.
fn telling(state: State, maintenance: Option<Maintenance>) -> FixedLink {
    let mut link = real_device(state);
    Arc::make_mut(&mut link.snapshot).device.maintenance = maintenance;
    link
}

const UNGUARDED: Maintenance =
    Maintenance { erasures: 3, erasures_promised: 20_000, brown_out_guarded: false };

fn arms(link: &FixedLink) -> usize {
    link.sent.borrow().iter().filter(|request| matches!(request, Request::Arm | Request::ArmFor(_))).count()
}

#[test]
fn a_board_without_a_brown_out_level_asks_once_before_it_is_armed() {
    let link = telling(State::Idle, Some(UNGUARDED));
    let mut window = opened(link.clone(), [1280.0, 800.0]);
    click(&mut window, "Arm…");
    assert!(window.query_by_label_contains("brown-out level of this board is not set").is_some());
    assert!(window.query_by_label("Arm").is_none(), "the button says what it does");
    click(&mut window, "Cancel");
    assert_eq!((arms(&link), window.state().settings().unguarded_boards.len()), (0, 0));

    click(&mut window, "Arm…");
    click(&mut window, "Arm anyway");
    assert_eq!(arms(&link), 1);
    assert_eq!(window.state().settings().unguarded_boards, [link.snapshot.unit().unwrap()]);

    // From then on it is armed as any other board.
    click(&mut window, "Arm…");
    assert!(window.query_by_label_contains("brown-out level of this board is not set").is_none());
    click(&mut window, "Arm");
    assert_eq!(arms(&link), 2);
}

#[test]
fn a_board_with_its_brown_out_level_and_one_that_does_not_report_it_ask_nothing() {
    for maintenance in [None, Some(Maintenance { brown_out_guarded: true, ..UNGUARDED })] {
        let link = telling(State::Idle, maintenance);
        let mut window = opened(link.clone(), [1280.0, 800.0]);
        click(&mut window, "Arm…");
        assert!(window.query_by_label_contains("brown-out level").is_none());
        click(&mut window, "Arm");
        assert_eq!((arms(&link), window.state().settings().unguarded_boards.len()), (1, 0));
    }
}

#[test]
fn a_board_without_a_profile_of_its_actuator_asks_once_before_it_is_armed() {
    let mut link = telling(State::Idle, None);
    Arc::make_mut(&mut link.snapshot).device.profile = Some(Arc::default());
    let mut window = opened(link.clone(), [1280.0, 800.0]);
    let asks = |window: &Harness<'static, App>| {
        window.query_by_label_contains("keeps no profile of its actuator").is_some()
    };
    click(&mut window, "Arm…");
    assert!(asks(&window) && window.query_by_label("Arm").is_none());
    click(&mut window, "Arm anyway");
    assert_eq!(window.state().settings().boards_without_profile, [link.snapshot.unit().unwrap()]);
    click(&mut window, "Arm…");
    assert!(!asks(&window));
    click(&mut window, "Arm");
    assert_eq!(arms(&link), 2);
}

#[test]
fn a_profile_of_the_actuator_is_opened_shown_and_written_to_a_real_board() {
    let files = FakeFiles::default();
    let text = "name = \"coil\"\nmax_sum = 0.8\n".to_owned();
    *files.contents.borrow_mut() = vec![("coil.toml".into(), Ok(text))];
    let mut link = telling(State::Armed, None);
    Arc::make_mut(&mut link.snapshot).device.profile = Some(Arc::default());
    let builder = HarnessBuilder::default().with_size([1280.0, 1400.0]);
    let mut window = open_window(Box::new(link.clone()), &files, ThemeChoice::Light, builder);
    window.run_steps(5);
    click(&mut window, "Device");
    let written = |link: &FixedLink| {
        let sent = link.sent.borrow();
        sent.iter()
            .filter_map(|request| match request {
                Request::WriteProfile(profile) => profile.as_ref().clone(),
                _ => None,
            })
            .collect::<Vec<_>>()
    };
    for (press, count) in [("Cancel", 0), ("Write", 1)] {
        window.get_by_label("Actuator profile…").click();
        window.run_steps(8);
        assert!(window.query_by_label_contains("max_sum = 0.8").is_some());
        assert!(window.query_by_label_contains("Press the user button on the board").is_some());
        click(&mut window, press);
        assert_eq!(written(&link).len(), count);
    }
    assert_eq!((written(&link)[0].name.as_str(), written(&link)[0].max_sum_per_mille), ("coil", 800));
    assert!(link.sent.borrow().iter().any(|request| matches!(request, Request::Disarm)));
    // A value out of range is named and nothing is asked.
    *files.contents.borrow_mut() =
        vec![("coil.toml".into(), Ok("name = \"coil\"\nmax_sum = 8\n".to_owned()))];
    window.get_by_label("Actuator profile…").click();
    window.run_steps(8);
    assert!(window.query_by_label_contains("max_sum = 8: must be 0.001 to 1").is_some());
    assert_eq!(written(&link).len(), 1);
}

#[test]
fn the_brown_out_level_is_set_behind_a_question_that_names_the_risk() {
    let link = telling(State::Idle, Some(UNGUARDED));
    let mut window = opened(link.clone(), [1280.0, 800.0]);
    click(&mut window, "Device");
    click(&mut window, "Set brown-out level…");
    assert!(window.query_by_label_contains("the way back erases its whole flash").is_some());
    let orders = || link.sent.borrow().iter().filter(|it| matches!(it, Request::BrownOut(_))).count();
    assert_eq!(orders(), 0);
    click(&mut window, "Set");
    assert_eq!(orders(), 1);

    let mut window = opened(
        telling(State::Idle, Some(Maintenance { brown_out_guarded: true, ..UNGUARDED })),
        [1280.0, 800.0],
    );
    click(&mut window, "Device");
    assert!(window.query_by_label("Set brown-out level…").is_none());
}

#[test]
fn a_table_is_kept_by_a_device_that_is_disarmed_first() {
    // High enough for the whole panel.
    let builder =
        HarnessBuilder::default().with_size([1280.0, 1400.0]).with_theme(eframe::egui::Theme::Light);
    let mut app = TestApp::driving_with(ThemeChoice::Light, builder);
    app.key(eframe::egui::Key::Space, 500);
    app.click("Device", 100);
    for written in [true, false] {
        app.take_sent();
        app.click("Keep table…", 300);
        app.click("Overwrite", 500);
        let sent = app.take_sent();
        let is_asked = |want: fn(&Request) -> bool| sent.iter().any(want);
        assert!(is_asked(|request| matches!(request, Request::Store)), "{sent:?}");
        assert_eq!(is_asked(|request| matches!(request, Request::Disarm)), written, "{sent:?}");
        let snapshot = app.snapshot();
        assert_eq!(snapshot.record.last_refusal, None);
        assert_eq!(snapshot.device.maintenance.map(|maintenance| maintenance.erasures), Some(1));
        let is_told = snapshot.record.log.iter().any(|line| line.text.contains("was not written again"));
        assert_eq!(is_told, !written, "{:?}", snapshot.record.log);
    }
}

#[test]
fn the_meters_count_with_the_linear_share_of_a_boards_output() {
    let shown = |sum_per_mille, linear_per_mille| {
        let mut link = telling(State::Driving, None);
        let snapshot = Arc::make_mut(&mut link.snapshot);
        snapshot.drive.status.as_mut().unwrap().sum_per_mille = sum_per_mille;
        snapshot.device.analogue = Some(Analogue { linear_per_mille, ..Analogue::default() });
        let window = opened(link, [1280.0, 800.0]);
        [-6.0, -0.9, 0.9, 1.1, 6.0]
            .into_iter()
            .filter(|db| window.query_by_label(&format!("Headroom: {db:.1} dB")).is_some())
            .collect::<Vec<f64>>()
    };
    assert_eq!(shown(900, 1000), [0.9]);
    assert_eq!(shown(440, 880), [6.0]);
    // Beyond it: 975 of 880 per mille.
    assert_eq!(shown(975, 880), [-0.9]);
}

/// The device panel beside a board that is like this shows these words, and not those.
fn panel(change: impl FnOnce(&mut Snapshot), shown: &[&str], hidden: &[&str]) -> Harness<'static, App> {
    let mut link = telling(State::Idle, None);
    change(Arc::make_mut(&mut link.snapshot));
    let mut window = opened(link, [1280.0, 1400.0]);
    click(&mut window, "Device");
    let shows = |words: &str| window.query_all_by_label_contains(words).next().is_some();
    assert!(shown.iter().all(|words| shows(words)), "{shown:?}");
    assert!(!hidden.iter().any(|words| shows(words)), "{hidden:?}");
    window
}

#[test]
fn the_device_panel_says_what_a_board_reports_and_warns_of_what_is_wrong() {
    let missing = BoardReport { mute_resistor: MuteResistor::Missing, ..BoardReport::default() };
    panel(|it| it.device.board = Some(missing), &["Muted: no resistor at the mute pin."], &[]);

    let worn = Maintenance { erasures: 20_001, ..UNGUARDED };
    let said =
        ["20001 of 20000 times", "flash has been erased 20001 times", "level of this board is not set"];
    let window = panel(|it| it.device.maintenance = Some(worn), &said, &[]);
    assert!(window.query_by_label("not set").is_some());

    // A block of nine tenths of its time or more.
    let took = |max_cycles| {
        move |it: &mut Snapshot| {
            it.drive.status.as_mut().unwrap().counters.max_cycles = max_cycles;
            // Blocks of 128 codes at 400 kS/s, or 53 760 cycles of this clock.
            it.device.board = Some(BoardReport { core_hz: 168_000_000, ..BoardReport::default() });
        }
    };
    let warning = "took 93 % of a block's time";
    panel(took(48_000), &[], &[warning]);
    panel(took(50_000), &["50000 (93 %)", warning], &[]);

    let refers = |reference_mv| Some(Analogue { reference_mv, linear_per_mille: 880, ..Analogue::default() });
    let warning = "The reference voltage VREF+ is 2.70 V";
    panel(|it| it.device.analogue = refers(0), &[], &[warning]);
    panel(|it| it.device.analogue = refers(3300), &[], &[warning]);
    panel(|it| it.device.analogue = refers(2700), &[warning], &[]);

    let limit = TravelLimit { resonance_uhz: 50_000_000, quality_per_mille: 4000, static_ppm: 2_000_000 };
    let limits = |minor, limit| {
        move |it: &mut Snapshot| {
            Arc::make_mut(it.device.identity.as_mut().unwrap()).version.minor = minor;
            it.drive.travel_limit = limit;
        }
    };
    let too_old = "not limited: the firmware is too old";
    panel(limits(1, Some(limit)), &["limited by the device"], &["not limited"]);
    panel(limits(1, None), &["not limited"], &[too_old]);
    panel(limits(0, None), &[too_old], &[]);
}
