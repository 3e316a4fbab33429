//! What a picture costs while the line is dragged, counted: passes of the layout, and triangles for the graphics. Without a
//! graphics card the processor draws each.

use crate::line_rect;
use crate::test_app::TestApp;
use eframe::egui::epaint::Primitive;
use eframe::egui::{Pos2, Rect, vec2};
use egui_kittest::HarnessBuilder;
use slipline_window::settings::ThemeChoice;

/// Most triangles of a picture of the first scene in a window of 1280 x 800 points.
const MOST: usize = 20_000;
/// Most that is drawn of it, over the window's area: nearly each point once.
const MOST_DRAWN: f32 = 1.1;
/// Most memory in bytes that a drag of two seconds may keep when it is over, once all that is bounded is full. An hour of
/// drags would keep less than 10 MB then; the tests record most of it.
const MOST_KEPT: i64 = 5_000;

/// The triangles of the latest picture whose middle lies in a part of the window.
fn triangles(app: &TestApp, part: Rect) -> usize {
    let output = app.window.output();
    let primitives = app.window.ctx.tessellate(output.shapes.clone(), output.pixels_per_point);
    let meshes = primitives.iter().filter_map(|primitive| match &primitive.primitive {
        Primitive::Mesh(mesh) => Some(mesh),
        Primitive::Callback(_) => None,
    });
    let is_in =
        |mesh: &eframe::egui::Mesh, corners: &[u32]| part.contains(mesh.vertices[corners[0] as usize].pos);
    meshes.map(|mesh| mesh.indices.chunks_exact(3).filter(|corners| is_in(mesh, corners)).count()).sum()
}

/// The area of all triangles of the latest picture, but for the two with which the tests' window fills itself.
fn drawn(app: &TestApp) -> f32 {
    let output = app.window.output();
    let primitives = app.window.ctx.tessellate(output.shapes.clone(), output.pixels_per_point);
    let meshes = primitives.iter().skip(1).filter_map(|primitive| match &primitive.primitive {
        Primitive::Mesh(mesh) => Some(mesh),
        Primitive::Callback(_) => None,
    });
    let area = |mesh: &eframe::egui::Mesh, corners: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|corner| mesh.vertices[corners[corner] as usize].pos);
        0.5 * ((b - a).x * (c - a).y - (b - a).y * (c - a).x).abs()
    };
    meshes.flat_map(|mesh| mesh.indices.chunks_exact(3).map(move |corners| area(mesh, corners))).sum()
}

/// The first scene while its line is dragged.
fn dragged() -> TestApp {
    let builder = HarnessBuilder::default().with_size([1280.0, 800.0]);
    let mut app =
        TestApp::driving_setup(slipline_window::app::first_setup().unwrap(), ThemeChoice::Light, builder);
    let line = line_rect(&app).center();
    app.grab(line, 100);
    app.hover(line - vec2(6.0, 0.0), 100);
    app
}

#[test]
fn a_picture_of_a_drag_draws_nearly_each_point_of_the_window_once() {
    let app = dragged();
    let share = drawn(&app) / (1280.0 * 800.0);
    assert!((0.5..MOST_DRAWN).contains(&share), "{share}");
}

#[test]
fn a_drag_draws_the_modal_lines_and_its_end_the_sheet() {
    let mut app = dragged();
    let shows = |app: &TestApp, source: &str| app.has_part(source);
    assert!(shows(&app, "modal lines, 1/") && !shows(&app, "2-D sheet, 1/"));
    let jobs = app.sheet_jobs.get();
    let at = line_rect(&app).center();
    for step in 1..=10 {
        app.hover(at - vec2(4.0 * step as f32, 0.0), 50);
    }
    assert_eq!(app.sheet_jobs.get(), jobs, "none while it is dragged");
    app.release(at - vec2(40.0, 0.0), 200);
    assert!(shows(&app, "2-D sheet, 1/") && app.sheet_jobs.get() > jobs);
}

#[test]
fn a_picture_of_a_drag_is_laid_out_once_and_has_few_triangles() {
    let mut app = dragged();
    let line = line_rect(&app).center();
    for step in 1..=10 {
        app.hover(line - vec2(6.0 * step as f32, 0.0), 50);
        let passes = app.window.output().platform_output.num_completed_passes;
        assert_eq!(passes, 1, "step {step}");
    }
    let parts = [
        ("top bar", Rect::from_x_y_ranges(0.0..=1280.0, 0.0..=54.0)),
        ("stage", Rect::from_x_y_ranges(0.0..=932.0, 54.0..=578.0)),
        ("panel", Rect::from_x_y_ranges(932.0..=1280.0, 54.0..=578.0)),
        ("waveform", Rect::from_x_y_ranges(0.0..=420.0, 578.0..=772.0)),
        ("spectrum", Rect::from_x_y_ranges(420.0..=830.0, 578.0..=772.0)),
        ("meters, log", Rect::from_x_y_ranges(830.0..=1280.0, 578.0..=772.0)),
        ("status", Rect::from_x_y_ranges(0.0..=1280.0, 772.0..=800.0)),
    ];
    let counts: Vec<(&str, usize)> = parts.map(|(name, part)| (name, triangles(&app, part))).into();
    let sum: usize = counts.iter().map(|(_, count)| count).sum();
    println!("{counts:?} {sum}");
    assert!(sum < MOST, "{counts:?}");
}

/// Drags the line away and back within two seconds.
fn drag(app: &mut TestApp, line: Pos2) {
    app.window.drag_at(line);
    for step in 1..=20_u8 {
        let away = 60.0 * (f32::from(step) * std::f32::consts::TAU / 20.0).sin();
        app.hover(line + vec2(away, 0.0), 100);
    }
    app.release(line, 500);
}

#[test]
#[ignore = "a thousand pictures: .ci/run long_tests"]
fn the_memory_of_a_driven_window_is_flat_from_drag_to_drag() {
    let mut app = dragged();
    let line = line_rect(&app).center();
    app.release(line, 500);
    let kept: Vec<i64> =
        (0..24).map(|_| allocation_counter::measure(|| drag(&mut app, line)).bytes_current).collect();
    assert!(kept[16..].iter().sum::<i64>() < 8 * MOST_KEPT, "{kept:?}");
}
