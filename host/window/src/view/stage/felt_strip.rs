//! The strip: what a finger would feel along x, in three zones. Illustrative: it is not calibrated to the user's plate and
//! finger.

use crate::axis::Axis;
use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{
    self, Align2, Color32, FontId, Pos2, Rangef, Rect, Sense, Shape, Stroke, StrokeKind, pos2, vec2,
};
use slipline_model::field::felt::{Felt, Zone, by_person_words};
use slipline_plate::check::sensation::SLIPPERY_FROM_HZ;
use slipline_plate::feeling::FeltEdge;
use slipline_plate::quantity::{show_half_width, show_place};

/// The share of the colour while nothing is driven.
const AT_REST: f32 = 0.3;
/// Side of the legend's squares, and the space around them, in points.
const SQUARE: f32 = 9.0;
const SPACE: f32 = 5.0;

/// The colour of a zone; zones that no finger feels have none.
pub(crate) fn colour(zone: Zone, palette: &theme::Palette) -> Color32 {
    match zone {
        Zone::Clearly => theme::sequential(0.85, palette.dark),
        Zone::Just => theme::sequential(0.45, palette.dark),
        Zone::Not => palette.well,
    }
}

const HELP: &str = "What a finger feels along the plate, in three zones; the mark under it is where it ends. A press moves the finger there. Illustrative: fingers differ, the panel Boundary has the numbers";

/// Shows the strip in `rect`.
pub(crate) fn show(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, rect: Rect) {
    let palette = theme::palette(ui);
    let over = axis.over_plate(rect);
    let painter = ui.painter();
    painter.rect_filled(over, 0.0, palette.well);
    let small = FontId::proportional(11.5);
    let label = pos2(over.left() - 8.0, over.center().y);
    painter.text(label, Align2::RIGHT_CENTER, "felt", small.clone(), palette.weak);
    // While the height is unknown, the felt strength is unknown, too.
    if let Some(felt) = scene.felt {
        // At rest nothing is felt, so the strip is as faint as the envelope.
        let share = if scene.sounding.is_some() { 1.0 } else { AT_REST };
        for (range, zone) in zones(felt, axis, over.x_range()) {
            let cell = Rect::from_x_y_ranges(range, over.y_range());
            painter.rect_filled(cell, 0.0, palette.well.lerp_to_gamma(colour(zone, palette), share));
        }
        if let Some(why) = felt.not_felt {
            painter.text(over.center(), Align2::CENTER_CENTER, why.words(), small, palette.text);
        }
        if let FeltEdge::At(edge_m) = felt.edge {
            mark(painter, pos2(axis.line_from_place(edge_m), over.bottom()), palette);
        }
    }
    painter.rect_stroke(over, 3.0, Stroke::new(1.0, palette.line), StrokeKind::Outside);
    let said = said(scene);
    let response = ui.interact(over, ui.scope_id().with("felt strip"), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
    response.on_hover_text(HELP);
}

/// The felt edge of all tones together, as a mark under the strip.
fn mark(painter: &egui::Painter, at: Pos2, palette: &theme::Palette) {
    let points = vec![at, at + vec2(-4.0, 5.0), at + vec2(4.0, 5.0)];
    painter.add(Shape::convex_polygon(points, palette.text, Stroke::NONE));
}

/// The stretches of the screen in one zone each, from the left; their ends are on whole pixels.
fn zones(felt: &Felt, axis: &Axis, over: Rangef) -> Vec<(Rangef, Zone)> {
    let mut found: Vec<(Rangef, Zone)> = Vec::new();
    let pixel = axis.pixel();
    for i in 0..(over.span() / pixel).round() as usize {
        let left = over.min + i as f32 * pixel;
        let zone = Zone::of(felt.at(axis.place_from_screen(left + 0.5 * pixel)));
        match found.last_mut() {
            Some((range, last)) if *last == zone => range.max = left + pixel,
            _ => found.push((Rangef::new(left, left + pixel), zone)),
        }
    }
    found
}

/// Where it is felt, in words.
fn said(scene: &Scene<'_>) -> String {
    let Some(felt) = scene.felt else { return "felt: not known yet".to_owned() };
    // The line of a tone stands where the tone alone ends.
    let all = if scene.setup.tones.len() > 1 { "together " } else { "" };
    let mut said = match felt {
        Felt { not_felt: Some(why), .. } => return why.words(),
        Felt { edge: FeltEdge::At(edge_m), tolerance_m, .. } => {
            let known = tolerance_m.map_or(String::new(), |half_m| format!(" {}", show_half_width(half_m)));
            format!("{all}felt to {}{known}", show_place(*edge_m))
        }
        Felt { .. } => format!("{all}felt to the plate's end"),
    };
    if let Some(by_person) = by_person_words(felt.by_person) {
        said.push_str(", ");
        said.push_str(&by_person);
    }
    if let Some(second) = felt.second_words() {
        said.push_str("; ");
        said.push_str(&second);
    }
    said
}

/// The legend: where it is felt, the zones, and what is felt. It is under the strip, because text on it would hide the edge.
/// In a narrow window the last entries have no room.
pub(crate) fn legend(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, bottom: f32) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let font = FontId::proportional(11.5);
    let screen = axis.screen();
    let is_slippery = scene.predicted.tones.iter().any(|wave| wave.tone.frequency_hz >= SLIPPERY_FROM_HZ);
    let what = if is_slippery { "slipperiness, illustrative" } else { "vibration, illustrative" };
    let galley = |text: &str, ink: Color32| painter.layout_no_wrap(text.to_owned(), font.clone(), ink);
    let what = galley(what, palette.weak);
    let top = bottom - what.size().y;
    let end = screen.max - what.size().x;
    painter.galley(pos2(end, top), what, palette.weak);
    let words = galley(&said(scene), palette.text);
    let mut left = screen.min;
    let width = words.size().x;
    if left + width + 2.0 * SPACE > end {
        return;
    }
    painter.galley(pos2(left, top), words, palette.text);
    left += width + 3.0 * SPACE;
    for zone in Zone::ALL {
        let name = galley(zone.name(), palette.weak);
        let width = SQUARE + SPACE + name.size().x;
        if left + width + 2.0 * SPACE > end {
            return;
        }
        let square =
            Rect::from_min_size(pos2(left, top + 0.5 * (name.size().y - SQUARE)), vec2(SQUARE, SQUARE));
        painter.rect(square, 1.0, colour(zone, palette), Stroke::new(1.0, palette.line), StrokeKind::Outside);
        painter.galley(pos2(left + SQUARE + SPACE, top), name, palette.weak);
        left += width + 2.0 * SPACE;
    }
}
