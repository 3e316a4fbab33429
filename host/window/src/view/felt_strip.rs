//! The strip: what a finger would feel along x. Illustrative: it is not calibrated to the user's plate and finger.

use super::{Scene, theme};
use crate::axis::Axis;
use eframe::egui::{self, Align2, FontId, Rect, Stroke, StrokeKind, pos2, vec2};
use slipline_plate::sensation::{SLIPPERY_FROM_HZ, Sensation, felt};

/// A vibration this far above the threshold of feeling gets the full colour, in dB.
const STRONG_DB: f64 = 50.0;

/// The share of the colour while nothing is driven.
const AT_REST: f32 = 0.3;

/// The felt strength, as a share of the full colour.
fn strength(sensation: Sensation) -> f64 {
    match sensation {
        Sensation::Vibration { level_db } => (level_db / STRONG_DB).clamp(0.0, 1.0),
        Sensation::Friction { ratio } => (1.0 - ratio).clamp(0.0, 1.0),
    }
}

/// Shows the strip in `rect`.
pub(super) fn show(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, rect: Rect) {
    let palette = theme::palette(ui);
    let over = axis.over_plate(rect);
    let painter = ui.painter();
    // At rest nothing is felt, so the strip is as faint as the envelope.
    let share = if scene.sounding.is_some() { 1.0 } else { AT_REST };
    let columns = (over.width() / 2.0).ceil() as usize;
    // While the height is unknown, the felt strength is unknown, too.
    let columns = if scene.full_peak_m.is_some() { columns } else { 0 };
    for i in 0..columns {
        let x = over.left() + 2.0 * i as f32;
        let place = axis.place_from_screen(x + 1.0);
        let sensation = felt(scene.predicted.frequency_at(place), scene.predicted.bound_at(place));
        let cell = Rect::from_min_size(pos2(x, over.top()), vec2(2.5, over.height())).intersect(over);
        let colour = theme::sequential(strength(sensation) as f32, palette.dark);
        painter.rect_filled(cell, 0.0, palette.page.lerp_to_gamma(colour, share));
    }
    painter.rect_stroke(over, 3.0, Stroke::new(1.0, palette.line), StrokeKind::Outside);
    let small = FontId::proportional(11.5);
    let label = pos2(over.left() - 8.0, over.center().y);
    painter.text(label, Align2::RIGHT_CENTER, "felt", small, palette.weak);
}

/// The explanation of the strip. It is beside the strip, because text on it would hide the edge.
pub(super) fn words(scene: &Scene<'_>) -> &'static str {
    let mut waves = scene.predicted.tones.iter();
    if waves.any(|wave| wave.tone.frequency_hz >= SLIPPERY_FROM_HZ) {
        "felt: how slippery, illustrative"
    } else {
        "felt: how strong the vibration, illustrative"
    }
}
