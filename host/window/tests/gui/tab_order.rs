//! The Tab key walks through every control of the window, each once.

use crate::bench::Bench;
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

/// A control as a person would tell it: what it is, its name, and where it is.
type Control = (String, String, [i32; 2]);

/// The controls that can be used, and how often each has the focus now (0 or 1).
fn controls(bench: &Bench) -> BTreeMap<Control, usize> {
    let mut found = BTreeMap::new();
    for role in CONTROLS {
        for node in bench.window.query_all_by_role(role) {
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
fn here(bench: &Bench) -> Rect {
    bench.window.get_by(|node| node.is_focused()).rect()
}

fn walk(bench: &mut Bench, page: &str) {
    // A click on nothing takes the focus away.
    bench.window.ctx.memory_mut(|memory| {
        if let Some(id) = memory.focused() {
            memory.surrender_focus(id);
        }
    });
    bench.window.step();
    let all: Vec<Control> = controls(bench).into_keys().collect();
    let mut visited: BTreeMap<Control, usize> = BTreeMap::new();
    let mut first = None;
    let mut before: Option<(String, String, Rect)> = None;
    for _ in 0..2 * all.len() {
        bench.window.key_press(Key::Tab);
        bench.window.step();
        bench.window.step();
        let Some((focused, _)) = controls(bench).into_iter().find(|(_, has)| *has == 1) else { continue };
        // In a row the Tab key goes as one reads.
        if let Some((_, last, at)) = &before
            && (at.center().y - here(bench).center().y).abs() < 4.0
        {
            assert!(at.left() < here(bench).left(), "{page}: {} comes after {last}", focused.1);
        }
        before = Some((focused.0.clone(), focused.1.clone(), here(bench)));
        // Scrolling moves what is in the panel at the side: its height does not count.
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
    assert!(missed.is_empty(), "{page}: never reached {missed:?}");
    assert!(visited.len() >= 15, "{page}: {}", visited.len());
}

#[test]
fn tab_reaches_every_control_once() {
    let mut bench = Bench::driving();
    for tab in ["Boundary", "Tones", "Plate", "Device"] {
        bench.window.get_by_role_and_label(Role::Button, tab).click();
        bench.wait(100);
        walk(&mut bench, tab);
    }
    for page in ["Validity", "Designer"] {
        bench.window.get_by_role_and_label(Role::Button, "Plate").click();
        bench.wait(100);
        bench.window.get_by_role_and_label(Role::Button, page).click();
        bench.wait(100);
        walk(&mut bench, page);
    }
    bench.window.get_by_label("More").click();
    bench.wait(300);
    walk(&mut bench, "More");
}
