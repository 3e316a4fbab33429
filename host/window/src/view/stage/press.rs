//! A press on the plate or the envelope: the selected tone's line moves there.
//!
//! A press that is held, or that moves, takes the line at once, and the line follows the pointer. A short press may be the
//! first of a double click, which adds a tone and moves no line. So it marks its place at once, and the line moves once the
//! time of a double click has passed: no movement has to be undone, neither on the screen nor on the plate.
//!
//! Lines, the finger and the lights' symbols lie over both views and keep their presses.

use super::layout::Layout;
use crate::intent::{Dragged, Grab, Intent, Intents};
use crate::scene::Scene;
use crate::view::kept::{Press, Pressing};
use crate::view::theme::{self, HANDLE};
use eframe::egui::{self, Pos2, Rangef, Rect, Response, Sense, Shape, Stroke, pos2};
use slipline_model::setup::edit::Edit;
use std::time::Duration;

/// A press of this duration is no click, in seconds.
const HELD_S: f64 = 0.25;

/// The pointer shows the place to those who see it; this text is for those who do not.
const PLATE_HELP: &str = "The plate and its wave, the driven end at the left. A press moves the selected tone's line to that \
    place, a double click adds a tone there";
const ENVELOPE_HELP: &str = "How far each place of the plate moves at most: predicted as a line, the actual plate as rings, a hidden \
    test plate at the level of the line. \
    A press moves the selected tone's line to that \
    place, a double click adds a tone there";

impl Pressing {
    /// Whether the pointer rests on the knob of a line that it has brought.
    pub(crate) fn has_brought(&mut self, pointer: Option<Pos2>) -> bool {
        self.brought_at = self.brought_at.filter(|at| pointer.is_some_and(|to| to.distance(*at) <= HANDLE));
        self.brought_at.is_some()
    }
}

/// Takes the presses on both views.
pub(super) fn show(
    ui: &egui::Ui,
    scene: &Scene<'_>,
    layout: &Layout,
    pressing: &mut Pressing,
    intents: &mut Intents,
) {
    for (name, help, rect) in
        [("Plate from above", PLATE_HELP, layout.plate), ("Envelope", ENVELOPE_HELP, layout.envelope)]
    {
        let over = layout.axis.over_plate(rect);
        // Not by the keyboard, which moves the line itself.
        let response = ui.interact(over, ui.scope_id().with(name), Sense::CLICK | Sense::DRAG);
        theme::describe(&response, name, help);
        if scene.is_measured_now() {
            pressing.waits = None;
            continue;
        }
        take(ui, &response, scene, layout, pressing, intents);
    }
    let is_down = ui.input(|input| input.pointer.primary_down());
    // A press that has ended without a click is over.
    pressing.waits =
        pressing.waits.filter(|press| scene.grab.is_none() && (is_down || press.ended_s.is_some()));
    let Some(press) = pressing.waits else { return };
    let now_s = ui.input(|input| input.time);
    let patience_s = ui.ctx().options(|options| options.input_options.max_double_click_delay);
    let due_s = press.ended_s.map_or(press.began_s + HELD_S, |ended_s| ended_s + patience_s);
    if press.ended_s.is_some() && now_s >= due_s {
        bring(scene, layout, press.at, pressing, intents);
        return;
    }
    ui.ctx().request_repaint_after(Duration::from_secs_f64((due_s - now_s).max(0.0)));
    mark(ui, scene, layout, press.at);
}

/// Takes the presses on one view.
fn take(
    ui: &egui::Ui,
    response: &Response,
    scene: &Scene<'_>,
    layout: &Layout,
    pressing: &mut Pressing,
    intents: &mut Intents,
) {
    let Some(at) = response.interact_pointer_pos() else { return };
    let (now_s, is_down, has_moved) =
        ui.input(|input| (input.time, input.pointer.primary_down(), input.pointer.is_decidedly_dragging()));
    let (begun, clicked) = match pressing.waits {
        Some(press) if press.ended_s.is_none() => (Some(press), false),
        latest => (None, latest.is_some()),
    };
    // Press and release may come in one frame.
    let press = begun.unwrap_or(Press { at, began_s: now_s, ended_s: None, follows_click: clicked });
    if response.clicked() {
        pressing.waits = None;
        if std::mem::take(&mut pressing.has_taken) {
            return;
        }
        if response.double_clicked() && press.follows_click {
            intents.push(Intent::Edit(Edit::Add { position_m: layout.axis.place_from_screen(at.x) }));
        } else {
            pressing.waits = Some(Press { ended_s: Some(now_s), ..press });
        }
    } else if response.is_pointer_button_down_on() && is_down && scene.grab.is_none() {
        *pressing = Pressing { waits: Some(press), has_taken: false, ..*pressing };
        if has_moved || now_s - press.began_s >= HELD_S {
            bring(scene, layout, at, pressing, intents);
            pressing.has_taken = true;
            let held = Dragged::Tone(scene.selected);
            intents.push(Intent::Grab(Grab { held, axis: layout.axis, offset: 0.0 }));
        }
    }
}

/// Moves the selected tone's line to the pointer, or as near as its span allows.
fn bring(scene: &Scene<'_>, layout: &Layout, at: Pos2, pressing: &mut Pressing, intents: &mut Intents) {
    *pressing = Pressing { brought_at: Some(at), ..Pressing::default() };
    let place_m = layout.axis.place_from_screen(at.x);
    intents.push(Intent::MoveLine { slot: scene.selected, place_m });
}

/// Marks where the line will come.
fn mark(ui: &egui::Ui, scene: &Scene<'_>, layout: &Layout, at: Pos2) {
    let palette = theme::palette(ui);
    let (start_m, end_m) = scene.limits_m;
    let place_m = layout.axis.place_from_screen(at.x).max(start_m).min(end_m);
    let x = layout.axis.line_from_place(place_m);
    let rows = Rangef::new(layout.label.bottom(), layout.strip.bottom());
    let ink = palette.boundary.gamma_multiply(0.7);
    let ends = [pos2(x, rows.min), pos2(x, rows.max)];
    ui.painter().extend(Shape::dashed_line(&ends, Stroke::new(2.0, ink), 5.0, 4.0));
    let knob = Rect::from_center_size(pos2(x, layout.plate.center().y), egui::Vec2::splat(HANDLE));
    ui.painter().circle_stroke(knob.center(), 0.5 * HANDLE, Stroke::new(1.5, ink));
}
