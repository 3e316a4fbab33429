//! Messages: they say what was done, cover nothing that is needed, and what was done stays in the log.

use crate::bench::Bench;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use slipline::link::Severity;

fn save(bench: &mut Bench) {
    bench.window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    bench.wait(100);
}

/// Lets so many seconds pass for the window, at 60 pictures a second.
fn watch(bench: &mut Bench, seconds: usize) {
    bench.window.run_steps(60 * seconds);
}

#[test]
fn a_plain_message_goes_by_itself_and_an_error_stays() {
    let mut bench = Bench::driving();
    save(&mut bench);
    watch(&mut bench, 3);
    assert!(bench.window.query_by_label("Saved setup.toml").is_some());
    // Another message has its whole time.
    let text = bench.setup_text();
    bench.open("x.toml", Ok(text));
    watch(&mut bench, 3);
    assert!(bench.window.query_by_label("Opened x.toml").is_some());
    watch(&mut bench, 3);
    assert!(bench.window.state().notice().is_none());
    bench.open("bad.toml", Ok("nonsense".to_owned()));
    watch(&mut bench, 12);
    let notice = bench.window.state().notice().cloned().unwrap();
    assert!(notice.text.contains("bad.toml was not opened"), "{notice:?}");
    assert!(bench.window.query_by_label("Dismiss").is_some());
}

#[test]
fn a_message_goes_even_where_nothing_else_moves() {
    let mut bench = Bench::driving();
    bench.window.key_press(Key::Space);
    bench.wait(3000);
    save(&mut bench);
    watch(&mut bench, 1);
    let delay = bench.window.output().viewport_output.values().map(|view| view.repaint_delay).min().unwrap();
    assert!((1.0..=5.0).contains(&delay.as_secs_f64()), "{delay:?}");
}

#[test]
fn a_click_on_a_message_dismisses_it() {
    let mut bench = Bench::driving();
    save(&mut bench);
    bench.window.get_by_label("Saved setup.toml").click();
    bench.wait(100);
    assert!(bench.window.state().notice().is_none());
}

#[test]
fn a_message_covers_nothing_that_is_used_or_watched() {
    let mut bench = Bench::driving();
    for size in [[1280.0, 800.0], [960.0, 620.0]] {
        bench.window.set_size(size.into());
        save(&mut bench);
        let message = bench.window.get_by_label("Saved setup.toml").rect().expand(8.0);
        for name in ["Wave", "Amplitude", "STOP", "Boundary", "Fit Spectrum", "Copy", "Filter the log"] {
            for node in bench.window.query_all_by_label(name) {
                assert!(!message.intersects(node.rect()), "{size:?}: {name}");
            }
        }
        let chip = bench.window.get_by_label_contains("Validity").rect();
        assert!(!message.intersects(chip), "{size:?}: validity");
        bench.window.get_by_label("Dismiss").click();
        bench.wait(100);
    }
}

#[test]
fn the_log_tells_of_files_by_their_names_alone() {
    let mut bench = Bench::driving();
    save(&mut bench);
    let text = bench.setup_text();
    bench.open("/home/somebody/good.toml", Ok(text));
    bench.open("/home/somebody/bad.toml", Ok("nonsense".to_owned()));
    let log = bench.snapshot().log;
    let has = |severity: Severity, text: &str| {
        log.iter().any(|entry| entry.severity == severity && entry.text.starts_with(text))
    };
    assert!(has(Severity::Info, "Saved setup.toml."));
    assert!(has(Severity::Info, "Opened good.toml."));
    assert!(has(Severity::Error, "bad.toml was not opened"));
    assert!(log.iter().all(|entry| !entry.text.contains("somebody")));
}

/// Two tones in one place, both as loud as can be: more than the DAC can send.
fn ask_too_much(bench: &mut Bench) {
    crate::add_tone(bench);
    let mut setup = bench.window.state().setup().clone();
    setup.master_db = 0.0;
    for tone in &mut setup.tones {
        tone.level = 1.0;
        tone.position_m = 0.2;
    }
    bench.open("loud.toml", Ok(slipline::setup_file::write(&setup)));
    bench.wait(300);
}

#[test]
fn what_the_device_refused_stays_beside_what_is_told_meanwhile() {
    let mut bench = Bench::driving();
    ask_too_much(&mut bench);
    let is_told = |bench: &Bench| bench.window.query_all_by_label_contains("Refused: ").count() > 0;
    assert!(is_told(&bench), "{:?}", bench.window.state().notice());
    save(&mut bench);
    assert!(is_told(&bench) && bench.window.query_by_label("Saved setup.toml").is_some());
    watch(&mut bench, 7);
    assert!(bench.window.query_by_label("Saved setup.toml").is_none());
    assert!(bench.window.state().notice().is_some_and(|notice| notice.text.starts_with("Refused: ")));
    // It goes when the device takes something newer.
    bench.window.get_by_label("Make it fit").click();
    bench.wait(500);
    assert!(bench.window.state().notice().is_none(), "{:?}", bench.window.state().notice());
}

#[test]
fn the_same_words_again_are_shown_their_whole_time() {
    let mut bench = Bench::driving();
    save(&mut bench);
    watch(&mut bench, 3);
    save(&mut bench);
    watch(&mut bench, 3);
    assert!(bench.window.query_by_label("Saved setup.toml").is_some());
    watch(&mut bench, 3);
    assert!(bench.window.query_by_label("Saved setup.toml").is_none());
}
