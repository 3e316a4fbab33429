//! Typed paths, on a system without a file dialog.

use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::path::PathBuf;

fn bare() -> TestApp {
    let app = TestApp::driving();
    app.files.has_no_dialogs.set(true);
    app
}

fn press(app: &mut TestApp, key: Key) {
    app.keys(Modifiers::COMMAND, key, 200);
}

fn is_asked(app: &TestApp) -> bool {
    app.window.query_by_role_and_label(Role::TextInput, "File path").is_some()
}

#[test]
fn a_setup_is_saved_to_the_path_that_is_typed() {
    let mut app = bare();
    press(&mut app, Key::S);
    assert!(app.has_part("offers no dialog for files"));
    let field = app.window.get_by_role_and_label(Role::TextInput, "File path");
    assert!(field.accesskit_node().is_focused(), "it can be typed into at once");
    assert!(field.value().unwrap().ends_with("setup.toml"), "{:?}", field.value());
    assert!(app.files.saved.borrow().is_empty());
    type_into(&mut app, "File path", "/tmp/mine.toml");
    app.wait(200);
    assert!(!is_asked(&app));
    assert_eq!(app.files.saved.borrow().len(), 1);
    assert!(app.has("Saved /tmp/mine.toml"));
    assert!(app.is_driving());
}

#[test]
fn an_existing_file_is_replaced_only_by_the_button_that_says_so() {
    let mut app = bare();
    for _ in 0..2 {
        press(&mut app, Key::S);
        type_into(&mut app, "File path", "/tmp/mine.toml");
        app.wait(200);
    }
    assert_eq!(app.files.saved.borrow().len(), 1, "the second time it exists");
    assert!(app.has_part("A file of that name exists"));
    app.key(Key::Enter, 200);
    assert_eq!(app.files.saved.borrow().len(), 1, "Enter alone replaces nothing");
    app.click("Replace", 200);
    assert_eq!(app.files.saved.borrow().len(), 2);
    assert!(!is_asked(&app));
}

#[test]
fn a_file_is_opened_by_its_path_and_a_missing_one_is_reported() {
    let mut app = bare();
    let text = app.setup_text();
    crate::arrow_right(&mut app);
    let moved = crate::boundary_mm(&app);
    *app.files.contents.borrow_mut() = vec![(PathBuf::from("/data/good.toml"), Ok(text))];
    press(&mut app, Key::O);
    type_into(&mut app, "File path", "/data/good.toml");
    app.wait(200);
    assert!((moved - crate::boundary_mm(&app) - 1.0).abs() < 1e-6);
    press(&mut app, Key::O);
    type_into(&mut app, "File path", "/data/none.toml");
    app.wait(200);
    let notice = app.window.state().notice().cloned().unwrap();
    assert!(notice.is_error && notice.text.contains("none.toml was not opened"), "{notice:?}");
}

#[test]
fn a_question_that_is_given_up_does_nothing() {
    let mut app = bare();
    press(&mut app, Key::S);
    app.click("Cancel", 200);
    assert!(!is_asked(&app) && app.files.saved.borrow().is_empty());
    assert!(app.window.state().notice().is_none());
}
