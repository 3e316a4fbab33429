//! The Tab key reaches every control of the window exactly once.

use crate::test_app::TestApp;
use eframe::egui::{Key, Rect, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::collections::BTreeMap;

const CONTROLS: [Role; 7] = [
    Role::Button,
    Role::Slider,
    Role::SpinButton,
    Role::TextInput,
    Role::ComboBox,
    Role::CheckBox,
    Role::RadioButton,
];

/// A control as a person would describe it: its role, its name and its place.
type Control = (String, String, [i32; 2]);

/// The controls that can be used, and how often each has the focus now (0 or 1).
fn controls(app: &TestApp) -> BTreeMap<Control, usize> {
    let mut found = BTreeMap::new();
    for role in CONTROLS {
        for node in app.window.query_all_by_role(role) {
            let access = node.accesskit_node();
            if access.is_disabled() {
                continue;
            }
            let name = access.label().or_else(|| {
                access.labelled_by().next().and_then(|label| label.label().or_else(|| label.value()))
            });
            let place = node.rect().left_top();
            let control = (format!("{role:?}"), name.unwrap_or_default(), [place.x as i32, place.y as i32]);
            found.insert(control, usize::from(access.is_focused()));
        }
    }
    found
}

/// Where the control with the focus is.
fn here(app: &TestApp) -> Rect {
    app.window.get_by(|node| node.is_focused()).rect()
}

fn walk(app: &mut TestApp, page: &str) {
    // A click on nothing takes the focus away.
    app.window.ctx.memory_mut(|memory| {
        if let Some(id) = memory.focused() {
            memory.surrender_focus(id);
        }
    });
    app.window.step();
    let all: Vec<Control> = controls(app).into_keys().collect();
    let mut visited: BTreeMap<Control, usize> = BTreeMap::new();
    let mut first = None;
    let mut before: Option<(String, String, Rect)> = None;
    for _ in 0..2 * all.len() {
        app.key(Key::Tab, 0);
        app.window.step();
        let Some((focused, _)) = controls(app).into_iter().find(|(_, has)| *has == 1) else { continue };
        // Within a row the Tab key follows the reading order.
        if let Some((_, last, at)) = &before
            && (at.center().y - here(app).center().y).abs() < 4.0
        {
            assert!(at.left() < here(app).left(), "{page}: {} comes after {last}", focused.1);
        }
        before = Some((focused.0.clone(), focused.1.clone(), here(app)));
        // The side panel scrolls, so vertical places in it do not count.
        if first.as_ref() == Some(&focused) {
            break;
        }
        first.get_or_insert(focused.clone());
        *visited.entry(focused).or_default() += 1;
    }
    let name = |(role, name, _): &Control| format!("{role} {name}");
    let mut missed: Vec<String> = all.iter().map(name).collect();
    for (control, times) in &visited {
        assert_eq!(*times, 1, "{page}: {}", name(control));
        if let Some(place) = missed.iter().position(|missed| *missed == name(control)) {
            missed.remove(place);
        }
    }
    let others: Vec<_> = visited.keys().filter(|control| !all.contains(control)).collect();
    assert!(missed.is_empty(), "{page}: never reached {missed:?}, but {others:?}");
    assert!(visited.len() >= 15, "{page}: {}", visited.len());
}

#[test]
fn tab_reaches_every_control_once() {
    let mut app = TestApp::driving();
    for tab in ["Boundary", "Tones", "Texture", "Plate", "Device", "Play"] {
        app.click_button(tab, 100);
        walk(&mut app, tab);
    }
    for page in ["Validity", "Measure", "Designer"] {
        app.click_button("Plate", 100);
        app.click_button(page, 100);
        walk(&mut app, page);
    }
    app.click("More", 300);
    walk(&mut app, "More");
}

#[test]
fn the_first_press_of_tab_reaches_the_line() {
    let mut app = TestApp::driving();
    app.key(Key::Tab, 0);
    app.window.step();
    let focused = app.window.get_by(|node| node.is_focused());
    assert_eq!(focused.accesskit_node().label().as_deref(), Some("Boundary"));
    let before = crate::boundary_mm(&app);
    crate::arrow_right(&mut app);
    app.wait(100);
    assert!((crate::boundary_mm(&app) - before - 1.0).abs() < 1e-6);
}
