//! Where the system has no dialog for files, a path is typed.

use crate::bench::Bench;
use crate::type_into;
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::path::PathBuf;

fn bare() -> Bench {
    let bench = Bench::driving();
    bench.drawer.has_no_dialogs.set(true);
    bench
}

fn press(bench: &mut Bench, key: Key) {
    bench.window.key_press_modifiers(Modifiers::COMMAND, key);
    bench.wait(200);
}

fn is_asked(bench: &Bench) -> bool {
    bench.window.query_by_role_and_label(Role::TextInput, "File path").is_some()
}

#[test]
fn a_setup_is_saved_to_the_path_that_is_typed() {
    let mut bench = bare();
    press(&mut bench, Key::S);
    assert!(bench.window.query_by_label_contains("offers no dialog for files").is_some());
    let field = bench.window.get_by_role_and_label(Role::TextInput, "File path");
    assert!(field.accesskit_node().is_focused(), "it can be typed into at once");
    assert!(field.value().unwrap().ends_with("setup.toml"), "{:?}", field.value());
    assert!(bench.drawer.saved.borrow().is_empty());
    type_into(&mut bench, "File path", "/tmp/mine.toml");
    bench.wait(200);
    assert!(!is_asked(&bench));
    assert_eq!(bench.drawer.saved.borrow().len(), 1);
    assert!(bench.window.query_by_label("Saved /tmp/mine.toml").is_some());
    assert!(bench.is_driving());
}

#[test]
fn a_file_that_is_there_is_replaced_only_by_the_button_that_says_so() {
    let mut bench = bare();
    for _ in 0..2 {
        press(&mut bench, Key::S);
        type_into(&mut bench, "File path", "/tmp/mine.toml");
        bench.wait(200);
    }
    assert_eq!(bench.drawer.saved.borrow().len(), 1, "the second time it is there");
    assert!(bench.window.query_by_label_contains("There is a file of that name").is_some());
    bench.window.key_press(Key::Enter);
    bench.wait(200);
    assert_eq!(bench.drawer.saved.borrow().len(), 1, "Enter alone replaces nothing");
    bench.window.get_by_label("Replace").click();
    bench.wait(200);
    assert_eq!(bench.drawer.saved.borrow().len(), 2);
    assert!(!is_asked(&bench));
}

#[test]
fn a_file_is_opened_by_its_path_and_one_that_is_not_there_is_said_so() {
    let mut bench = bare();
    let text = bench.setup_text();
    crate::arrow_right(&mut bench);
    let moved = crate::boundary_mm(&bench);
    *bench.drawer.contents.borrow_mut() = vec![(PathBuf::from("/data/good.toml"), Ok(text))];
    press(&mut bench, Key::O);
    type_into(&mut bench, "File path", "/data/good.toml");
    bench.wait(200);
    assert!((moved - crate::boundary_mm(&bench) - 1.0).abs() < 1e-6);
    press(&mut bench, Key::O);
    type_into(&mut bench, "File path", "/data/none.toml");
    bench.wait(200);
    let notice = bench.window.state().notice().cloned().unwrap();
    assert!(notice.is_error && notice.text.contains("none.toml was not opened"), "{notice:?}");
}

#[test]
fn a_question_that_is_given_up_does_nothing() {
    let mut bench = bare();
    press(&mut bench, Key::S);
    bench.window.get_by_label("Cancel").click();
    bench.wait(200);
    assert!(!is_asked(&bench) && bench.drawer.saved.borrow().is_empty());
    assert!(bench.window.state().notice().is_none());
}
