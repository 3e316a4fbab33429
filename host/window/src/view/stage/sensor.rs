//! The sensor on the stage: where it stands, or where it is to be put, while the plate is measured or calibrated; and how much
//! of a measurement is done.

use super::layout::Layout;
use crate::intent::Dialog;
use crate::scene::Scene;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Pos2, Rect, Sense, Shape, Stroke, pos2, vec2};
use slipline_plate::quantity::show_place;
use std::f32::consts::TAU;

/// Radius of its ring, in points.
const RING: f32 = 9.0;
/// Steps of a whole turn of the ring that is done.
const STEPS: f32 = 48.0;

/// Its place in metres, while there is something to measure.
fn place_m(scene: &Scene<'_>, view: &ViewState) -> Option<f64> {
    let live = &scene.measure.live;
    let open = scene.calibration.as_ref().filter(|_| matches!(scene.dialog, Some(Dialog::Calibrate)));
    let asked_m = open.and_then(|shown| {
        let calibration = shown.calibration;
        Some(calibration.places_m()[calibration.step.sensor()?])
    });
    asked_m.or((view.is_measuring() || live.progress.is_some()).then_some(live.draft.place_m))
}

/// Shows it on the plate, and its place through the envelope.
pub(super) fn show(ui: &egui::Ui, scene: &Scene<'_>, view: &ViewState, layout: &Layout) {
    let Some(place_m) =
        place_m(scene, view).filter(|place_m| (0.0..=layout.axis.length_m()).contains(place_m))
    else {
        return;
    };
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let at = pos2(layout.axis.screen_from_place(place_m), layout.plate.center().y);
    let ends = [pos2(at.x, layout.envelope.top()), pos2(at.x, layout.envelope.bottom())];
    painter.extend(Shape::dashed_line(&ends, Stroke::new(1.0, palette.text), 3.0, 4.0));
    painter.circle(at, RING, palette.panel, Stroke::new(1.5, palette.text));
    painter.circle_filled(at, 3.0, palette.text);
    let progress = scene.measure.live.progress;
    if let Some(progress) = progress {
        painter.add(Shape::line(arc(at, RING + 3.0, progress.share), Stroke::new(3.0, palette.accent)));
    }
    let rect = Rect::from_center_size(at, vec2(2.0 * RING, 2.0 * RING));
    let seen = ui.interact(rect, ui.scope_id().with("sensor"), Sense::hover());
    let said = format!("Sensor at {}", show_place(place_m));
    seen.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
    seen.on_hover_text(said);
}

/// This share of a turn, clockwise from the top.
fn arc(centre: Pos2, radius: f32, share: f32) -> Vec<Pos2> {
    let steps = (share.clamp(0.0, 1.0) * STEPS).ceil().max(1.0);
    let angle = |step: f32| share * TAU * step / steps;
    (0..=steps as usize)
        .map(|step| angle(step as f32))
        .map(|angle| centre + radius * vec2(angle.sin(), -angle.cos()))
        .collect()
}
