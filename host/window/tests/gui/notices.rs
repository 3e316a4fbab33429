//! Messages: they report results, cover no control that is needed, and remain in the log.

use crate::test_app::TestApp;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Rect, accesskit::Role, pos2};
use egui_kittest::kittest::Queryable as _;
use slipline_link::Severity;

fn save(app: &mut TestApp) {
    app.keys(Modifiers::COMMAND, Key::S, 100);
}

/// Runs the window for this many seconds, at 60 frames per second.
fn watch(app: &mut TestApp, seconds: usize) {
    app.window.run_steps(60 * seconds);
}

/// Advances the window's clock by this many seconds in one step.
fn skip(app: &mut TestApp, seconds: f64) {
    let now = app.window.ctx.input(|input| input.time);
    app.window.input_mut().time = Some(now + seconds);
    app.window.step();
    app.window.input_mut().time = None;
    app.window.step();
}

#[test]
fn a_plain_message_goes_by_itself() {
    let mut app = TestApp::driving();
    save(&mut app);
    watch(&mut app, 3);
    assert!(app.has("Saved setup.toml"));
    // Another message is shown for its full time.
    let text = app.setup_text();
    app.open("x.toml", Ok(text));
    watch(&mut app, 3);
    assert!(app.has("Opened x.toml"));
    watch(&mut app, 3);
    assert!(app.window.state().notice().is_none());
}

#[test]
fn a_message_goes_even_where_nothing_else_moves() {
    let mut app = TestApp::driving();
    app.key(Key::Space, 3000);
    save(&mut app);
    watch(&mut app, 1);
    let delay = app.window.output().viewport_output.values().map(|view| view.repaint_delay).min().unwrap();
    assert!((1.0..=5.0).contains(&delay.as_secs_f64()), "{delay:?}");
}

#[test]
fn a_click_on_a_message_dismisses_it() {
    let mut app = TestApp::driving();
    save(&mut app);
    app.click("Saved setup.toml", 100);
    assert!(app.window.state().notice().is_none());
}

#[test]
fn a_message_covers_nothing_that_is_used_or_watched() {
    let mut app = TestApp::driving();
    for size in [[1280.0, 800.0], [960.0, 620.0]] {
        app.window.set_size(size.into());
        if !app.has("Log") {
            app.click("Open the log", 100);
        }
        save(&mut app);
        let message = app.window.get_by_label("Saved setup.toml").rect().expand(8.0);
        for name in ["Wave", "Amplitude", "STOP", "Boundary", "Close the log", "Copy", "Filter the log"] {
            for node in app.window.query_all_by_label(name) {
                assert!(!message.intersects(node.rect()), "{size:?}: {name}");
            }
        }
        let chip = app.window.get_by_label_contains("Validity").rect();
        assert!(!message.intersects(chip), "{size:?}: validity");
        let lines = app.window.get_all_by_label_contains("simulated with firmware");
        assert!(lines.chain(app.window.get_all_by_label("Log")).all(|line| !message.intersects(line.rect())));
        app.click("Dismiss", 100);
    }
}

#[test]
fn the_log_names_files_without_their_folders() {
    let mut app = TestApp::driving();
    save(&mut app);
    let text = app.setup_text();
    app.open("/home/somebody/good.toml", Ok(text));
    app.open("/home/somebody/bad.toml", Ok("nonsense".to_owned()));
    let log = app.snapshot().record.log;
    let has = |severity: Severity, text: &str| {
        log.iter().any(|entry| entry.severity == severity && entry.text.starts_with(text))
    };
    assert!(has(Severity::Info, "Saved setup.toml."));
    assert!(has(Severity::Info, "Opened good.toml."));
    assert!(has(Severity::Error, "bad.toml was not opened"));
    assert!(log.iter().all(|entry| !entry.text.contains("somebody")));
}

/// Opens a file that is refused with a reason of many lines.
fn open_bad_file(app: &mut TestApp) {
    app.open("bad.toml", Err("this reason is as long as a reason gets when a file says much. ".repeat(12)));
    app.wait(100);
}

#[test]
fn an_error_goes_after_half_a_minute_and_stays_in_the_log() {
    let mut app = TestApp::driving();
    open_bad_file(&mut app);
    skip(&mut app, 28.0);
    assert!(app.window.state().notice().is_some_and(|notice| notice.is_error) && app.has("Dismiss"));
    skip(&mut app, 3.0);
    assert!(app.window.state().notice().is_none());
    assert!(app.snapshot().record.log.iter().any(|entry| entry.text.starts_with("bad.toml was not opened")));
}

#[test]
fn a_long_message_is_cut_and_shown_in_full_when_it_is_pressed() {
    let mut app = TestApp::driving();
    open_bad_file(&mut app);
    let text = app.window.state().notice().unwrap().text.clone();
    let message = |app: &TestApp| app.window.get_by_label(&text).rect();
    let cut = message(&app);
    assert!(cut.height() < 50.0, "{cut}");
    let at = cut.center();
    app.window.hover_at(at);
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        app.window.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        app.window.step();
    }
    app.wait(200);
    assert!(message(&app).height() > 4.0 * cut.height(), "{}", message(&app));
    // A message that is shown in full does not disappear with time.
    skip(&mut app, 60.0);
    assert!(app.window.state().notice().is_some());
    app.click("Dismiss", 100);
    assert!(app.window.state().notice().is_none());
}

#[test]
fn several_messages_leave_the_panels_controls_in_sight() {
    for size in [[640.0, 480.0], [800.0, 480.0], [960.0, 620.0], [1280.0, 800.0]] {
        let mut app = TestApp::driving();
        app.resize(size.into(), 100);
        ask_too_much(&mut app);
        open_bad_file(&mut app);
        app.keys(Modifiers::COMMAND, Key::Num1, 200);
        let dismiss: Vec<Rect> = app.window.get_all_by_label("Dismiss").map(|node| node.rect()).collect();
        assert_eq!(dismiss.len(), 2, "{size:?}");
        assert!(
            dismiss.iter().all(|rect| rect.width() >= 24.0 && rect.height() >= 24.0),
            "{size:?}: {dismiss:?}"
        );
        let top = dismiss.iter().map(|rect| rect.top()).fold(f32::INFINITY, f32::min);
        for name in ["Boundary position", "Boundary frequency"] {
            let field = app.window.get_by_role_and_label(Role::TextInput, name).rect();
            assert!(
                field.bottom() < top && field.top() > 60.0,
                "{size:?}: {name} {field}, messages from {top}"
            );
        }
        assert!(top > 0.55 * size[1] - 54.0, "{size:?}: {top}");
    }
}

/// Two tones at one place at full level: more than the DAC can output.
fn ask_too_much(app: &mut TestApp) {
    crate::add_tone(app);
    let mut setup = app.window.state().setup().clone();
    setup.master_db = 0.0;
    for tone in &mut setup.tones {
        tone.level = 1.0;
        tone.position_m = 0.2;
    }
    app.open("loud.toml", Ok(slipline_model::setup::file::write(&setup)));
    app.wait(300);
}

#[test]
fn a_refusal_of_the_device_stays_beside_later_notices() {
    let mut app = TestApp::driving();
    ask_too_much(&mut app);
    let is_told = |app: &TestApp| app.window.query_all_by_label_contains("Refused: ").count() > 0;
    assert!(is_told(&app), "{:?}", app.window.state().notice());
    save(&mut app);
    assert!(is_told(&app) && app.has("Saved setup.toml"));
    watch(&mut app, 7);
    assert!(!app.has("Saved setup.toml"));
    assert!(app.window.state().notice().is_some_and(|notice| notice.text.starts_with("Refused: ")));
    // The message disappears when the device accepts something newer.
    app.click("Make it fit", 500);
    assert!(app.window.state().notice().is_none(), "{:?}", app.window.state().notice());
}

#[test]
fn a_silent_port_is_reported_until_another_one_answers() {
    let mut app = TestApp::driving();
    app.click("Device", 100);
    app.click("Disconnect", 500);
    app.plug(false);
    app.window.get_all_by_label("Connect").next().unwrap().click();
    app.wait(2000);
    let notice = app.window.state().notice().cloned().unwrap();
    assert!(
        notice.is_error && notice.text == "There is no port sim: is the device plugged in?",
        "{notice:?}"
    );
    save(&mut app);
    assert!(app.has(&notice.text), "it stays beside later messages");
    // It is waited for, so nothing needs to be clicked.
    app.plug(true);
    app.wait(2000);
    assert!(app.snapshot().is_connected());
    assert!(!app.has(&notice.text));
}

#[test]
fn a_tone_that_lowers_the_master_or_lies_beyond_the_span_is_reported() {
    let mut app = TestApp::driving();
    crate::add_tone(&mut app);
    let message = app.window.state().notice().cloned().unwrap().text;
    assert_eq!(message, "Master lowered to -4.1 dB, so that 2 tones fit.");
    let line = crate::line_rect(&app);
    app.window.get_by_label("Dismiss").click();
    // Long enough so that this click is not part of the double click below.
    watch(&mut app, 1);
    // At the wide end, where no boundary can be.
    let at = pos2(120.0, line.top() + 0.3 * line.height());
    app.window.hover_at(at);
    for pressed in [true, false, true, false] {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        app.window.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        app.window.step();
    }
    app.wait(200);
    assert_eq!(app.window.state().setup().tones.len(), 3);
    let message = app.window.state().notice().cloned().unwrap().text;
    assert!(
        message.starts_with("Master lowered")
            && message.ends_with("Tone 3 is at 80.0 mm: a line can be at 80.0 mm to 280.0 mm."),
        "{message}"
    );
}

#[test]
fn the_same_words_again_are_shown_their_whole_time() {
    let mut app = TestApp::driving();
    save(&mut app);
    watch(&mut app, 3);
    save(&mut app);
    watch(&mut app, 3);
    assert!(app.has("Saved setup.toml"));
    watch(&mut app, 3);
    assert!(!app.has("Saved setup.toml"));
}

#[test]
fn a_message_moves_nothing_stands_in_one_line_at_the_bottom_and_is_in_the_log() {
    for size in [[1280.0, 800.0], [640.0, 480.0]] {
        let mut app = TestApp::driving();
        app.resize(size.into(), 100);
        app.keys(Modifiers::COMMAND, Key::Num0, 200);
        app.keys(Modifiers::COMMAND, Key::Num0, 200);
        ask_too_much(&mut app);
        app.keys(Modifiers::COMMAND, Key::Num0, 200);
        let before = crate::line_rect(&app);
        open_bad_file(&mut app);
        save(&mut app);
        assert_eq!(crate::line_rect(&app), before, "{size:?}: the stage stays");
        assert!(!app.has("Tones"), "{size:?}: the hidden panel stays hidden");
        let dismiss: Vec<Rect> = app.window.get_all_by_label("Dismiss").map(|node| node.rect()).collect();
        assert!(dismiss.iter().all(|rect| rect.bottom() > size[1] - 34.0), "{size:?}: {dismiss:?}");
        let log = app.snapshot().record.log;
        for part in ["Saved setup.toml.", "add up to"] {
            assert!(log.iter().any(|entry| entry.text.contains(part)), "{part}: {log:?}");
        }
    }
    // A refusal of the window itself is in the log with all its words.
    let mut app = TestApp::driving();
    app.click_button("Plate", 100);
    app.click_button("Measure", 200);
    app.click_button("Measure now", 200);
    let text = app.window.state().notice().cloned().unwrap().text;
    assert!(app.snapshot().record.log.iter().any(|entry| entry.text == text), "{text}");
}

/// The words of a message without what introduces a refusal, and in lower case: a message begins with a capital.
fn words(text: &str) -> String {
    text.strip_prefix("Refused: ").unwrap_or(text).to_lowercase()
}

#[test]
fn every_message_of_the_link_is_in_the_log_whole() {
    let is_logged = |app: &TestApp, begins: &str| {
        let text = app.window.state().notice().cloned().unwrap().text;
        assert!(text.starts_with(begins), "{text}");
        let words = words(&text);
        let log = app.snapshot().record.log;
        assert!(log.iter().any(|entry| entry.text.to_lowercase().contains(&words)), "{words}: {log:?}");
    };
    // What the device refuses of a drive, and of another request.
    let mut app = TestApp::driving();
    ask_too_much(&mut app);
    is_logged(&app, "Refused: ");
    // A drive that was ended because the window hung.
    let mut app = TestApp::driving();
    app.hang(1100);
    app.wait(100);
    is_logged(&app, "The window did not respond for 1 s");
    // A port that does not exist.
    let mut app = TestApp::unplugged();
    app.wait(1500);
    is_logged(&app, "There is no port sim");
}
