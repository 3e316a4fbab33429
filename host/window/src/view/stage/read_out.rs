//! The read-out under the pointer on the stage: the place, the plate's displacement there, and how strongly it is felt.

use crate::axis::Axis;
use crate::scene::Scene;
use crate::view::theme::{self, HANDLE};
use eframe::egui::{self, CornerRadius, FontId, Rangef, Rect, Stroke, StrokeKind, Tooltip, pos2, vec2};
use slipline_model::field::steady_field::interpolate;
use slipline_plate::quantity::{decibels, show_length, show_place};

/// Space between the pointer's line and the words, and around the words, in points.
const BESIDE: f32 = 8.0;
const INSET: egui::Vec2 = vec2(6.0, 3.0);

/// The words for a place. One tone is stated by its largest displacement, several by sqrt(2) times their RMS.
pub(crate) fn words(scene: &Scene<'_>, place_m: f64) -> String {
    let mut words = show_place(place_m);
    let predicted = scene.predicted;
    if scene.full_peak_m.is_some() {
        let amplitude_m = if predicted.is_mean() {
            interpolate(&predicted.rms_m, place_m / predicted.length_m) * std::f64::consts::SQRT_2
        } else {
            predicted.bound_at(place_m)
        };
        words.push_str(&format!("   {}", show_length(amplitude_m)));
    }
    if let Some(felt) = scene.felt {
        words.push_str(&match decibels(felt.at(place_m)) {
            over_db if over_db >= 0.0 => format!("   {over_db:.0} dB over felt"),
            over_db if over_db > -100.0 => format!("   {:.0} dB below felt", -over_db),
            _ => "   not felt".to_owned(),
        });
    }
    words
}

/// Shows it while the pointer is over the views and holds nothing.
pub(crate) fn show(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, views: Rect) {
    let pointer = ui.input(|input| input.pointer.hover_pos());
    let Some(pointer) = pointer.filter(|at| views.contains(*at) && ui.rect_contains_pointer(views)) else {
        return;
    };
    // One at a time: an explanation takes its place.
    if scene.grab.is_some() || Tooltip::seconds_since_last_tooltip(ui.ctx()) <= 0.0 {
        return;
    }
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let place_m = axis.place_from_screen(pointer.x).clamp(0.0, axis.length_m());
    painter.vline(pointer.x, views.y_range(), Stroke::new(1.0, palette.weak.gamma_multiply(0.6)));
    let words = painter.layout_no_wrap(words(scene, place_m), FontId::proportional(12.0), palette.text);
    let size = words.size() + 2.0 * INSET;
    // On the side of the pointer where there is room, beside the knob of a line that is under it, and above it so that a finger
    // does not hide it.
    let line = scene.line(scene.selected).map(|line| axis.line_from_place(line.place_m));
    let knob =
        line.map(|x| Rangef::new(x - 0.5 * HANDLE, x + 0.5 * HANDLE)).filter(|knob| knob.contains(pointer.x));
    let taken = knob.unwrap_or(Rangef::point(pointer.x)).expand(BESIDE);
    let left =
        if taken.max + size.x <= views.right() { taken.max } else { (taken.min - size.x).max(views.left()) };
    let bottom = Rangef::new(views.top() + size.y, views.bottom()).clamp(pointer.y - BESIDE);
    let rect = Rect::from_min_size(pos2(left, bottom - size.y), size);
    let stroke = Stroke::new(1.0, palette.line);
    painter.rect(rect, CornerRadius::same(4), palette.panel, stroke, StrokeKind::Inside);
    painter.galley(rect.min + INSET, words, palette.text);
}
