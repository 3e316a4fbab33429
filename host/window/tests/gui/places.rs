//! Nothing moves under the hand: on every page and dialog, a press on a control leaves all others at their places.

use crate::calibrate::{answers, open_calibration};
use crate::fixed_link::driving;
use crate::test_app::TestApp;
use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::bench::Bench;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// High enough that every page is seen without scrolling, in points.
const SIZE: [f32; 2] = [1280.0, 1500.0];
/// Width of the panel with its margins, and where the top bar ends.
const PANEL: f32 = 348.0;
const BAR: f32 = 54.0;

const ROLES: [Role; 9] = [
    Role::Button,
    Role::CheckBox,
    Role::ComboBox,
    Role::Link,
    Role::MenuItem,
    Role::RadioButton,
    Role::Slider,
    Role::SpinButton,
    Role::TextInput,
];

/// A control as a person knows it: its role and its name.
type Name = (String, String);
/// Where each control is; several may have one name.
type Places = BTreeMap<Name, Vec<Rect>>;

fn places(app: &TestApp) -> Places {
    let mut found = Places::new();
    for node in app.window.query_all_by(|node| ROLES.contains(&node.role())) {
        let access = node.accesskit_node();
        let name = access.label().or_else(|| {
            access.labelled_by().next().and_then(|label| label.label().or_else(|| label.value()))
        });
        let name = (format!("{:?}", access.role()), name.unwrap_or_default());
        // A message has its own line and disappears by itself.
        if name.1 != "Dismiss" {
            found.entry(name).or_default().push(node.rect());
        }
    }
    found
}

/// Which controls may move when one is pressed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum May {
    /// The controls of the panel's page without its tabs.
    Page,
    /// The controls of the wizard's page without the buttons under it.
    Step,
    /// The controls under the pressed one, in the same column.
    Below,
    /// All that is not in the top bar.
    Room,
}

/// The presses that may move something: the beginnings of their names, what may move, and why.
const EXCEPTIONS: [(&[&str], May, &str); 11] = [
    // Stands before "More", because its name begins with that word, too.
    (&["More: Measured response"], May::Room, "it lies behind a page, which a press beside it closes"),
    (
        &["Boundary", "Tones", "Texture", "Plate", "Device", "Play"],
        May::Page,
        "another page comes into the panel",
    ),
    (&["This plate", "Validity", "Designer", "Measure"], May::Page, "another page of the plate comes"),
    (&["Next", "Back", "Cancel"], May::Step, "another page of the calibration comes"),
    (
        &["More", "Feeling, illustrative", "Test the drive first", "Its widths and length"],
        May::Below,
        "what it folds out comes under it",
    ),
    (&["Hold the level"], May::Below, "the state of the hold comes under it"),
    (&["Remove "], May::Page, "a row leaves its list, which closes up"),
    (&["Solid", "Profile", "Stripes", "Beat"], May::Page, "another kind of texture has other fields"),
    (&["Panel", "Plots", "Open the log"], May::Room, "the stage takes the room"),
    (
        &["Disconnect", "New", "Plate: ", "Use this plate"],
        May::Page,
        "another plate or none has other fields",
    ),
    (
        &["Two tones", "A beat that is felt"],
        May::Page,
        "another scene has more tones, whose names take a line",
    ),
];

/// Whether a control stands on the plate: its place says a place of the plate, and changes with that only.
fn is_on_the_plate((role, name): &Name) -> bool {
    let is_handle = ["Boundary", "Finger", "Peak of tone", "Breakpoint", "Felt edge", "Place of the beat"];
    (role == "Slider" && is_handle.iter().any(|handle| name.starts_with(handle)))
        || [", note, ", ", amber, ", ", red, "].iter().any(|colour| name.contains(colour))
}

/// What has moved, if anything, that the press of `pressed` may not move.
fn moved(before: &Places, after: &Places, (pressed, at): (&Name, Rect), width: f32) -> Option<String> {
    let begins = |names: &[&str]| names.iter().any(|name| pressed.1.starts_with(name));
    let may = EXCEPTIONS.iter().find(|(names, ..)| begins(names)).map(|(_, may, _)| *may);
    let may = if [", note, ", ", amber, ", ", red, "].iter().any(|colour| pressed.1.contains(colour)) {
        // It opens its row on the page of lights.
        Some(May::Page)
    } else {
        may
    };
    let must_stay = |name: &Name, place: &Rect| match may {
        None => true,
        Some(May::Page) => place.left() < width - PANEL || place.bottom() < BAR + 50.0,
        Some(May::Step) => ["Cancel", "Back", "Next", "STOP"].contains(&&*name.1),
        Some(May::Below) => place.bottom() <= at.top() + 1.0 || place.left() < at.left() - 60.0,
        Some(May::Room) => place.bottom() < BAR,
    };
    let is_near = |a: &Rect, b: &Rect| {
        let off = [a.left() - b.left(), a.top() - b.top(), a.right() - b.right(), a.bottom() - b.bottom()];
        off.iter().all(|off| off.abs() < 1.0)
    };
    for (name, places) in before {
        // If another number of controls has the name afterwards, they cannot be distinguished.
        let Some(now) = after.get(name).filter(|now| now.len() == places.len()) else { continue };
        for (place, now) in places.iter().zip(now) {
            if !is_on_the_plate(name) && must_stay(name, place) && !is_near(place, now) {
                return Some(format!("{name:?} from {place} to {now}"));
            }
        }
    }
    None
}

/// Presses a place with the pointer, in one frame, and shows what follows in the next one.
fn press_at(app: &mut TestApp, at: Pos2) {
    let button = |pressed| {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos: at, button, pressed, modifiers }
    };
    app.window.input_mut().events.extend([Event::PointerMoved(at), button(true), button(false)]);
    app.wait(100);
}

fn press(app: &mut TestApp, name: &str) {
    let at = app.window.get_by_role_and_label(Role::Button, name).rect().center();
    press_at(app, at);
}

/// A page or dialog, and how to open it where it is not open.
type Page = (&'static str, fn(&mut TestApp));

fn tab(app: &mut TestApp, key: Key) {
    let modifiers = Modifiers::COMMAND;
    let key = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
    let events = [Event::ModifiersChanged(modifiers), key, Event::ModifiersChanged(Modifiers::NONE)];
    app.window.input_mut().events.extend(events);
    app.wait(100);
}

fn plate_page(app: &mut TestApp, name: &str) {
    tab(app, Key::Num4);
    press(app, name);
}

fn texture(app: &mut TestApp, kind: &str) {
    tab(app, Key::Num3);
    press(app, kind);
}

fn open_menu(app: &mut TestApp, name: &str, entry: &str) {
    if !app.shows(entry) {
        press(app, name);
    }
}

fn dialog(app: &mut TestApp, (menu, entry): (&str, &str), title: &str) {
    if !app.has(title) {
        open_menu(app, menu, entry);
        let at = app.window.get_by_label_contains(entry).rect().center();
        press_at(app, at);
    }
}

/// The calibration with both answers, at this page.
fn calibration(app: &mut TestApp, number: usize) {
    if crate::calibrate::page(app).is_none() {
        open_calibration(app);
    }
    for (step, name) in [(3, "near.csv"), (4, "far.csv")] {
        while crate::calibrate::page(app).is_some_and(|page| page < step.min(number)) {
            press(app, "Next");
        }
        if crate::calibrate::page(app) == Some(step) && !app.shows(name) {
            let answer = &answers(1.02)[step - 3];
            *app.files.contents.borrow_mut() = vec![(PathBuf::from(name), Ok(answer.to_csv()))];
            press(app, "Open file…");
        }
    }
    while crate::calibrate::page(app).is_some_and(|page| page < number) {
        press(app, "Next");
    }
    while crate::calibrate::page(app).is_some_and(|page| page > number) {
        press(app, "Back");
    }
}

const PAGES: [Page; 13] = [
    ("Boundary", |app| tab(app, Key::Num1)),
    ("Tones", |app| {
        tab(app, Key::Num2);
        if !app.shows("Remove tone 2") {
            press(app, "Add tone");
        }
    }),
    ("Texture, solid", |app| texture(app, "Solid")),
    ("Texture, profile", |app| texture(app, "Profile")),
    ("Texture, stripes", |app| texture(app, "Stripes")),
    ("Texture, beat", |app| texture(app, "Beat")),
    ("This plate", |app| plate_page(app, "This plate")),
    ("Validity", |app| plate_page(app, "Validity")),
    ("Designer", |app| {
        plate_page(app, "Designer");
        if !app.shows("Rim") {
            let more = app.window.get_by_label("More").rect().center();
            press_at(app, more);
            app.wait(500);
        }
    }),
    ("Measure", |app| plate_page(app, "Measure")),
    ("Device", |app| {
        if !app.shows("Reconnect by itself") {
            tab(app, Key::Num5);
        }
    }),
    ("Play", |app| tab(app, Key::Num6)),
    ("Edit", |app| open_menu(app, "Edit", "Switch to")),
];

const DIALOGS: [Page; 12] = [
    ("File", |app| open_menu(app, "File", "Scenes…")),
    ("View", |app| open_menu(app, "View", "As the system")),
    ("Help", |app| open_menu(app, "Help", "Ports and permissions")),
    ("Scenes", |app| dialog(app, ("File", "Scenes…"), "Scenes")),
    ("Shortcuts", |app| dialog(app, ("Help", "F1"), "Shortcuts")),
    ("Ports", |app| dialog(app, ("Help", "Ports and permissions"), "Copy the rules")),
    ("About", |app| dialog(app, ("Help", "About Slipline"), "Close")),
    ("Diagnostics", |app| dialog(app, ("File", "Copy diagnostics"), "Copy again")),
    ("Path", |app| {
        app.files.has_no_dialogs.set(true);
        if !app.shows("File path") {
            dialog(app, ("File", "Save setup…"), "File path");
        }
    }),
    ("Calibration 1", |app| calibration(app, 1)),
    ("Calibration 4", |app| calibration(app, 4)),
    ("Calibration 5", |app| calibration(app, 5)),
];

/// An app with sound, without the row of plots, which is the same on every page.
fn fresh() -> TestApp {
    let bench = Bench::default();
    let mut app = TestApp::unseen(bench.inputs(), bench);
    app.window.set_size(vec2(SIZE[0], SIZE[1]));
    let text = app.setup_text();
    *app.files.contents.borrow_mut() = vec![(PathBuf::from("setup.toml"), Ok(text))];
    *app.files.profiles.borrow_mut() = vec![(PathBuf::from("a.csv"), Ok(b"0.01,1\n0.28,0.1\n".to_vec()))];
    app.wait(100);
    open_menu(&mut app, "View", "Plots, meters and log");
    let at = app.window.get_by_label("Plots, meters and log").rect().center();
    press_at(&mut app, at);
    app
}

/// Whatever a press may leave behind: where the controls are, the setup, the settings, and whether it is driven.
type State = (Places, String, String, bool);

fn state(app: &TestApp) -> State {
    (places(app), app.setup_text(), app.window.state().settings().write(), app.is_driving())
}

/// The window without the page: its controls, and the right edge of where the page has some.
struct Shell {
    places: Places,
    right: f32,
}

/// Presses all of the page's own controls, each from the state in which the page is opened; returns what has moved.
fn press_all((page, open): Page, shell: &Shell) -> Vec<String> {
    let opened = || {
        let mut app = fresh();
        open(&mut app);
        app.wait(100);
        app
    };
    let mut app = opened();
    let first = state(&app);
    let is_own =
        |(name, at): &(&Name, &Vec<Rect>)| shell.places.get(*name) != Some(*at) && !is_on_the_plate(name);
    let own: Vec<(&Name, &Vec<Rect>)> = first.0.iter().filter(is_own).collect();
    assert!(!own.is_empty(), "{page}");
    let mut wrong = Vec::new();
    for (name, rects) in own {
        for at in rects.iter().filter(|at| at.left() < shell.right) {
            press_at(&mut app, at.center());
            if let Some(what) = moved(&first.0, &places(&app), (name, *at), SIZE[0]) {
                wrong.push(format!("{page}: a press of {name:?} moves {what}"));
            }
            // A switch is pressed back; after whatever else has changed the page is opened again.
            if state(&app) != first && places(&app).get(name).is_some_and(|places| places.contains(at)) {
                press_at(&mut app, at.center());
            }
            if state(&app) != first {
                app = opened();
            }
            assert_eq!(places(&app), first.0, "{page} opens otherwise after {name:?}");
        }
    }
    wrong
}

/// What is on every page: the bars and the stage.
fn on_every_page(app: &mut TestApp) -> Places {
    tab(app, Key::Num5);
    let there = places(app);
    tab(app, Key::Num1);
    let here = places(app);
    there.into_iter().filter(|(name, places)| here.get(name) == Some(places)).collect()
}

/// Presses everything on these pages that is not already in the shell.
fn check(pages: &[Page], shell: &Shell) {
    let wrong: Vec<String> = pages.iter().flat_map(|&page| press_all(page, shell)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
#[ignore = "half a minute of one core: .ci/run long_tests"]
fn a_press_on_a_page_moves_no_other_control() {
    check(&PAGES, &Shell { places: on_every_page(&mut fresh()), right: SIZE[0] });
}

#[test]
#[ignore = "half a minute of one core: .ci/run long_tests"]
fn a_press_in_a_dialog_or_menu_moves_no_other_control() {
    let mut app = fresh();
    tab(&mut app, Key::Num1);
    // Beside it is the panel's page, behind it.
    check(&DIALOGS, &Shell { places: places(&app), right: SIZE[0] - PANEL });
}

#[test]
fn a_press_in_the_bars_or_on_the_stage_moves_no_other_control() {
    for size in [[1280.0, 800.0], [640.0, 480.0]] {
        let mut app = TestApp::driving();
        app.resize(size.into(), 200);
        let shell = on_every_page(&mut app);
        let mut wrong = Vec::new();
        for (name, rects) in &shell {
            for (number, _) in rects.iter().enumerate() {
                let before = places(&app);
                let Some(&at) = before.get(name).and_then(|places| places.get(number)) else { continue };
                press_at(&mut app, at.center());
                // Time for the device to follow.
                app.wait(300);
                if let Some(what) = moved(&before, &places(&app), (name, at), size[0]) {
                    wrong.push(format!("{size:?}: a press of {name:?} moves {what}"));
                }
                // Another press of a menu or a switch closes it; whatever was stopped goes on.
                let is_switch = places(&app) != before && name.1 != "STOP";
                if is_switch && places(&app).contains_key(name) {
                    press_at(&mut app, at.center());
                }
                if app.window.query_by_role_and_label(Role::Button, "Drive").is_some() {
                    press(&mut app, "Drive");
                }
                tab(&mut app, Key::Num1);
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}

/// The words that were pressed and what is at their place afterwards, for a device with a real plate.
#[test]
fn a_second_press_at_the_place_of_drive_does_not_disarm() {
    let driving = driving();
    let shown = |state| {
        let (window, _) =
            crate::states::show(crate::states::in_state(&driving, state, false), [1280.0, 800.0]);
        let found = window.query_all_by_role(Role::Button);
        let found: Vec<(String, Rect)> = found
            .filter_map(|node| Some((node.accesskit_node().label()?, node.rect())))
            .filter(|(name, rect)| rect.bottom() < BAR && ["Drive", "Disarm"].contains(&&**name))
            .collect();
        found
    };
    use slipline_link::protocol::event::State;
    let armed = shown(State::Armed);
    for state in [State::Driving, State::Waiting, State::Stopping] {
        for (name, rect) in shown(state) {
            let before = armed.iter().find(|(other, _)| *other == name).map(|(_, rect)| *rect);
            assert_eq!(before, Some(rect), "{state:?}: {name}");
        }
    }
}
