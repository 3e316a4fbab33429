//! The amplitude glows under the wave: no moment of a driven plate looks like a plate at rest.

use crate::painter::Painter;
use crate::test_app::TestApp;
use eframe::egui::{Color32, ColorImage, Key, Rect, Theme};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::Queryable as _;
use slipline_model::scenes::SCENES;
use slipline_window::settings::ThemeChoice;

/// Size of the window in points and pixels.
const SIZE: [u16; 2] = [640, 480];
/// Phases of the wave at which a picture is taken, over about one period.
const PHASES: usize = 20;
/// Difference of a channel that is seen.
const SEEN: u8 = 8;

/// The plate as it looks now.
fn plate(app: &TestApp, painter: &Painter, over: Rect) -> ColorImage {
    painter.paint_within(&app.window.ctx, app.window.output(), SIZE.map(usize::from), over)
}

/// The share of the pixels of `over` that differ visibly.
fn share_off(a: &ColorImage, b: &ColorImage, over: Rect) -> f64 {
    let is_off = |(a, b): &(&Color32, &Color32)| {
        a.r().abs_diff(b.r()).max(a.g().abs_diff(b.g())).max(a.b().abs_diff(b.b())) >= SEEN
    };
    let off = a.pixels.iter().zip(&b.pixels).filter(is_off).count();
    off as f64 / f64::from(over.area())
}

#[test]
fn in_no_phase_of_the_wave_the_plate_of_a_scene_looks_as_at_rest() {
    for (i, scene) in SCENES.iter().enumerate() {
        // Both themes in turn.
        let (theme, look) = [(ThemeChoice::Dark, Theme::Dark), (ThemeChoice::Light, Theme::Light)][i % 2];
        let painter = Painter::default();
        let builder = HarnessBuilder::default()
            .with_size(SIZE.map(f32::from))
            .with_theme(look)
            .renderer(painter.clone());
        let mut app = TestApp::driving_setup(scene.setup().unwrap(), theme, builder);
        // A period of the slowest tone takes 1.5 s; 4 times as fast, a frame of the harness is a 22nd of it.
        app.click("Play", 100);
        crate::type_into(&mut app, "Speed", "4");
        let over = app.window.get_by_label("Plate from above").rect();
        let moving: Vec<ColorImage> = (0..PHASES)
            .map(|_| {
                app.wait(50);
                plate(&app, &painter, over)
            })
            .collect();
        app.key(Key::Space, 600);
        assert!(!app.is_driving());
        let rest = plate(&app, &painter, over);
        for (phase, moving) in moving.iter().enumerate() {
            let share = share_off(moving, &rest, over);
            assert!(share >= 0.02, "{}, phase {phase}: {share}", scene.name);
        }
    }
}
