//! The actual plate on the stage: the simulated device's as rings, the measurements of a real one as marks.

use crate::fake_files::FakeFiles;
use crate::measure::{measured, membrane};
use crate::measuring::{on_a_secret_plate, wait_for_the_end};
use crate::test_app::open_window;
use eframe::egui::{FullOutput, Key, Modifiers, Pos2, Shape, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::State;
use slipline_window::settings::ThemeChoice;
use std::path::PathBuf;

fn shapes(output: &FullOutput) -> impl Iterator<Item = &Shape> {
    output.shapes.iter().map(|clipped| &clipped.shape)
}

/// The middles of these shapes, without that of the legend, which is drawn last.
fn middles(output: &FullOutput, of: impl Fn(&Shape) -> Option<Pos2>) -> Vec<Pos2> {
    let mut middles: Vec<Pos2> = shapes(output).filter_map(of).collect();
    middles.pop();
    middles
}

/// The envelope's rings.
fn rings(output: &FullOutput) -> Vec<Pos2> {
    middles(output, |shape| match shape {
        Shape::Circle(circle) if circle.radius == 2.8 => Some(circle.center),
        _ => None,
    })
}

/// The marks of measured places.
fn marks(output: &FullOutput) -> Vec<Pos2> {
    middles(output, |shape| match shape {
        Shape::Path(path) if path.closed && path.points.len() == 4 => {
            let around = shape.visual_bounding_rect();
            (around.width() < 16.0 && around.height() < 16.0).then(|| around.center())
        }
        _ => None,
    })
}

/// The predicted curve of a drive that sounds.
fn curve(output: &FullOutput) -> Vec<Pos2> {
    let curve = |shape: &Shape| match shape {
        Shape::Path(path) if !path.closed && path.points.len() > 40 && path.stroke.width == 1.8 => {
            Some(path.points.clone())
        }
        _ => None,
    };
    shapes(output).find_map(curve).unwrap()
}

/// How far a place on the envelope is from the curve, over the curve's height.
fn off(curve: &[Pos2], at: Pos2) -> f32 {
    let after = curve.partition_point(|point| point.x < at.x).clamp(1, curve.len() - 1);
    let (a, b) = (curve[after - 1], curve[after]);
    let y = a.y + (b.y - a.y) * (at.x - a.x) / (b.x - a.x);
    let (top, bottom) =
        curve.iter().fold((f32::INFINITY, 0.0_f32), |(top, bottom), at| (top.min(at.y), bottom.max(at.y)));
    (at.y - y).abs() / (bottom - top)
}

/// The largest distance of the rings from the curve, over the curve's height.
fn rings_off(output: &FullOutput) -> Option<f32> {
    let curve = curve(output);
    rings(output).into_iter().map(|ring| off(&curve, ring)).reduce(f32::max)
}

#[test]
fn a_secret_plate_has_rings_once_it_is_measured_and_they_miss_the_line() {
    let mut app = on_a_secret_plate();
    let stage = |app: &mut crate::test_app::TestApp| {
        app.click_button("Boundary", 1500);
    };
    stage(&mut app);
    assert!(app.is_driving() && rings(app.window.output()).is_empty(), "nobody knows it");
    let says = |app: &crate::test_app::TestApp, text: &str| {
        crate::plots::words(app.window.output()).iter().any(|(word, _)| word == text)
    };
    assert!(says(&app, "hidden test plate: not measured yet"));
    crate::measure::open_measure(&mut app);
    app.click_button("Measure now", 200);
    wait_for_the_end(&mut app);
    app.click("Drive", 500);
    stage(&mut app);
    assert!(says(&app, "hidden test plate, level fitted") && rings(app.window.output()).len() > 30);
    let secret = rings_off(app.window.output()).unwrap();
    assert!(secret > 0.05, "{secret}");
    // Its level is not known: its highest ring is as high as the curve.
    let top = |at: &[Pos2]| at.iter().map(|at| at.y).fold(f32::INFINITY, f32::min);
    let (rings, curve) = (top(&rings(app.window.output())), top(&curve(app.window.output())));
    assert!((rings - curve).abs() < 2.0, "{rings} {curve}");
    // Without a secret plate, the plate on the screen is the actual one.
    crate::measure::open_measure(&mut app);
    app.click("Hidden test plate (its numbers differ)", 200);
    stage(&mut app);
    let known = rings_off(app.window.output()).unwrap();
    assert!(says(&app, "simulated plate") && known < 0.02, "{known}");
    assert!(!app.shows("secret"));
}

#[test]
fn a_real_plate_is_on_the_stage_at_its_measured_places_only() {
    for (speed, is_on) in [(1.0, true), (1.04, false)] {
        let files = FakeFiles::default();
        let builder = egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]);
        let link = crate::real_device(State::Driving);
        let mut window = open_window(Box::new(link), &files, ThemeChoice::Light, builder);
        window.run_steps(5);
        assert!(rings(window.output()).is_empty(), "nothing is simulated");
        let places_m = [0.05, 0.12];
        for place_m in places_m {
            let text = measured(&membrane(speed), place_m, 12.0).to_csv();
            *files.contents.borrow_mut() = vec![(PathBuf::from(format!("{place_m}.csv")), Ok(text))];
            window.key_press_modifiers(Modifiers::COMMAND, Key::O);
            window.run_steps(5);
        }
        window.get_by_role_and_label(Role::Button, "Boundary").click();
        window.run_steps(5);
        let (found, curve) = (marks(window.output()), curve(window.output()));
        assert_eq!(found.len(), places_m.len(), "{found:?}");
        let screen = (curve[0].x, curve[curve.len() - 1].x);
        for (mark, place_m) in found.iter().zip(places_m) {
            let x = screen.0 + (screen.1 - screen.0) * (place_m / 0.32) as f32;
            assert!((mark.x - x).abs() < 1.0, "{mark} {x}");
        }
        let farthest = found.into_iter().map(|mark| off(&curve, mark)).fold(0.0, f32::max);
        assert_eq!(farthest < 0.03, is_on, "{farthest}");
    }
}
