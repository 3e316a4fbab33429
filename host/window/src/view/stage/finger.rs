//! The finger on the plate: its choice, and its handle on the stage.

use crate::axis::Axis;
use crate::caption::Panel;
use crate::intent::{Dragged, Grab, Intent, Intents};
use crate::scene::Scene;
use crate::view::stage::handle;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, CornerRadius, CursorIcon, Rect, RichText, Sense, Stroke, StrokeKind, pos2, vec2};
use slipline_model::field::felt::Zone;
use slipline_model::field::touch::{Touch, refusal};
use slipline_plate::RespondError;
use slipline_plate::quantity::show_place;
use theme::HANDLE;

const CHOICES: [(Touch, &str, &str); 3] = [
    (Touch::None, "None", "The plate without a finger"),
    (Touch::Light, "Light", "A finger that strokes: 0.1 N s/m and 0.01 g. Illustrative"),
    (Touch::Firm, "Firm", "A finger that presses: 1 N s/m and 0.1 g. Illustrative"),
];

const HANDLE_HELP: &str =
    "Drag it along the plate, or press the arrow keys: what it meets is drawn below as its trace";

/// The choice of a finger, and where it is.
pub(crate) fn choice(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let refusal = refusal(&scene.setup.plate).map(|error| match error {
        RespondError::Unstated(error) => error.worded(&Panel::Plate),
        other => other.to_string(),
    });
    let is_chosen = |touch| if refusal.is_some() { touch == Touch::None } else { touch == scene.touch };
    // One row: in a window of the usual height it is the last that is seen without scrolling.
    ui.horizontal(|ui| {
        theme::heading(ui, "Finger");
        for (touch, name, help) in CHOICES {
            let radio = ui.add_enabled(refusal.is_none(), egui::RadioButton::new(is_chosen(touch), name));
            let radio = radio.on_disabled_hover_text(refusal.as_deref().unwrap_or_default());
            if radio.on_hover_text(help).clicked() {
                intents.push(Intent::Touch(touch));
            }
        }
    });
    let text = match (&refusal, scene.finger) {
        (Some(reason), _) => reason.clone(),
        (None, Some(finger)) => {
            format!(
                "At {}: {}. Drag it along the plate. Wave and envelope are those with it; drive, boundary line and strip \
                 stay those of the plate without it.",
                show_place(finger.place_m),
                scene.felt.map_or("not known yet", |felt| Zone::of(felt.at(finger.place_m)).name())
            )
        }
        (None, None) => return,
    };
    ui.add(egui::Label::new(RichText::new(text).small().color(palette.weak)).wrap());
}

/// The finger on the plate in `rect`, with a handle for pointer and keys.
pub(crate) fn handle(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    axis: &Axis,
    rect: Rect,
    view: &mut ViewState,
    intents: &mut Intents,
) {
    let Some(finger) = scene.finger else { return };
    let x = axis.screen_from_place(finger.place_m);
    let contact = finger.contact_m as f32 * axis.points_per_m();
    let centre = pos2(x, rect.center().y);
    let id = ui.scope_id().with("finger");
    let size = contact.max(HANDLE);
    let response = ui
        .interact(Rect::from_center_size(centre, vec2(size, size)), id, Sense::click_and_drag())
        .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    response.widget_info(|| egui::WidgetInfo::slider(true, finger.place_m * 1e3, "Finger"));
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
        let filter = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        view.focused_finger = Some(id);
    }
    if let Some(place_m) = handle::by_assistive_technology(ui, id, finger.place_m) {
        intents.push(Intent::MoveFinger(place_m));
    }
    paint(ui, rect, centre, contact, response.hovered() || is_held, response.has_focus());
}

/// The fingertip: the contact, and the finger that comes to it from the near edge of the plate.
fn paint(ui: &egui::Ui, rect: Rect, centre: egui::Pos2, contact: f32, is_hot: bool, has_focus: bool) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(rect.expand(4.0));
    let half = 0.5 * contact.max(12.0);
    let ink = if has_focus { palette.accent } else { palette.text };
    let width = if is_hot || has_focus { 2.5 } else { 1.5 };
    let body = Rect::from_min_max(centre - vec2(half, half), pos2(centre.x + half, rect.bottom()));
    let radius = CornerRadius { nw: half as u8, ne: half as u8, sw: 0, se: 0 };
    let fill = palette.panel.gamma_multiply(0.55);
    painter.rect(body, radius, fill, Stroke::new(width, ink), StrokeKind::Middle);
    let square = Rect::from_center_size(centre, vec2(contact, contact));
    painter.rect_stroke(square, 2.0, Stroke::new(1.0, ink), StrokeKind::Inside);
}
