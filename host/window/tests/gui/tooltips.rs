//! Every control and every view says in a sentence what it is for.

use crate::background::open_page;
use crate::test_app::{TestApp, click, opened};
use crate::{add_tone, real_device};
use eframe::egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_link::protocol::event::State;
use slipline_window::app::App;
use std::collections::BTreeMap;

/// The roles of all controls and displays: each needs a description.
const DESCRIBED: [Role; 11] = [
    Role::Button,
    Role::Slider,
    Role::SpinButton,
    Role::TextInput,
    Role::ComboBox,
    Role::CheckBox,
    Role::RadioButton,
    Role::Link,
    Role::ProgressIndicator,
    Role::Image,
    Role::MenuItem,
];
/// Beginnings of the names of labels that stand for a part of the picture.
const PARTS: [&str; 9] = [
    "State: ",
    "Drag the line",
    "felt",
    "Flag: ",
    "Edge: ",
    "Clipped samples",
    "Underruns",
    "Retries",
    "CRC errors",
];
/// The fewest letters of a sentence.
const LEAST: usize = 15;

/// The description of each name; `None` without one. A tooltip is also the description for a screen reader.
type Descriptions = BTreeMap<String, Option<String>>;

fn look(window: &Harness<'_, App>, descriptions: &mut Descriptions) {
    let parts = |node: &egui_kittest::Node<'_>| {
        let said =
            node.accesskit_node().label().or_else(|| node.accesskit_node().value()).unwrap_or_default();
        DESCRIBED.contains(&node.accesskit_node().role())
            || (node.accesskit_node().role() == Role::Label
                && PARTS.iter().any(|part| said.starts_with(part))
                // A light, whose sentence stands below it.
                && !said.starts_with("felt edge: "))
    };
    for node in window.root().children_recursive().filter(parts) {
        let access = node.accesskit_node();
        let named = access.labelled_by().next().and_then(|by| by.label().or_else(|| by.value()));
        let name = access.label().or(named).or_else(|| access.value()).unwrap_or_default();
        descriptions.insert(format!("{:?} {name}", node.accesskit_node().role()), access.description());
    }
}

/// What is missing: nothing, too little, or the name once more.
fn lacks((name, said): (&String, &Option<String>)) -> Option<String> {
    let word = name.split_once(' ').map_or("", |(_, word)| word).to_lowercase();
    let Some(said) = said else { return Some(format!("{name}: nothing")) };
    let rest = said.to_lowercase().replace(&word, "");
    (said.len() < LEAST || rest.trim().len() < LEAST).then(|| format!("{name}: {said}"))
}

/// Presses the first control whose name begins like this.
fn press(app: &mut TestApp, name: &str) {
    let is_named = |node: &egui_kittest::Node<'_>| {
        let access = node.accesskit_node();
        // The line of the boundary has the name of its page.
        let is_control = DESCRIBED.contains(&access.role()) && access.role() != Role::Slider;
        is_control && access.label().is_some_and(|label| label.starts_with(name))
    };
    app.window.root().children_recursive().find(is_named).unwrap_or_else(|| panic!("no {name}")).click();
    app.wait(200);
}

#[test]
fn every_control_and_view_says_what_it_is_for() {
    let mut descriptions = Descriptions::new();
    let mut app = TestApp::driving();
    look(&app.window, &mut descriptions);
    crate::finger::choose(&mut app, "Light");
    add_tone(&mut app);
    for page in ["Boundary", "Tones", "Texture", "Plate", "Device", "Play"] {
        app.click_button(page, 150);
        look(&app.window, &mut descriptions);
    }
    for kind in ["Solid", "Profile", "Stripes", "Beat"] {
        crate::textures::open_textures(&mut app);
        crate::textures::choose(&mut app, kind);
        look(&app.window, &mut descriptions);
    }
    for page in ["This plate", "Validity", "Designer"] {
        open_page(&mut app, page);
        look(&app.window, &mut descriptions);
    }
    open_page(&mut app, "This plate");
    press(&mut app, "Plate: ");
    look(&app.window, &mut descriptions);
    press(&mut app, "Plate: ");
    crate::measure::open_measure(&mut app);
    let answers = [0.032, 0.176].map(|x| crate::measure::measured(&crate::measure::membrane(1.002), x, 20.0));
    crate::measure::open(&mut app, "near.csv", &answers[0]);
    look(&app.window, &mut descriptions);
    press(&mut app, "More: Measured response");
    look(&app.window, &mut descriptions);
    press(&mut app, "More: Measured response");
    crate::calibrate::open_calibration(&mut app);
    look(&app.window, &mut descriptions);
    press(&mut app, "Next");
    look(&app.window, &mut descriptions);
    press(&mut app, "Next");
    look(&app.window, &mut descriptions);
    press(&mut app, "Cancel");
    crate::calibrate::go_through(&mut app, &answers);
    look(&app.window, &mut descriptions);
    press(&mut app, "Cancel");
    press(&mut app, "Boundary");
    crate::finger::choose(&mut app, "None");
    let part = |name| ["Spectrum", "Finger trace", "Open the log"].contains(&name);
    for menu in [
        "File",
        "Edit",
        "View",
        "Help",
        "Device: ",
        "More: Drive waveform",
        "Finger trace",
        "Spectrum",
        "More: Spectrum",
        "Open the log",
        "Log level",
    ] {
        press(&mut app, menu);
        look(&app.window, &mut descriptions);
        if !part(menu) {
            press(&mut app, menu);
        }
    }
    press(&mut app, "Close the log");
    for page in ["Scenes…", "Shortcuts", "Ports and permissions", "About Slipline", "Copy diagnostics"] {
        press(&mut app, if ["Scenes…", "Copy diagnostics"].contains(&page) { "File" } else { "Help" });
        press(&mut app, page);
        look(&app.window, &mut descriptions);
        press(&mut app, "Close");
    }
    look(&crate::holding::sensed().0.window, &mut descriptions);
    app.open("bad.toml", Ok("nonsense".to_owned()));
    look(&app.window, &mut descriptions);
    app.resize([640.0, 480.0].into(), 200);
    look(&app.window, &mut descriptions);
    app.plug(false);
    app.wait(3000);
    look(&app.window, &mut descriptions);
    for state in [State::Idle, State::Armed, State::Fault] {
        let mut window = opened(real_device(state), [1280.0, 800.0]);
        look(&window, &mut descriptions);
        window.get_by_role_and_label(Role::Button, "Device").click();
        window.run_steps(5);
        look(&window, &mut descriptions);
        if state == State::Idle {
            click(&mut window, "Arm…");
            look(&window, &mut descriptions);
        }
    }
    assert!(descriptions.len() > 150, "{} were seen", descriptions.len());
    let lacking: Vec<String> = descriptions.iter().filter_map(lacks).collect();
    assert!(lacking.is_empty(), "{} of {}:\n{}", lacking.len(), descriptions.len(), lacking.join("\n"));
}

#[test]
fn the_strip_and_the_line_explain_themselves_at_the_pointer() {
    for (name, wanted) in [("felt to", "fingers differ"), ("Boundary", "press the arrow keys")] {
        let mut app = TestApp::driving();
        let named = |node: &egui_kittest::Node<'_>| {
            let access = node.accesskit_node();
            let is_one = matches!(access.role(), Role::Label | Role::Slider);
            is_one && access.label().or_else(|| access.value()).is_some_and(|label| label.starts_with(name))
        };
        let mut at = app.window.root().children_recursive().find(named).unwrap().rect().center();
        if name == "Boundary" {
            // At the knob.
            at.y = app.window.get_by_label("Plate from above").rect().center().y;
        } else {
            // Beside the line, where the strip is alone.
            at.x += 100.0;
        }
        app.hover(at, 2500);
        let words = crate::plots::words(app.window.output());
        assert!(words.iter().any(|(words, _)| words.contains(wanted)), "{name}");
    }
}

/// Painted explanations and read-outs at the pointer: their first words.
fn at_pointer(app: &TestApp) -> Vec<String> {
    let beginnings = [
        "Drag it along the plate",
        "What a finger feels along",
        "From the peak to a tenth",
        "Where the line is, the",
    ];
    let words = crate::plots::words(app.window.output()).into_iter().map(|(words, _)| words);
    let is_one = |words: &String| {
        beginnings.iter().any(|beginning| words.starts_with(beginning))
            || (words.contains(" mm   ") && (words.ends_with("over felt") || words.ends_with("below felt")))
    };
    words.filter(is_one).collect()
}

#[test]
fn the_line_explains_itself_at_its_knob_alone_and_not_after_a_press() {
    let mut app = TestApp::driving();
    let line = crate::line_rect(&app);
    let knob =
        eframe::egui::pos2(line.center().x, app.window.get_by_label("Plate from above").rect().center().y);
    let strip = app.window.query_all_by_label_contains("felt to").next().unwrap().rect();
    let edge = app.window.query_all_by_label_contains("Edge: ").next().unwrap().rect();
    for at in [
        knob,
        knob + eframe::egui::vec2(0.0, 40.0),
        eframe::egui::pos2(line.center().x, strip.center().y),
        strip.center() + eframe::egui::vec2(100.0, 0.0),
        edge.center(),
        eframe::egui::pos2(line.center().x, edge.center().y),
    ] {
        app.hover(at - eframe::egui::vec2(30.0, 3.0), 100);
        app.hover(at, 2500);
        let shown = at_pointer(&app);
        assert_eq!(shown.len(), 1, "{at}: {shown:?}");
        assert_eq!(shown[0].starts_with("Drag it"), at == knob, "{at}: {shown:?}");
    }
    app.hover(knob, 100);
    app.grab(knob, 100);
    app.release(knob, 100);
    app.hover(knob + eframe::egui::vec2(2.0, 1.0), 3000);
    assert!(!at_pointer(&app).iter().any(|words| words.starts_with("Drag it")), "after a press");
}
