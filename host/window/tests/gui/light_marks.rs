//! The lights that are not green, on the stage.

use crate::plots::words;
use crate::small_screens::{SIZES, screen, small};
use crate::test_app::TestApp;
use crate::{boundary_mm, line_rect};
use eframe::egui::{Key, Modifiers, Rect, Shape, accesskit::Role, vec2};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_instrument::concern::Concern;
use slipline_plate::check::{Checker, Conditions};
use slipline_window::settings::ThemeChoice;

/// Opens a setup of one tone on a preset.
pub(crate) fn open(app: &mut TestApp, preset: &str, boundary_m: f64) {
    let mut setup = app.window.state().setup().clone();
    setup.plate = slipline_plate::preset(preset).unwrap().into();
    setup.tones[0].position_m = boundary_m;
    app.open("setup.toml", Ok(slipline_model::setup::file::write(&setup)));
    app.click("Dismiss", 1500);
}

/// The symbols: their names and where they can be pressed.
fn symbols(app: &TestApp) -> Vec<(String, Rect)> {
    let named = |node: Node<'_>| Some((node.accesskit_node().label()?, node.rect()));
    let buttons = app.window.query_all_by_role(Role::Button).filter_map(named);
    let colours = ["unchecked", "green", "note", "amber", "red"].map(|colour| format!(", {colour}, "));
    buttons.filter(|(name, _)| colours.iter().any(|colour| name.contains(colour))).collect()
}

pub(crate) fn symbol<'a>(app: &'a TestApp, light: &str) -> Node<'a> {
    let begins = format!("{light}, ");
    app.window.get_by(move |node| {
        node.role() == Role::Button && node.label().is_some_and(|label| label.starts_with(&begins))
    })
}

/// Corners of the filled shape that is drawn at the middle of `rect`: 3 of a triangle, 4 of a square; `None` if there is none.
fn corners(app: &TestApp, rect: Rect) -> Option<usize> {
    let is_there = |bounds: Rect| bounds.width() < 13.0 && bounds.center().distance(rect.center()) < 1.5;
    app.window.output().shapes.iter().find_map(|clipped| match &clipped.shape {
        Shape::Path(path) if path.closed && path.points.len() == 3 => {
            is_there(Rect::from_points(&path.points)).then_some(3)
        }
        Shape::Rect(square) if square.rect.height() > 5.0 && is_there(square.rect) => Some(4),
        _ => None,
    })
}

#[test]
fn every_light_that_is_not_green_stands_on_the_stage_with_its_place_and_its_own_shape() {
    let mut app = TestApp::driving();
    for (preset, boundary_m, wanted) in
        [("membrane", 0.18, ["Edge width", "Finger load"]), ("al-sh", 0.16, ["Edge curvature", "Edge slope"])]
    {
        open(&mut app, preset, boundary_m);
        let plate = slipline_plate::preset(preset).unwrap();
        let report = Checker::new(&plate, Conditions::default()).unwrap().at(boundary_m).unwrap();
        let symbols = symbols(&app);
        let failing: Vec<_> = report.lights.iter().filter(|light| !light.stretches.is_empty()).collect();
        assert_eq!(symbols.len(), failing.len(), "{preset}: {symbols:?}");
        for light in wanted {
            assert!(symbols.iter().any(|(name, _)| name.starts_with(light)), "{preset} {light}: {symbols:?}");
        }
        for (name, rect) in &symbols {
            let light = failing.iter().find(|light| name.to_lowercase().starts_with(light.name)).unwrap();
            // A note is a short bar.
            let sides = match Concern::of(light, false) {
                Concern::Red => Some(4),
                Concern::Amber => Some(3),
                Concern::Note | Concern::Green | Concern::Unchecked => None,
            };
            assert_eq!(corners(&app, *rect), sides, "{preset}: {name} {rect}");
        }
    }
    assert!(app.has("Edge slope, note, at 160.0 mm"), "{:?}", symbols(&app));
    open(&mut app, "al-bending-displacement", 0.15);
    assert!(app.has("Drive match, red, at the driven end"), "{:?}", symbols(&app));
}

#[test]
fn the_first_picture_has_no_symbol() {
    for size in [[1280.0, 800.0], [640.0, 480.0]] {
        let builder = egui_kittest::HarnessBuilder::default().with_size(size);
        let app = TestApp::first_start(ThemeChoice::Light, builder);
        assert!(app.has("Validity: all green"));
        assert!(symbols(&app).is_empty(), "{:?}", symbols(&app));
    }
}

#[test]
fn the_symbols_lie_over_neither_line_flag_strip_nor_each_other_at_any_size_and_place() {
    for (size, density) in [(SIZES[0], 1.0), ([640.0, 400.0], 2.0), ([1280.0, 800.0], 1.0)] {
        let mut app = small(size);
        app.window.set_pixels_per_point(density);
        for (preset, first_m) in [("membrane", 0.1), ("al-sh", 0.16)] {
            open(&mut app, preset, first_m);
            for _ in 0..3 {
                let mm = boundary_mm(&app);
                crate::type_into(&mut app, "Boundary position", &format!("{:.1} mm", mm + 55.0));
                app.wait(100);
                let symbols = symbols(&app);
                assert!(symbols.len() >= 2, "{size:?} {preset} {mm}: {symbols:?}");
                let line = line_rect(&app);
                for (i, (name, rect)) in symbols.iter().enumerate() {
                    let what = format!("{size:?} {preset} {mm}: {name} {rect}, {line}");
                    assert!(screen(size).contains_rect(*rect), "{what}");
                    assert!(!rect.shrink(0.1).intersects(line), "{what}");
                    // The row of the flag is the uppermost 26 points of the line's column, the strip its lowest 30.
                    assert!(rect.top() > line.top() + 26.0 && rect.bottom() < line.bottom() - 30.0, "{what}");
                    assert!(rect.width() >= 11.0 && rect.height() >= 24.0, "{what}");
                    for (other, at) in &symbols[i + 1..] {
                        assert!(!rect.shrink(0.1).intersects(*at), "{what}: {other} {at}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_symbol_says_its_number_its_limit_and_what_to_do() {
    let mut app = TestApp::driving();
    let place = symbol(&app, "Sensitivity").rect().center();
    app.hover(place, 2500);
    let said: Vec<String> = words(app.window.output()).into_iter().map(|(words, _)| words).collect();
    let said = said.iter().find(|words| words.starts_with("Sensitivity: note, at ")).unwrap();
    for part in [" dB; green up to 1 dB, amber up to 6.02 dB", "on your own plate", "Press for all lights."] {
        assert!(said.contains(part), "{said}");
    }
    // The read-out of the place does not lie over it.
    assert!(!words(app.window.output()).iter().any(|(words, _)| words.contains("dB over felt")));
}

#[test]
fn pressing_a_symbol_opens_its_row_also_where_the_plots_are_in_front() {
    for size in [[1280.0, 800.0], [640.0, 480.0]] {
        let mut app = small(size);
        if size[0] < 700.0 {
            app.click("Plots", 200);
            assert!(!app.has("Tones"));
        }
        symbol(&app, "Sensitivity").click();
        app.wait(1500);
        let row = app.window.get_by_label("sensitivity: note").rect();
        // Above the row of buttons below the panel.
        assert!(row.top() > 60.0 && row.bottom() < size[1] - 40.0, "{size:?}: {row}");
        let sentence = app.window.get_by_label_contains("calibrate on your own plate").rect();
        assert!(screen(size).contains_rect(sentence), "{size:?}: {sentence}");
        let is_lit = app.window.output().shapes.iter().any(|clipped| match &clipped.shape {
            Shape::Rect(lit) => {
                lit.rect.contains_rect(sentence) && lit.rect.height() < sentence.height() + 60.0
            }
            _ => false,
        });
        assert!(is_lit, "{size:?}");
    }
}

#[test]
fn the_keys_reach_a_symbol_and_open_its_row() {
    let mut app = TestApp::driving();
    symbol(&app, "Edge width").focus();
    app.wait(50);
    app.keys(Modifiers::NONE, Key::Enter, 300);
    assert!(app.has("edge width: note"));
}

#[test]
fn the_symbols_stand_still_while_the_line_is_dragged_and_follow_when_it_is_let_go() {
    let mut app = TestApp::driving();
    let before = symbols(&app);
    let line = line_rect(&app).center();
    app.grab(line, 0);
    for step in 1..=24 {
        app.hover(line + vec2(-5.0 * step as f32, 0.0), 50);
        for ((name, rect), (name_before, at)) in symbols(&app).iter().zip(&before) {
            assert!(name == name_before && (rect.min - at.min).length() < 0.01, "{step}: {name} {rect} {at}");
        }
    }
    app.release(line + vec2(-120.0, 0.0), 200);
    let after = symbols(&app);
    let edge = |of: &[(String, Rect)]| of.iter().find(|(name, _)| name.starts_with("Edge width")).unwrap().1;
    assert!(edge(&after).left() < edge(&before).left() - 40.0, "{before:?} {after:?}");
    assert_eq!(edge(&after).center().y, edge(&before).center().y);
}
