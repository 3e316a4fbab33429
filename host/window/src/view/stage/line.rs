//! The line of a tone through plate, envelope and strip: what is dragged, by pointer, keys or assistive technology.

use super::flag::{Flag, flag_of};
use super::handle;
use super::layout::Layout;
use crate::intent::{Dragged, Grab, Intent, Intents};
use crate::scene::Scene;
use crate::view::bars::tour;
use crate::view::state::{Tab, ViewState};
use crate::view::theme::{self, HANDLE};
use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, Pos2, Rangef, Rect, Sense, Stroke, pos2, vec2,
};
use slipline_instrument::TourStep;
use slipline_plate::quantity::show_place;

/// The accessible name of a tone's handle.
pub(crate) fn handle_name(scene: &Scene<'_>, slot: u8) -> String {
    if scene.setup.tones.first().is_some_and(|first| first.slot == slot) {
        "Boundary".to_owned()
    } else {
        format!("Peak of tone {}", slot + 1)
    }
}

pub(super) fn show(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    layout: &Layout,
    slot: u8,
    view: &mut ViewState,
    intents: &mut Intents,
) {
    let Some(line) = scene.line(slot) else { return };
    let x = layout.axis.line_from_place(line.place_m);
    let is_selected = slot == scene.selected;
    let column = Rangef::new(x - 0.5 * HANDLE, x + 0.5 * HANDLE);
    let form = Form::of(scene, view.tab == Tab::Texture, is_selected);
    let rows = form.rows(layout);
    let id = ui.scope_id().with(("handle", slot));
    let is_locked = scene.is_measured_now();
    let response = ui.interact(Rect::from_x_y_ranges(column, rows), id, Sense::click_and_drag());
    let response = response.on_hover_and_drag_cursor(if is_locked {
        CursorIcon::NotAllowed
    } else {
        CursorIcon::ResizeHorizontal
    });
    let is_held = scene.grab.is_some_and(|grab| grab.held == Dragged::Tone(slot));
    let name = handle_name(scene, slot);
    response.widget_info(|| egui::WidgetInfo::slider(true, line.place_m * 1e3, &name));
    ui.ctx().accesskit_node_builder(id, |node| node.set_description(LINE_HELP));
    if response.is_pointer_button_down_on()
        && !is_held
        && let Some(pointer) = response.interact_pointer_pos()
    {
        response.request_focus();
        intents.push(Intent::Select(slot));
        if !is_locked {
            let offset = pointer.x - x;
            intents.push(Intent::Grab(Grab { held: Dragged::Tone(slot), axis: layout.axis, offset }));
        }
    }
    if is_selected && std::mem::take(&mut view.begins_by_tab) {
        response.request_focus();
    }
    if response.has_focus() {
        theme::keep_arrows(ui, id);
        view.focused_handle = Some(id);
        if !is_selected {
            intents.push(Intent::Select(slot));
        }
    }
    if let Some(place_m) = handle::by_assistive_technology(ui, id, line.place_m) {
        intents.push(Intent::MoveLine { slot, place_m });
    }
    let look = Look { is_selected, is_hot: response.hovered() || is_held, has_focus: response.has_focus() };
    if form == Form::Tick {
        response.on_hover_text(format!(
            "Tone {}: {}. Drag it, or press it to select it",
            slot + 1,
            show_place(line.place_m)
        ));
        return paint_tick(ui, layout, x, look);
    }
    knob_help(ui, id, pos2(x, layout.plate.center().y), response.is_pointer_button_down_on(), view);
    paint_line(ui, layout, x, look, form);
    if is_selected {
        let knob = Rect::from_center_size(pos2(x, layout.plate.center().y), egui::Vec2::splat(HANDLE + 4.0));
        tour::mark(ui, scene, TourStep::Line, knob);
        if let Some(forms) = flag_of(scene, line, is_held || response.has_focus()) {
            Flag::of(ui, layout.label.x_range(), x, forms).show(ui, layout.label);
        }
    } else {
        let palette = theme::palette(ui);
        let place = pos2(x, layout.plate.center().y);
        let number = (slot + 1).to_string();
        ui.painter().text(place, Align2::CENTER_CENTER, number, FontId::proportional(11.5), palette.text);
    }
}

const LINE_HELP: &str = "Drag it along the plate, or press the arrow keys: 1 mm, with Shift 0.1 mm. Its tone is selected and sounds at once";

/// Says at the knob what the line is for: not along the line, where it would cover what is read there, and after a press
/// only once the pointer has left the knob.
fn knob_help(ui: &egui::Ui, line: egui::Id, at: Pos2, is_pressed: bool, view: &mut ViewState) {
    let rect = Rect::from_center_size(at, egui::Vec2::splat(HANDLE + 4.0));
    let knob = ui.interact(rect, line.with("knob"), Sense::hover());
    if is_pressed {
        view.pressed_knob = Some(line);
    } else if view.pressed_knob == Some(line) && !knob.contains_pointer() {
        view.pressed_knob = None;
    }
    let pointer = ui.input(|input| input.pointer.latest_pos());
    if view.pressed_knob.is_none() && !view.pressing.has_brought(pointer) {
        knob.on_hover_text(LINE_HELP);
    }
}

/// From so many tones on they make one texture: lines through all of them would hide its area. On the page Texture two do.
const TEXTURE_FROM: usize = 4;
const TEXTURE_FROM_ON_ITS_PAGE: usize = 2;

/// How a tone is shown.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// A line through plate, envelope and strip.
    Line,
    /// The selected line of a texture: the strip stays as it is felt.
    Short,
    /// A tick on the axis: another tone of a texture.
    Tick,
}

impl Form {
    fn of(scene: &Scene<'_>, is_texture_open: bool, is_selected: bool) -> Self {
        let from = if is_texture_open { TEXTURE_FROM_ON_ITS_PAGE } else { TEXTURE_FROM };
        match (scene.setup.tones.len() >= from, is_selected) {
            (false, _) => Self::Line,
            (true, true) => Self::Short,
            (true, false) => Self::Tick,
        }
    }

    /// Where it is taken.
    fn rows(self, layout: &Layout) -> Rangef {
        match self {
            Self::Line => Rangef::new(layout.label.top(), layout.strip.bottom()),
            Self::Short => Rangef::new(layout.label.top(), layout.envelope.bottom()),
            Self::Tick => Rangef::new(layout.scale.top(), layout.scale.top() + HANDLE),
        }
    }
}

/// A tone of a texture on the axis.
fn paint_tick(ui: &egui::Ui, layout: &Layout, x: f32, look: Look) {
    let palette = theme::palette(ui);
    let ink = if look.is_hot { palette.boundary } else { palette.text };
    let rows = Rangef::new(layout.scale.top() - 1.0, layout.scale.top() + 8.0);
    ui.painter().vline(x, rows, Stroke::new(2.0, ink));
    if look.has_focus {
        ui.painter().circle_stroke(pos2(x, rows.center()), 8.0, Stroke::new(2.0, palette.accent));
    }
}

#[derive(Clone, Copy)]
struct Look {
    is_selected: bool,
    is_hot: bool,
    has_focus: bool,
}

fn paint_line(ui: &egui::Ui, layout: &Layout, x: f32, look: Look, form: Form) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let rows = Rangef::new(layout.label.bottom(), form.rows(layout).max);
    let ink = if look.is_selected { palette.boundary } else { palette.weak };
    let halo = if palette.dark { Color32::from_black_alpha(150) } else { Color32::from_white_alpha(190) };
    let width = if look.is_selected { 2.0 } else { 1.0 };
    painter.vline(x, rows, Stroke::new(width + 3.0, halo));
    painter.vline(x, rows, Stroke::new(width, ink));
    let centre = pos2(x, layout.plate.center().y);
    let radius = if look.is_selected { 0.5 * HANDLE + 1.0 } else { 9.0 };
    let radius = if look.is_hot { radius + 1.5 } else { radius };
    painter.circle(centre, radius, palette.panel, Stroke::new(width, ink));
    if look.is_selected {
        for side in [-1.0f32, 1.0] {
            let tip: Pos2 = centre + vec2(side * 8.0, 0.0);
            let back = side * -4.0;
            let points = vec![tip + vec2(back, -4.5), tip, tip + vec2(back, 4.5)];
            painter.line(points, Stroke::new(1.8, ink));
        }
    }
    if look.has_focus {
        painter.circle_stroke(centre, radius + 3.0, Stroke::new(2.0, palette.accent));
    }
}
