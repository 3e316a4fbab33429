//! The axes of the plots: they always have labels, which do not change during a drag or a pause.

use crate::background::open_plate;
use crate::test_app::TestApp;
use crate::{line_rect, type_into};
use eframe::egui::{FullOutput, Key, Pos2, Rect, Shape, epaint::ClippedShape, pos2, vec2};
use egui_kittest::kittest::Queryable as _;

/// Every painted text and its place.
fn painted(app: &TestApp) -> Vec<(String, Rect)> {
    words(app.window.output())
}

/// Every text of a frame and its place.
pub(crate) fn words(picture: &FullOutput) -> Vec<(String, Rect)> {
    fn collect(shape: &Shape, words: &mut Vec<(String, Rect)>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, words)),
            Shape::Text(text) => {
                // The rows of a galley hold only the painted part of a shortened text.
                let rows: Vec<String> = text.galley.rows.iter().map(|row| row.text()).collect();
                words.push((rows.join(" "), text.visual_bounding_rect()));
            }
            _ => {}
        }
    }
    let mut words = Vec::new();
    for ClippedShape { shape, clip_rect, .. } in &picture.shapes {
        let mut here = Vec::new();
        collect(shape, &mut here);
        words.extend(here.into_iter().filter(|(_, rect)| clip_rect.intersects(*rect)));
    }
    words
}

/// The labels of both axes of a plot, in the order of their places.
fn labels(app: &TestApp, plot: &str) -> (Vec<String>, Vec<String>) {
    // The first of the tabs over the plot.
    let head = app.window.get_by_label(PLOTS[0]).rect();
    let fit = app.window.get_by_label(&format!("More: {plot}")).rect();
    // In a small window the row ends at the button that opens it.
    let switch = app.window.query_by_label("Plots").map(|button| button.rect().top() - 6.0);
    // Elsewhere at the status line.
    let bottom = switch.unwrap_or(app.window.ctx.content_rect().bottom() - 30.0);
    let area =
        Rect::from_min_max(pos2(head.left() - 6.0, head.bottom() + 2.0), pos2(fit.right() + 6.0, bottom));
    let words: Vec<(String, Rect)> =
        painted(app).into_iter().filter(|(_, rect)| area.contains(rect.center())).collect();
    let lowest = words.iter().map(|(_, rect)| rect.center().y).fold(0.0, f32::max);
    let (mut x, mut y): (Vec<_>, Vec<_>) =
        words.into_iter().partition(|(_, rect)| (rect.center().y - lowest).abs() < 3.0);
    // Peaks and notes in the plot are no labels of its axis.
    y.retain(|(word, _)| word.parse::<f64>().is_ok());
    x.sort_by(|a, b| a.1.left().total_cmp(&b.1.left()));
    y.sort_by(|a, b| a.1.top().total_cmp(&b.1.top()));
    let words = |labels: Vec<(String, Rect)>| labels.into_iter().map(|(word, _)| word).collect();
    (words(x), words(y))
}

const PLOTS: [&str; 2] = ["Drive waveform", "Spectrum"];

/// Opens the tab of a plot of the lower row.
pub(crate) fn open_plot(app: &mut TestApp, plot: &str) {
    app.click(plot, 100);
}

/// The labels of each plot, which are opened one after the other.
fn all_labels(app: &mut TestApp) -> [(Vec<String>, Vec<String>); 2] {
    PLOTS.map(|plot| {
        open_plot(app, plot);
        labels(app, plot)
    })
}

#[test]
fn every_axis_has_two_labels_at_least_for_every_plate_and_in_every_window() {
    let mut app = TestApp::driving();
    for preset in slipline_plate::presets() {
        open_plate(&mut app, slipline_plate::preset(preset.name).unwrap().to_toml());
        app.wait(1500);
        for size in [[1280.0, 800.0], [960.0, 620.0], [640.0, 480.0]] {
            app.resize(size.into(), 100);
            if let Some(message) = app.window.query_by_label("Dismiss") {
                message.click();
                app.wait(100);
            }
            if !app.has(PLOTS[1]) {
                app.click("Plots", 100);
            }
            for plot in PLOTS {
                open_plot(&mut app, plot);
                let (x, y) = labels(&app, plot);
                assert!(x.len() >= 2 && y.len() >= 2, "{} {size:?} {plot}: {x:?} {y:?}", preset.name);
                let units = x.iter().filter(|label| label.contains(' ')).count();
                assert_eq!(units, 1, "{} {plot}: one label has the unit: {x:?}", preset.name);
            }
        }
    }
}

#[test]
fn the_axes_stay_while_the_boundary_is_dragged_and_while_the_plots_are_held() {
    let mut app = TestApp::driving();
    let before = all_labels(&mut app);
    for (number, plot) in PLOTS.into_iter().enumerate() {
        open_plot(&mut app, plot);
        let line = line_rect(&app).center();
        app.grab(line, 0);
        for step in [-60.0, 40.0, 90.0] {
            app.hover(line + vec2(step, 0.0), 200);
            assert_eq!(labels(&app, plot), before[number], "dragged by {step}");
        }
        app.release(line, 200);
    }
    app.key(Key::P, 200);
    assert_eq!(all_labels(&mut app), before, "held");
    // Paused plots keep their axes, whatever changes in the setup.
    type_into(&mut app, "Boundary position", "90 mm");
    open_plate(&mut app, slipline_plate::preset("al-bending").unwrap().to_toml());
    app.wait(1500);
    assert_eq!(all_labels(&mut app), before, "held, with another plate");
    app.key(Key::P, 300);
    assert_ne!(all_labels(&mut app), before, "those of the other plate");
}

/// The numbers of the labels of a plot's x axis.
fn x_numbers(app: &TestApp, plot: &str) -> Vec<f64> {
    let labels = labels(app, plot).0;
    labels.iter().map(|label| label.split(' ').next().unwrap().parse().unwrap()).collect()
}

/// The middle of a plot.
fn middle(app: &TestApp, plot: &str) -> Pos2 {
    let (head, more) =
        (app.window.get_by_label(PLOTS[0]).rect(), app.window.get_by_label(&format!("More: {plot}")).rect());
    pos2(0.5 * (head.left() + more.right()) + 10.0, head.bottom() + 90.0)
}

#[test]
fn the_wheel_zooms_about_the_pointer_within_the_axes_and_a_double_click_shows_all_again() {
    let mut app = TestApp::driving();
    for plot in PLOTS {
        open_plot(&mut app, plot);
        let whole = x_numbers(&app, plot);
        let at = middle(&app, plot);
        app.turn_wheel(at, 150.0);
        let zoomed = x_numbers(&app, plot);
        let step = |labels: &[f64]| labels[1] - labels[0];
        assert!(step(&zoomed) < step(&whole), "{plot}: {whole:?} {zoomed:?}");
        assert!(zoomed[0] > whole[0] && zoomed.last() < whole.last(), "{plot}: {whole:?} {zoomed:?}");
        // A drag far to the right ends at the start of the axis.
        app.grab(at, 0);
        app.hover(at + vec2(900.0, 0.0), 0);
        app.release(at + vec2(900.0, 0.0), 100);
        assert_eq!(x_numbers(&app, plot)[0], whole[0], "{plot}");
        app.turn_wheel(at, -2000.0);
        assert_eq!(x_numbers(&app, plot), whole, "{plot}: no further than all");
        app.turn_wheel(at, 150.0);
        assert_ne!(x_numbers(&app, plot), whole);
        for _ in 0..2 {
            app.grab(at, 0);
            app.release(at, 0);
        }
        app.wait(100);
        assert_eq!(x_numbers(&app, plot), whole, "{plot}: after a double click");
    }
}

/// Every painted text that holds `part`.
fn read_outs(app: &TestApp, part: &str) -> Vec<String> {
    painted(app).into_iter().map(|(text, _)| text).filter(|text| text.contains(part)).collect()
}

/// Presses an entry of a plot's menu.
fn choose(app: &mut TestApp, plot: &str, entry: &str) {
    app.click(&format!("More: {plot}"), 200);
    app.click(entry, 300);
}

#[test]
fn the_plots_show_the_values_under_the_pointer_and_the_frequency_of_each_peak() {
    let mut app = TestApp::driving();
    open_plot(&mut app, "Spectrum");
    let area = app.window.get_by_label("More: Spectrum").rect();
    let head = app.window.get_by_label("Drive waveform").rect();
    let peaks = |app: &TestApp| -> Vec<String> {
        let inside =
            |rect: &Rect| rect.top() > head.bottom() && (head.left()..area.right()).contains(&rect.left());
        let words = painted(app).into_iter().filter(|(_, rect)| inside(rect)).map(|(word, _)| word);
        words.filter(|word| word.contains('.') && word.ends_with(" Hz")).collect()
    };
    assert_eq!(peaks(&app), ["138.3 Hz"], "one tone");
    let at = middle(&app, "Spectrum");
    app.hover(at, 200);
    assert!(read_outs(&app, " dB").iter().any(|text| text.contains("Hz")), "{:?}", read_outs(&app, "dB"));
    open_plot(&mut app, "Drive waveform");
    let at = middle(&app, "Drive waveform");
    app.hover(at, 200);
    assert_eq!(read_outs(&app, "of full scale").len(), 1);
    assert!(read_outs(&app, "of full scale")[0].contains(" ms"));
}

#[test]
fn a_curve_is_held_magnified_and_drawn_over_the_logarithm_of_the_frequency() {
    let mut app = TestApp::driving();
    type_into(&mut app, "Master", "-20 dB");
    app.wait(500);
    let y = |app: &TestApp| labels(app, "Drive waveform").1;
    assert!(y(&app).contains(&"1.0".to_owned()), "{:?}", y(&app));
    choose(&mut app, "Drive waveform", "Magnify to fit");
    // Level 0.8 at -20 dB, and the gain of the table.
    // The scales of the stage, which scales itself, and of the plot.
    assert_eq!(read_outs(&app, "×10"), ["×10", "×10"]);
    assert!(!y(&app).contains(&"1.0".to_owned()) && y(&app).contains(&"0.10".to_owned()), "{:?}", y(&app));
    for plot in PLOTS {
        open_plot(&mut app, plot);
        assert_eq!(read_outs(&app, "held: thin line").len(), 0, "{plot}");
        choose(&mut app, plot, "Hold to compare");
        assert_eq!(read_outs(&app, "held: thin line").len(), 1, "{plot}");
    }
    choose(&mut app, "Spectrum", "Hold to compare");
    assert_eq!(read_outs(&app, "held: thin line").len(), 0, "released");
    choose(&mut app, "Spectrum", "Logarithmic frequency");
    let x = x_numbers(&app, "Spectrum");
    assert!(x.len() >= 3 && x.windows(2).all(|pair| pair[1] >= 2.0 * pair[0]), "{x:?}");
    let whole = x;
    app.turn_wheel(middle(&app, "Spectrum"), 300.0);
    let zoomed = x_numbers(&app, "Spectrum");
    assert!(zoomed.len() >= 2 && zoomed != whole, "{zoomed:?}");
}

#[test]
fn every_tone_has_its_label_in_the_spectrum_and_nothing_else_has() {
    let mut app = TestApp::driving();
    let mut setup = app.window.state().setup().clone();
    let first = setup.tones[0];
    setup.master_db = -12.0;
    // The second is 9 Hz from the first, within its skirt.
    setup.tones = [(0, 0.18, 0.8), (1, 0.1855, 0.3), (2, 0.11, 0.02)]
        .map(|(slot, position_m, level)| slipline_model::setup::ToneSetup {
            slot,
            position_m,
            level,
            ..first
        })
        .into();
    app.open("three.toml", Ok(slipline_model::setup::file::write(&setup)));
    app.wait(1500);
    open_plot(&mut app, "Spectrum");
    let plate = &app.window.state().setup().plate;
    let wanted: std::collections::BTreeSet<String> = setup
        .tones
        .iter()
        .map(|tone| {
            slipline_plate::quantity::show_frequency(plate.frequency_for_boundary_hz(tone.position_m))
        })
        .collect();
    let head = app.window.get_by_label("Drive waveform").rect();
    let area = app.window.get_by_label("More: Spectrum").rect();
    let labels: std::collections::BTreeSet<String> = painted(&app)
        .into_iter()
        .filter(|(_, rect)| rect.top() > head.bottom() && (head.left()..area.right()).contains(&rect.left()))
        .map(|(word, _)| word)
        .filter(|word| word.contains('.') && word.ends_with(" Hz"))
        .collect();
    assert_eq!(labels, wanted);
}
