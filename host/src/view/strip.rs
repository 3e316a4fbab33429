//! What a finger would feel along x. Illustrative: nobody has calibrated it on the user's plate and finger.

use super::axis::Axis;
use super::{Scene, theme};
use eframe::egui::{self, Align2, FontId, Rect, Stroke, StrokeKind, pos2, vec2};
use slipline_plate::sensation::{Sensation, felt};

/// A vibration this far above the threshold of feeling gets the full colour, in dB.
const STRONG_DB: f64 = 50.0;

/// What is left of the colour while nothing is driven.
const AT_REST: f32 = 0.3;

/// What is felt, as a share of the most that is drawn.
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
    // What is not driven is not felt: as faint as the envelope then is.
    let share = if scene.sounding.is_some() { 1.0 } else { AT_REST };
    let columns = (over.width() / 2.0).ceil() as usize;
    let is_slippery =
        scene.predicted.tones.iter().any(|wave| wave.tone.frequency_hz >= super::boundary::SLIPPERY_FROM_HZ);
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
    painter.text(label, Align2::RIGHT_CENTER, "felt", small.clone(), palette.weak);
    let text =
        if is_slippery { "how slippery, illustrative" } else { "how strong the vibration, illustrative" };
    let galley = painter.layout_no_wrap(text.to_owned(), small, palette.text);
    let pad = vec2(7.0, 2.0);
    let anchor = pos2(over.right() - 6.0, over.center().y);
    let chip = Align2::RIGHT_CENTER.anchor_size(anchor, galley.size() + 2.0 * pad);
    painter.rect_filled(chip, 4.0, palette.panel.gamma_multiply(0.88));
    painter.galley(chip.min + pad, galley, palette.text);
}
