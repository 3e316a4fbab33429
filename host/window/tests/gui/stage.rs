//! The stage: what cannot be reached is seen and said, and no words lie where there is something to see.

use crate::bench::Bench;
use crate::plots::words;
use crate::{add_tone, boundary_mm, line_rect};
use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers, Rect, vec2};
use egui_kittest::kittest::Queryable as _;

fn painted(bench: &Bench, word: &str) -> Option<Rect> {
    let words = words(bench.window.output());
    words.into_iter().find(|(painted, _)| painted.contains(word)).map(|(_, rect)| rect)
}

#[test]
fn a_drag_against_the_end_of_the_span_says_so() {
    let mut bench = Bench::driving();
    let line = line_rect(&bench).center();
    bench.window.drag_at(line);
    bench.window.step();
    bench.window.hover_at(line + vec2(40.0, 0.0));
    bench.wait(50);
    assert!(painted(&bench, "the span ends here").is_none());
    bench.window.hover_at(line + vec2(600.0, 0.0));
    bench.wait(50);
    assert_eq!(boundary_mm(&bench), 280.0);
    assert!(painted(&bench, "the span ends here").is_some());
    bench.window.hover_at(line - vec2(600.0, 0.0));
    bench.wait(50);
    assert!(painted(&bench, "the span begins here").is_some());
    bench.window.drop_at(line - vec2(600.0, 0.0));
    bench.wait(50);
}

#[test]
fn the_words_about_what_is_felt_lie_below_the_strip() {
    for size in [[1280.0, 800.0], [900.0, 600.0]] {
        let mut bench = Bench::driving();
        bench.window.set_size(size.into());
        bench.wait(100);
        let (line, words) = (line_rect(&bench), painted(&bench, "illustrative").unwrap());
        assert!(words.top() >= line.bottom(), "{size:?}: {words} {line}");
        let number = painted(&bench, "300").unwrap();
        assert!(!words.intersects(number), "{size:?}: {words} {number}");
        // The row of plots begins below.
        assert!(words.bottom() < bench.window.get_by_label("Log").rect().top());
    }
}

#[test]
fn a_tones_number_is_seen_beside_the_boundarys_flag() {
    let mut bench = Bench::driving();
    add_tone(&mut bench);
    // Just beside the other tone, below whose flag its number would be.
    let mut setup = bench.window.state().setup().clone();
    setup.tones[1].position_m = setup.tones[0].position_m + 0.008;
    let text = slipline_model::setup::file::write(&setup);
    bench.open("two.toml", Ok(text));
    bench.wait(300);
    bench.window.get_by_label("Select tone 1").click();
    bench.wait(100);
    let flag = painted(&bench, "   edge ").unwrap().expand2(vec2(10.0, 3.0));
    let number = bench.window.get_by_label("Peak of tone 2").rect().center().x;
    let words = words(bench.window.output());
    let (_, number) =
        words.iter().find(|(word, at)| word == "2" && (at.center().x - number).abs() < 2.0).unwrap();
    assert!(!flag.intersects(*number), "{flag} {number}");
}

#[test]
fn the_plates_name_and_the_filters_hint_are_whole_in_a_small_window() {
    let mut bench = Bench::driving();
    crate::background::open_plate(&mut bench, slipline_plate::preset("al-bending").unwrap().to_toml());
    bench.wait(1500);
    bench.window.set_size(vec2(960.0, 620.0));
    bench.wait(100);
    assert!(painted(&bench, "al-bending").is_some_and(|name| name.top() > 40.0));
    let filter = bench.window.get_by_label("Filter the log").rect();
    let words = words(bench.window.output());
    let hint = words.iter().find(|(_, at)| filter.contains(at.center()));
    assert!(hint.is_some_and(|(hint, _)| hint == "find"), "{hint:?}");
}

#[test]
fn new_is_undone_by_its_name() {
    let mut bench = Bench::driving();
    let press = |bench: &mut Bench, name: &str| {
        bench.window.get_by_label(name).click();
        bench.wait(200);
    };
    crate::type_into(&mut bench, "Boundary position", "120 mm");
    press(&mut bench, "File");
    bench.window.get_by_label_contains("New").click();
    bench.wait(200);
    press(&mut bench, "Edit");
    assert!(bench.window.query_by_label_contains("Undo new setup").is_some());
}

#[test]
fn the_values_of_the_sliders_end_in_one_line() {
    let mut bench = Bench::driving();
    add_tone(&mut bench);
    bench.window.key_press_modifiers(Modifiers::COMMAND, Key::Num1);
    bench.wait(100);
    let boxes: Vec<Rect> = ["Level", "Master", "Glide"]
        .map(|name| bench.window.get_by_role_and_label(Role::TextInput, name).rect())
        .to_vec();
    let panel = bench.window.get_by_label("Device").rect().right();
    for at in &boxes {
        assert!((at.right() - boxes[0].right()).abs() < 0.5 && at.right() <= panel, "{boxes:?}");
    }
    let words = words(bench.window.output());
    let (_, master) = words.iter().find(|(_, at)| boxes[1].contains(at.center())).unwrap();
    assert!(boxes[1].contains_rect(*master), "{master} {boxes:?}");
}

#[test]
fn the_outputs_counters_stay_in_the_window_below_a_heading_level_with_the_others() {
    let bench = Bench::driving();
    let heading = |name: &str| bench.window.get_by_label(name).rect().center().y;
    assert!(
        (heading("Output") - heading("Spectrum")).abs() < 1.0,
        "{} {}",
        heading("Output"),
        heading("Spectrum")
    );
    let last = bench.window.get_by_label("CRC errors").rect();
    // Of the panel, which ends before the window of the test does.
    assert!(last.bottom() <= 792.0 - 8.0, "{last}");
}

#[test]
fn the_logs_lines_begin_in_one_column() {
    let mut bench = Bench::driving();
    bench.pass(12_000);
    bench.window.get_by_label("Device").click();
    bench.wait(100);
    bench.window.get_by_label("Disconnect").click();
    bench.wait(500);
    let left = |bench: &Bench, text: &str| {
        bench.window.get_all_by_label_contains(text).next().unwrap().rect().left()
    };
    let (first, last) = (left(&bench, "Connecting to sim."), left(&bench, "Disconnected"));
    assert!((first - last).abs() < 0.5, "{first} {last}");
}

#[test]
fn the_choice_of_colours_is_one_of_the_settings_that_are_kept() {
    let mut bench = Bench::driving();
    assert!(!bench.window.state().settings().show_amplitude);
    bench.window.get_by_label("Amplitude").click();
    bench.wait(100);
    assert!(bench.window.state().settings().show_amplitude);
    assert!(bench.window.query_by_label("2-D sheet, largest").is_some());
    bench.window.get_by_label("Wave").click();
    bench.wait(100);
    assert!(!bench.window.state().settings().show_amplitude);
}
