//! The finger's track: a press on the strip of what is felt brings the finger there, and the finger's sound is switched
//! beside it.

use super::fingertip::{self, Look};
use super::layout::Layout;
use crate::intent::{Dragged, Grab, Intent, Intents};
use crate::scene::Scene;
use crate::sound::{self, SoundChoice};
use crate::view::theme::{self, HANDLE};
use eframe::egui::{
    self, Color32, CursorIcon, Pos2, Rect, Response, Sense, Shape, Stroke, UiBuilder, Vec2, pos2, vec2,
};
use slipline_model::field::touch::Touch;
use std::f32::consts::PI;

const MUTE_HELP: &str =
    "The vibration at the finger as a sound: it begins when you move the finger. Illustrative";

/// Takes the presses on the strip.
pub(super) fn show(ui: &egui::Ui, scene: &Scene<'_>, layout: &Layout, intents: &mut Intents) {
    let over = layout.axis.over_plate(layout.strip);
    let response = ui.interact(over, ui.scope_id().with("track"), Sense::CLICK | Sense::DRAG);
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    if let Some(pointer) = pressed(ui, scene, &response) {
        if scene.touch == Touch::None || scene.finger.is_none() {
            intents.push(Intent::Touch(Touch::Ideal));
        }
        intents.push(Intent::MoveFinger(layout.axis.place_from_screen(pointer.x)));
        intents.push(Intent::Grab(Grab { held: Dragged::Finger, axis: layout.axis, offset: 0.0 }));
    }
}

/// Where the pointer has just pressed this.
fn pressed(ui: &egui::Ui, scene: &Scene<'_>, response: &Response) -> Option<Pos2> {
    let is_down = response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_down());
    response.interact_pointer_pos().filter(|_| is_down && scene.grab.is_none())
}

/// The finger's print on its track, and the switch of its sound, while there is a finger.
pub(super) fn finger(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    layout: &Layout,
    look: Look,
    intents: &mut Intents,
) {
    let Some(finger) = scene.finger else { return };
    let x = layout.axis.screen_from_place(finger.place_m);
    let centre = pos2(x, layout.strip.center().y);
    let palette = theme::palette(ui);
    let ends = [pos2(x, layout.plate.bottom()), pos2(x, layout.strip.top())];
    let ink = palette.text.gamma_multiply(0.35);
    ui.painter().extend(Shape::dashed_line(&ends, Stroke::new(1.0, ink), 2.0, 4.0));
    fingertip::print(ui.painter(), palette, centre, look);
    let around = Rect::from_center_size(centre, Vec2::splat(HANDLE));
    let response = ui.interact(around, ui.scope_id().with("print"), Sense::CLICK | Sense::DRAG);
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    if let Some(pointer) = pressed(ui, scene, &response) {
        let offset = pointer.x - x;
        intents.push(Intent::Grab(Grab { held: Dragged::Finger, axis: layout.axis, offset }));
    }
    if sound::IS_THERE {
        mute(ui, scene, layout, intents);
    }
}

/// The switch of the finger's sound, at the end of its track.
fn mute(ui: &mut egui::Ui, scene: &Scene<'_>, layout: &Layout, intents: &mut Intents) {
    let is_on = scene.sound.choice == SoundChoice::Finger;
    let middle = pos2(layout.axis.screen().max + 0.5 * HANDLE + 2.0, layout.strip.center().y);
    let rect = Rect::from_center_size(middle, Vec2::splat(HANDLE));
    let button = egui::Button::selectable(false, "").min_size(rect.size());
    let response =
        ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| ui.add_sized(rect.size(), button)).inner;
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, is_on, "Sound of the finger"));
    let palette = theme::palette(ui);
    speaker(ui.painter(), middle, if is_on { palette.text } else { palette.weak }, is_on);
    if response.on_hover_text(MUTE_HELP).clicked() {
        let next = if is_on { SoundChoice::Off } else { SoundChoice::Finger };
        intents.push(Intent::Sound(next));
    }
}

/// A loudspeaker, with its sound or struck out.
fn speaker(painter: &egui::Painter, centre: Pos2, ink: Color32, is_on: bool) {
    let stroke = Stroke::new(1.5, ink);
    let at = |x: f32, y: f32| centre + vec2(x, y);
    let body = [(-8.0, -2.5), (-5.0, -2.5), (-1.0, -6.0), (-1.0, 6.0), (-5.0, 2.5), (-8.0, 2.5)];
    painter.add(Shape::closed_line(body.map(|(x, y)| at(x, y)).to_vec(), stroke));
    if is_on {
        for radius in [4.0, 7.5] {
            let arc = |i: usize| {
                let angle = PI * (i as f32 / 8.0 - 0.5) * 0.55;
                at(1.0, 0.0) + radius * vec2(angle.cos(), angle.sin())
            };
            painter.add(Shape::line((0..=8).map(arc).collect(), stroke));
        }
    } else {
        painter.line_segment([at(3.0, -3.5), at(9.0, 3.5)], stroke);
        painter.line_segment([at(3.0, 3.5), at(9.0, -3.5)], stroke);
    }
}
