//! The finger on the plate: its choice, and its handle on the stage.

use crate::caption::Panel;
use crate::intent::{Asks as _, Dragged, Grab, Intent, Intents};
use crate::scene::Scene;
use crate::view::bars::tour;
use crate::view::fields::lines::lines;
use crate::view::stage::fingertip::{self, Look};
use crate::view::stage::layout::Layout;
use crate::view::stage::{felt_strip, handle, track};
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Color32, CursorIcon, Rect, Sense, pos2, vec2};
use slipline_instrument::TourStep;
use slipline_model::field::felt::Zone;
use slipline_model::field::touch::{Touch, refusal};
use slipline_plate::RespondError;
use slipline_plate::quantity::show_place;
use theme::HANDLE;

const CHOICES: [(Touch, &str, &str); 4] = [
    (Touch::None, "None", "The plate without a finger"),
    (Touch::Ideal, "Ideal", "A finger that feels but absorbs nothing: the plate moves as without it"),
    (Touch::Light, "Light", "A finger that strokes: 0.1 N s/m and 0.01 g. Illustrative"),
    (Touch::Firm, "Firm", "A finger that presses: 1 N s/m and 0.1 g. Illustrative"),
];

const HANDLE_HELP: &str =
    "Drag it along the plate, or press the arrow keys: what it meets is drawn below as its trace";

/// The choice of a finger, and where it is.
pub(crate) fn choice(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let refusal = refusal(&scene.setup.plate).map(|error| {
        if let RespondError::Unstated(error) = &error {
            error.worded(&Panel::Plate)
        } else {
            error.to_string()
        }
    });
    let present = scene.finger.map_or(Touch::None, |_| scene.touch);
    // One row: in a window of the usual height it is the last that is seen without scrolling.
    ui.horizontal(|ui| {
        theme::heading(ui, "Finger");
        for (touch, name, help) in CHOICES {
            let is_enabled = refusal.is_none() || !touch.loads();
            let radio = ui.add_enabled(is_enabled, egui::RadioButton::new(touch == present, name));
            let radio = radio.on_disabled_hover_text(refusal.as_deref().unwrap_or_default());
            radio.on_hover_text(help).asks(intents, Intent::Touch(touch));
        }
    });
    let text = match (&refusal, scene.finger) {
        (Some(reason), None) => reason.clone(),
        (_, Some(finger)) => {
            let meets = scene.felt.map_or("not known yet", |felt| Zone::of(felt.at(finger.place_m)).name());
            let other = if scene.load.is_some() {
                "Wave and envelope are those with it; drive, boundary line and strip stay those of the plate without it."
            } else {
                "Drag it along the plate."
            };
            format!("At {}: {meets}. {other}", show_place(finger.place_m))
        }
        (None, None) => String::new(),
    };
    // As high with a finger as without one, so that what is under it keeps its place.
    lines(ui, text, palette.weak, 1);
}

/// The finger on the plate, with a handle for pointer and keys, and its print on the track.
pub(super) fn handle(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    layout: &Layout,
    view: &mut ViewState,
    intents: &mut Intents,
) {
    let Some(finger) = scene.finger else { return };
    let (axis, rect) = (&layout.axis, layout.plate);
    let x = axis.screen_from_place(finger.place_m);
    let contact = finger.contact_m as f32 * axis.points_per_m();
    let centre = pos2(x, rect.center().y);
    let id = ui.scope_id().with("finger");
    let size = contact.max(HANDLE);
    let response = ui
        .interact(Rect::from_center_size(centre, vec2(size, size)), id, Sense::click_and_drag())
        .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    response.widget_info(|| egui::WidgetInfo::slider(true, finger.place_m * 1e3, "Finger"));
    tour::mark(ui, scene, TourStep::Finger, response.rect);
    let response = response.on_hover_text(HANDLE_HELP);
    let is_held = scene.grab.is_some_and(|grab| grab.held == Dragged::Finger);
    if response.is_pointer_button_down_on()
        && !is_held
        && let Some(pointer) = response.interact_pointer_pos()
    {
        response.request_focus();
        intents.push(Intent::Grab(Grab { held: Dragged::Finger, axis: *axis, offset: pointer.x - x }));
    }
    if response.has_focus() {
        theme::keep_arrows(ui, id);
        view.focused_finger = Some(id);
    }
    intents.extend(handle::by_assistive_technology(ui, id, finger.place_m).map(Intent::MoveFinger));
    let felt = scene.felt.filter(|_| scene.sounding.is_some());
    let zone = felt.map_or(Zone::Not, |felt| Zone::of(felt.at(finger.place_m)));
    let look = Look {
        feels: if zone == Zone::Not {
            Color32::TRANSPARENT
        } else {
            felt_strip::colour(zone, theme::palette(ui))
        },
        is_hot: response.hovered() || is_held,
        has_focus: response.has_focus(),
    };
    let painter = ui.painter().with_clip_rect(rect.expand(4.0));
    fingertip::finger(&painter, theme::palette(ui), rect, (centre, contact), look);
    track::finger(ui, scene, layout, look, intents);
}
