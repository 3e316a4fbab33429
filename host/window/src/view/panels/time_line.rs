//! The time line of a recorded drag, on the page Play: where the lines were, over the time, and where it stands now. Its room is
//! there without a recording, too, so that a recording moves nothing.

use crate::intent::{Intent, Intents};
use crate::scene::Scene;
use crate::view::stage::polyline::thinned;
use crate::view::theme;
use eframe::egui::{
    self, Align2, CursorIcon, FontId, Key, Pos2, Rangef, Rect, Sense, Shape, Stroke, StrokeKind, pos2, vec2,
};
use slipline_plate::quantity::ticks::Ticks;

const HELP: &str = "Where the lines of the recorded drag are over the time, the driven end below. Press or drag to go to a time, or press \
    the arrow keys; a replay goes on from there";

/// Height of the line, and of the labels under it, in points.
const LINE: f32 = 32.0;
const LABELS: f32 = 14.0;
/// Space at its left for the unit, in points.
const UNIT: f32 = 26.0;
/// The step of the arrow keys, as a share of the recording.
const STEP: f64 = 0.02;

/// Shows it, and takes the presses.
pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let (room, _) = ui.allocate_exact_size(vec2(ui.available_width(), LINE + LABELS), Sense::hover());
    let right_bottom = pos2(room.right() - 2.0, room.bottom() - LABELS);
    let rect = Rect::from_min_max(room.left_top() + vec2(UNIT, 0.0), right_bottom);
    let is_there = scene.recorder.is_recording() || !scene.recorder.recording().moves().is_empty();
    if !is_there {
        let ink = theme::palette(ui).line;
        ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.0, ink), StrokeKind::Outside);
        return;
    }
    let length_s = scene.recorder.recording().duration_s();
    let id = ui.scope_id().with("time line");
    let response = ui.interact(rect, id, Sense::click_and_drag()).on_hover_cursor(CursorIcon::PointingHand);
    let head_s = scene.recorder.head_s();
    response.widget_info(|| egui::WidgetInfo::slider(true, head_s.unwrap_or(0.0), "Time of the recording"));
    paint(ui, scene, rect, response.has_focus());
    let is_chosen = response.is_pointer_button_down_on() || response.clicked();
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| is_chosen) {
        response.request_focus();
        let share = f64::from((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        intents.push(Intent::Seek(share * length_s));
    } else if response.has_focus() {
        theme::keep_arrows(ui, id);
        let steps = ui.input(|input| {
            input.num_presses(Key::ArrowRight) as f64 - input.num_presses(Key::ArrowLeft) as f64
        });
        if steps != 0.0 {
            intents.push(Intent::Seek(head_s.unwrap_or(0.0) + steps * STEP * length_s));
        }
    }
    response.on_hover_text(HELP);
}

fn paint(ui: &egui::Ui, scene: &Scene<'_>, rect: Rect, has_focus: bool) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, palette.well);
    let font = FontId::proportional(11.5);
    let recording = scene.recorder.recording();
    let length_s = recording.duration_s();
    let x = |time_s: f64| rect.left() + (time_s / length_s.max(f64::MIN_POSITIVE)) as f32 * rect.width();
    let ticks = Ticks::between(0.0, length_s, length_s * 60.0 / f64::from(rect.width()));
    for &time_s in &ticks.places {
        painter.vline(x(time_s), rect.y_range(), Stroke::new(1.0, palette.grid));
        let at = pos2(x(time_s), rect.bottom() + 1.0);
        let label = painter.layout_no_wrap(ticks.label(time_s), font.clone(), palette.weak);
        // The first and the last label stay within the line.
        let left = (at.x - 0.5 * label.size().x).min(rect.right() - label.size().x).max(rect.left());
        painter.galley(pos2(left, at.y), label, palette.weak);
    }
    let unit = pos2(rect.left() - 8.0, rect.bottom() + 1.0);
    painter.text(unit, Align2::RIGHT_TOP, "t, s", font, palette.weak);
    let inner = rect.shrink(3.0);
    let length_m = scene.setup.plate.length_m();
    let y = |place_m: f64| inner.bottom() - (place_m / length_m).clamp(0.0, 1.0) as f32 * inner.height();
    let mut paths: Vec<(u8, Vec<Pos2>)> = Vec::new();
    for step in recording.moves() {
        let at = pos2(x(step.time_s), y(step.place_m));
        match paths.iter_mut().find(|(slot, _)| *slot == step.slot) {
            None => paths.push((step.slot, vec![at])),
            // More than the screen can show are left out.
            Some((_, path)) if path.last().is_none_or(|last| at.x - last.x >= 0.5) => path.push(at),
            Some(_) => {}
        }
    }
    for (slot, mut path) in paths {
        // From its last move on a line stays.
        let last = recording.moves().iter().rfind(|step| step.slot == slot);
        path.extend(last.map(|step| pos2(rect.right(), y(step.place_m))));
        let ink = if slot == scene.selected { palette.accent } else { palette.weak };
        painter.add(Shape::line(thinned(&path), Stroke::new(1.8, ink)));
    }
    if let Some(head_s) = scene.recorder.head_s() {
        let at = x(head_s).clamp(rect.left(), rect.right());
        painter.vline(
            at,
            Rangef::new(rect.top() - 3.0, rect.bottom() + 3.0),
            Stroke::new(2.0, palette.boundary),
        );
    }
    let rim = if has_focus { Stroke::new(2.0, palette.accent) } else { Stroke::new(1.0, palette.line) };
    painter.rect_stroke(rect, 3.0, rim, StrokeKind::Outside);
}
