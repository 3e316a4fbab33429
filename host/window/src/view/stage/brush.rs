//! The brush: it draws the wanted amplitude over the envelope and shades the part of its shape that is out of reach.
//!
//! It lies over the lines, so that a stroke goes through them. The keyboard has the breakpoints of the page Texture.

use super::envelope::Height;
use super::layout::Layout;
use crate::intent::{Intent, Intents};
use crate::scene::Scene;
use crate::view::kept::Brush;
use crate::view::stage::polyline::thinned;
use crate::view::theme::{self, GAP, HANDLE, Palette};
use eframe::egui::{
    self, Button, Color32, CursorIcon, Event, FontId, Mesh, Pos2, Rect, Response, Sense, Shape, Stroke,
    UiBuilder, pos2, vec2,
};
use slipline_model::field::steady_field::POINTS;
use std::f64::consts::SQRT_2;

const CANVAS_HELP: &str = "Draw the wanted amplitude here with the pointer or a finger. The tones follow its shape, as high as it is drawn or as they can; \
    what the shape misses is shaded. A stroke is one step of undo";
const END_HELP: &str = "Put the brush away; a press on the envelope then moves the line. Esc does the same and stops the \
    drive";

/// Width of the button that puts the brush away, and size of the samples beside it, in points.
const END: f32 = 96.0;
const SAMPLE: egui::Vec2 = vec2(18.0, 9.0);

/// Takes the strokes, and shows what is wanted. Returns where the rest of the envelope's upper row begins, in points.
pub(super) fn show(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    layout: &Layout,
    brush: &mut Brush,
    intents: &mut Intents,
) -> f32 {
    let over = layout.axis.over_plate(layout.envelope);
    if !brush.is_taken {
        return over.left();
    }
    let canvas = ui.interact(over, ui.scope_id().with("brush"), Sense::CLICK | Sense::DRAG);
    theme::describe(&canvas, "Drawing area", CANVAS_HELP);
    let canvas = canvas.on_hover_and_drag_cursor(CursorIcon::Crosshair);
    let height = Height::of(scene, layout.envelope);
    // Heights have no measure until the plate's table is made.
    if scene.full_peak_m.is_some() {
        draw(ui, &canvas, layout, &height, brush, intents);
    }
    if scene.texture.is_drawn {
        wanted(ui, scene, layout, &height, brush.is_drawing());
    }
    let place = Rect::from_min_size(over.min + vec2(6.0, 2.0), vec2(END, HANDLE));
    let end = ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        // With a click alone the canvas under it would take the drag, and draw.
        ui.add_sized(place.size(), Button::new("Done").sense(Sense::click_and_drag()))
    });
    if end.inner.on_hover_text(END_HELP).clicked() {
        *brush = Brush::default();
    }
    if scene.texture.is_drawn { legend(ui, place.right_center(), over.right()) } else { place.right() }
}

/// Follows the pointer: the first point of a stroke is where it was pressed, each further one where it moved.
fn draw(
    ui: &egui::Ui,
    canvas: &Response,
    layout: &Layout,
    height: &Height,
    brush: &mut Brush,
    intents: &mut Intents,
) {
    let point = |at: Pos2| {
        let place_m = layout.axis.place_from_screen(at.x).clamp(0.0, layout.axis.length_m());
        // The envelope is a peak amplitude.
        (place_m, height.metres(at.y) / SQRT_2)
    };
    let is_down = canvas.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_down());
    let path: Vec<(f64, f64)> = match (brush.at, canvas.interact_pointer_pos()) {
        // Press and release may come in one frame.
        (None, Some(pointer)) if is_down || canvas.clicked() => vec![point(pointer)],
        (Some(last), Some(_)) if is_down || canvas.drag_stopped() => {
            let moves = ui.input(|input| {
                let to =
                    |event: &Event| if let Event::PointerMoved(to) = event { Some(point(*to)) } else { None };
                input.events.iter().filter_map(to).collect::<Vec<_>>()
            });
            // A pointer that rests adds nothing.
            if moves.is_empty() { Vec::new() } else { std::iter::once(last).chain(moves).collect() }
        }
        _ => Vec::new(),
    };
    if let Some(&last) = path.last() {
        brush.at = Some(last);
        intents.push(Intent::Draw(path));
    }
    brush.at = brush.at.filter(|_| is_down);
}

/// The ink over the part of the shape that is out of reach.
fn lack(palette: &Palette) -> Color32 {
    palette.warn.gamma_multiply(0.35)
}

/// The line of what is wanted, and the shade between it and what the tones make. What is too high as a whole has its shape
/// nevertheless: it is shown as high as the tones reach, and while it is drawn the line follows the pointer.
fn wanted(ui: &egui::Ui, scene: &Scene<'_>, layout: &Layout, height: &Height, is_drawing: bool) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(layout.envelope.expand(1.0));
    let made_m = scene.predicted.drawn_m();
    let length_m = layout.axis.length_m();
    let drawn: Vec<(f32, f64, f64)> = (0..POINTS)
        .filter_map(|i| {
            let place_m = length_m * i as f64 / (POINTS - 1) as f64;
            let wanted_m = SQRT_2 * scene.texture.draft.drawn_m(place_m)?;
            let made_m = made_m.get(i).copied().unwrap_or(0.0);
            Some((layout.axis.screen_from_place(place_m), wanted_m, made_m))
        })
        .collect();
    let reached = scene.texture.reached;
    let mut shade = Mesh::default();
    for &(x, wanted_m, made_m) in &drawn {
        shade.colored_vertex(pos2(x, height.screen(reached * wanted_m)), lack(palette));
        shade.colored_vertex(pos2(x, height.screen(made_m)), lack(palette));
    }
    for i in 0..drawn.len().saturating_sub(1) as u32 {
        shade.add_triangle(2 * i, 2 * i + 1, 2 * i + 2);
        shade.add_triangle(2 * i + 1, 2 * i + 2, 2 * i + 3);
    }
    painter.add(Shape::mesh(shade));
    let shown = if is_drawing { 1.0 } else { reached };
    let line: Vec<Pos2> =
        drawn.iter().map(|&(x, wanted_m, _)| pos2(x, height.screen(shown * wanted_m))).collect();
    painter.extend(Shape::dashed_line(&thinned(&line), Stroke::new(2.0, palette.text), 6.0, 3.0));
}

/// What line and shade mean, from this place on as far as there is room; returns where it ends.
fn legend(ui: &egui::Ui, from: Pos2, end: f32) -> f32 {
    let palette = theme::palette(ui);
    let behind = ui.painter().add(Shape::Noop);
    let mut left = from.x + GAP;
    for words in ["wanted", "out of reach"] {
        let galley = ui.painter().layout_no_wrap(words.to_owned(), FontId::proportional(11.5), palette.weak);
        let right = left + SAMPLE.x + 6.0 + galley.size().x;
        if right > end {
            break;
        }
        let sample = Rect::from_min_size(pos2(left, from.y - 0.5 * SAMPLE.y), SAMPLE);
        if words == "wanted" {
            let line = [sample.left_center(), sample.right_center()];
            ui.painter().extend(Shape::dashed_line(&line, Stroke::new(2.0, palette.text), 6.0, 3.0));
        } else {
            ui.painter().rect_filled(sample, 1.0, lack(palette));
        }
        ui.painter().galley(pos2(sample.right() + 6.0, from.y - 0.5 * galley.size().y), galley, palette.weak);
        left = right + 2.0 * GAP;
    }
    // The curves do not cross its words.
    let area = Rect::from_min_max(pos2(from.x, from.y - 9.0), pos2(left - GAP, from.y + 9.0));
    ui.painter().set(behind, Shape::rect_filled(area, 4.0, palette.well.gamma_multiply(0.9)));
    left
}
