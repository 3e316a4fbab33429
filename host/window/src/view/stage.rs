//! The stage: plate, envelope and strip over one x axis, and the boundary line through all three.

use super::designer::sketch;
use super::light_marks::LightMarks;
use super::{Scene, ViewState, envelope, felt_strip, finger, handle, plate, read_out, theme};
use crate::axis::Axis;
use crate::intent::{Grab, Held, Intent, Intents};
use eframe::egui::{
    self, Align2, Color32, CornerRadius, CursorIcon, FontId, Galley, Key, Pos2, Rangef, Rect, Sense, Stroke,
    Vec2, pos2, vec2,
};
use slipline_model::field::line::{Holds, Line};
use slipline_model::setup::edit::Edit;
use slipline_plate::quantity::{show_frequency, show_place};
use std::sync::Arc;
use theme::HANDLE;

/// Space left of the plate for the envelope's scale, and right of it for the last label, in points.
const MARGIN: (f32, f32) = (58.0, 22.0);
const TITLE: f32 = 26.0;
const LABEL: f32 = 26.0;
const STRIP: f32 = 30.0;
const SCALE: f32 = 34.0;
const GAP: f32 = 8.0;
/// A stage lower than this, in points, has no title.
const LOW: f32 = 225.0;

/// The rectangles of the three views.
struct Layout {
    axis: Axis,
    title: Rect,
    /// For the hint, where it has no room beside the flag.
    hint: Rect,
    label: Rect,
    plate: Rect,
    envelope: Rect,
    strip: Rect,
    scale: Rect,
}

impl Layout {
    fn new(area: Rect, axis: Axis, half_width_m: f64, pixels_per_point: f32, hint_height: f32) -> Self {
        let row = |top: f32, height: f32| {
            let top = (top * pixels_per_point).round() / pixels_per_point;
            let bottom = ((top + height) * pixels_per_point).round() / pixels_per_point;
            Rect::from_min_max(pos2(area.left(), top), pos2(area.right(), bottom))
        };
        // The lowest stage, beside the plots in the smallest window, has no line above the plate.
        let title_height = if area.height() < LOW { 0.0 } else { TITLE };
        let title = row(area.top(), title_height);
        let hint = row(title.bottom(), hint_height);
        let label = row(hint.bottom(), LABEL);
        // In a window that is too low, the views overlap at their ends but stay in order.
        let free = (area.height() - title_height - hint_height - LABEL - STRIP - SCALE - 2.0 * GAP).max(0.0);
        // The plate gets what it needs at scale; the envelope gets the rest.
        let wanted = 2.0 * half_width_m as f32 * axis.points_per_m() + 12.0;
        let plate = row(label.bottom(), wanted.clamp(0.35 * free, 0.7 * free).max(40.0));
        let envelope = row(plate.bottom() + GAP, (free - plate.height()).max(40.0));
        let strip = row(envelope.bottom() + GAP, STRIP);
        let scale = row(strip.bottom(), SCALE);
        Self { axis, title, hint, label, plate, envelope, strip, scale }
    }
}

/// Shows the stage in the whole of `ui`.
pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let area = ui.available_rect_before_wrap();
    let plate = &scene.setup.plate;
    let range = Rangef::new(area.left() + MARGIN.0, area.right() - MARGIN.1);
    let density = ui.pixels_per_point();
    let axis = Axis::new(plate.length_m(), range, density);
    let hint = Hint::of(ui, scene, &axis, area.x_range());
    let needs_row = hint.as_ref().is_some_and(|hint| hint.is_apart);
    let hint_height = if needs_row { LABEL + 2.0 } else { 0.0 };
    let layout = Layout::new(area, axis, plate.half_width_m(0.0), density, hint_height);
    if layout.title.height() > 0.0 {
        ui.scope_builder(egui::UiBuilder::new().max_rect(layout.title), |ui| {
            plate::title(ui, scene, view, intents);
        });
    }
    grid(ui, scene, &layout);
    plate::show(ui, scene, &layout.axis, layout.plate);
    if view.is_designing() && scene.settings.show_panel {
        sketch::show(ui, scene, view, &layout.axis, layout.plate);
    }
    envelope::show(ui, scene, &layout.axis, layout.envelope);
    felt_strip::show(ui, scene, &layout.axis, layout.strip);
    place_scale(ui, scene, &layout);
    let drawn = Rect::from_x_y_ranges(layout.axis.screen(), layout.plate.top()..=layout.envelope.bottom());
    let marks =
        LightMarks::show(ui, scene, view, &layout.axis, area.x_range(), (drawn, layout.envelope.top()));
    // The selected tone comes last, so that it is drawn on top and gets the pointer first.
    let mut order: Vec<u8> = scene.setup.tones.iter().map(|tone| tone.slot).collect();
    order.sort_by_key(|&slot| slot == scene.selected);
    for slot in order {
        handle(ui, scene, &layout, slot, view, intents);
    }
    finger::handle(ui, scene, &layout.axis, layout.plate, view, intents);
    if let Some(hint) = hint {
        hint.show(ui, &layout);
    }
    envelope::legend(ui, scene, &layout.axis, layout.envelope);
    add_by_double_click(ui, scene, &layout, intents);
    let views = Rect::from_x_y_ranges(layout.axis.screen(), layout.plate.top()..=layout.strip.bottom());
    // What a symbol says takes the read-out's place.
    if !marks.interact(ui, view, intents) {
        read_out::show(ui, scene, &layout.axis, views);
    }
}

/// Faint lines at the same places in all views.
fn grid(ui: &egui::Ui, scene: &Scene<'_>, layout: &Layout) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let over = layout.axis.over_plate(layout.envelope);
    painter.rect_filled(over, CornerRadius::same(3), palette.well);
    for beyond in layout.axis.beyond(scene.limits_m) {
        painter.rect_filled(Rect::from_x_y_ranges(beyond, over.y_range()), 0.0, palette.beyond());
    }
    for x_mm in layout.axis.ticks_mm(90.0).places {
        let x = layout.axis.line_from_place(x_mm * 1e-3);
        painter.vline(x, layout.envelope.y_range(), Stroke::new(1.0, palette.grid));
    }
}

fn place_scale(ui: &egui::Ui, scene: &Scene<'_>, layout: &Layout) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let font = FontId::proportional(11.5);
    let top = layout.scale.top() + 3.0;
    painter.hline(layout.axis.screen(), top, Stroke::new(1.0, palette.line));
    // Where the selected line can be.
    let (start, end) = scene.limits_m;
    let span = Rangef::new(layout.axis.screen_from_place(start), layout.axis.screen_from_place(end));
    painter.hline(span, top, Stroke::new(2.0, palette.weak));
    let ticks = layout.axis.ticks_mm(90.0);
    for &x_mm in &ticks.places {
        let x = layout.axis.line_from_place(x_mm * 1e-3);
        painter.vline(x, Rangef::new(top, top + 4.0), Stroke::new(1.0, palette.weak));
        let place = pos2(x, top + 6.0);
        painter.text(place, Align2::CENTER_TOP, ticks.label(x_mm), font.clone(), palette.weak);
    }
    let unit = pos2(layout.axis.screen().min - 10.0, top + 6.0);
    painter.text(unit, Align2::RIGHT_TOP, "x, mm", font, palette.weak);
    felt_strip::legend(ui, scene, &layout.axis, layout.scale.bottom() + 2.0);
}

/// The text of the hint, in the longest form that fits.
const HINTS: [&str; 2] = ["Drag the line: it moves the boundary", "Drag the line"];
/// Space around the text of a flag or hint, in points.
const INSET: Vec2 = vec2(10.0, 3.0);

/// The hint of a first start: beside the flag of the line if it has room there, else in a row of its own. It covers
/// nothing.
struct Hint {
    galley: Arc<Galley>,
    /// Its left end, in points.
    left: f32,
    /// Whether it needs a row of its own.
    is_apart: bool,
}

impl Hint {
    fn of(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, row: Rangef) -> Option<Self> {
        let line = scene.line(scene.selected).filter(|_| !scene.settings.has_dragged)?;
        let flag = flag_of(scene, line, false)?;
        let flag = Flag::of(ui, row, axis.line_from_place(line.place_m), flag).extent;
        let ink = theme::palette(ui).text;
        let text = |text: &str| ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(13.5), ink);
        let width = |galley: &Arc<Galley>| galley.size().x + 2.0 * INSET.x;
        for galley in HINTS.map(text) {
            // Towards the narrow end of the plate if it fits there, else on the other side.
            for left in [flag.max + GAP, flag.min - GAP - width(&galley)] {
                if left >= row.min && left + width(&galley) <= row.max {
                    return Some(Self { galley, left, is_apart: false });
                }
            }
        }
        let galley = HINTS.map(text).into_iter().find(|galley| width(galley) <= row.span())?;
        let left = flag.center() - 0.5 * width(&galley);
        let left = left.min(row.max - width(&galley)).max(row.min);
        Some(Self { galley, left, is_apart: true })
    }

    fn show(self, ui: &egui::Ui, layout: &Layout) {
        let palette = theme::palette(ui);
        let size = self.galley.size() + 2.0 * INSET;
        let row = if self.is_apart { layout.hint.bottom() - 4.0 } else { layout.label.bottom() };
        let rect = Rect::from_min_size(pos2(self.left, row - size.y), size);
        let stroke = Stroke::new(1.0, palette.accent);
        let painter = ui.painter();
        painter.rect(rect, CornerRadius::same(5), palette.panel, stroke, egui::StrokeKind::Inside);
        painter.galley(rect.min + INSET, self.galley, palette.text);
        let seen = ui.interact(rect, ui.scope_id().with("hint"), Sense::hover());
        seen.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, HINTS[1]));
        seen.on_hover_text("It is shown until a line has been dragged for the first time");
    }
}

/// The accessible name of a tone's handle.
pub(super) fn handle_name(scene: &Scene<'_>, slot: u8) -> String {
    if scene.setup.tones.first().is_some_and(|first| first.slot == slot) {
        "Boundary".to_owned()
    } else {
        format!("Peak of tone {}", slot + 1)
    }
}

fn handle(
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
    let rows = Rangef::new(layout.label.top(), layout.strip.bottom());
    let id = ui.scope_id().with(("handle", slot));
    let response = ui
        .interact(Rect::from_x_y_ranges(column, rows), id, Sense::click_and_drag())
        .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    let is_held = scene.grab.is_some_and(|grab| grab.held == Held::Tone(slot));
    let name = handle_name(scene, slot);
    response.widget_info(|| egui::WidgetInfo::slider(true, line.place_m * 1e3, &name));
    let response = response.on_hover_text(LINE_HELP);
    if response.is_pointer_button_down_on()
        && !is_held
        && let Some(pointer) = response.interact_pointer_pos()
    {
        response.request_focus();
        intents.push(Intent::Select(slot));
        intents.push(Intent::Grab(Grab { held: Held::Tone(slot), axis: layout.axis, offset: pointer.x - x }));
    }
    if response.has_focus() {
        // Left and right move the boundary instead of the focus.
        let filter = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        view.focused_handle = Some(id);
        if !is_selected {
            intents.push(Intent::Select(slot));
        }
    }
    if let Some(place_m) = handle::by_assistive_technology(ui, id, line.place_m) {
        intents.push(Intent::MoveLine { slot, place_m });
    }
    let look = Look { is_selected, is_hot: response.hovered() || is_held, has_focus: response.has_focus() };
    paint_line(ui, layout, x, look);
    if is_selected {
        if let Some(text) = flag_of(scene, line, is_held || response.has_focus()) {
            Flag::of(ui, layout.label.x_range(), x, text).show(ui, layout.label);
        }
    } else {
        let palette = theme::palette(ui);
        let place = pos2(x, layout.plate.center().y);
        let number = (slot + 1).to_string();
        ui.painter().text(place, Align2::CENTER_CENTER, number, FontId::proportional(11.5), palette.text);
    }
}

const LINE_HELP: &str = "Drag it along the plate, or press the arrow keys: 1 mm, with Shift 0.1 mm. Its tone is selected and sounds at once";
const FLAG_HELP: &str = "Where the line is, the frequency of its tone, and how far it is from the peak to a tenth of it, or \
    why there is no edge";

/// The words of the flag on the selected line: its place, its frequency, and how wide the edge is or why there is none.
fn flag(line: &Line, frequency_hz: f64, edge_m: f64) -> String {
    let (place, frequency) = (show_place(line.place_m), show_frequency(frequency_hz));
    match line.holds {
        Holds::FeltEdge | Holds::TurningPoint => {
            format!("{place}   {frequency}   edge {:.0} mm", edge_m * 1e3)
        }
        Holds::PlateEnd => format!("felt to the plate's end   {frequency}"),
        Holds::Unfelt(why) => format!("{place}   {frequency}   {}", why.words()),
    }
}

/// The words of the flag on a line; `is_held` adds where the span ends.
fn flag_of(scene: &Scene<'_>, line: &Line, is_held: bool) -> Option<String> {
    let plate = &scene.setup.plate;
    let position_m = scene.setup.tone(line.slot)?.position_m;
    let frequency_hz = plate.frequency_for_boundary_hz(position_m);
    let mut words = flag(line, frequency_hz, plate.edge_width_m(frequency_hz).unwrap_or(f64::NAN));
    if is_held {
        words.push_str(end_of_span(plate.span_m(), position_m));
    }
    Some(words)
}

/// The note after the place of a boundary that is at a limit.
fn end_of_span((start, end): (f64, f64), position_m: f64) -> &'static str {
    match position_m {
        x_m if x_m <= start => "   the span begins here",
        x_m if x_m >= end => "   the span ends here",
        _ => "",
    }
}

#[derive(Clone, Copy)]
struct Look {
    is_selected: bool,
    is_hot: bool,
    has_focus: bool,
}

fn paint_line(ui: &egui::Ui, layout: &Layout, x: f32, look: Look) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let rows = Rangef::new(layout.label.bottom(), layout.strip.bottom());
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

/// The flag at the top of the selected line.
struct Flag {
    galley: Arc<Galley>,
    /// Its left and right end, in points.
    extent: Rangef,
}

impl Flag {
    /// The flag with this text on a line at `x`. If it does not fit in the row, its left end stays visible.
    fn of(ui: &egui::Ui, row: Rangef, x: f32, text: String) -> Self {
        let palette = theme::palette(ui);
        let ink = if palette.dark { palette.page } else { palette.well };
        let galley = ui.painter().layout_no_wrap(text, FontId::proportional(13.5), ink);
        let width = galley.size().x + 2.0 * INSET.x;
        let left = (x - 0.5 * width).min(row.max - width).max(row.min);
        Self { galley, extent: Rangef::new(left, left + width) }
    }

    fn show(self, ui: &egui::Ui, row: Rect) {
        let palette = theme::palette(ui);
        let top = row.bottom() - self.galley.size().y - 2.0 * INSET.y;
        let rect = Rect::from_x_y_ranges(self.extent, top..=row.bottom());
        ui.painter().rect_filled(rect, CornerRadius::same(5), palette.boundary);
        ui.painter().galley(rect.min + INSET, Arc::clone(&self.galley), palette.text);
        let seen = ui.interact(rect, ui.scope_id().with("flag"), Sense::hover());
        let said = format!("Flag: {}", self.galley.text());
        seen.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
        seen.on_hover_text(FLAG_HELP);
    }
}

/// The read-out of the place is there for the pointer, so this is for those who do not see it.
const PLATE_HELP: &str =
    "The plate and its wave, the driven end at the left. A double click adds a tone at that place";

fn add_by_double_click(ui: &egui::Ui, scene: &Scene<'_>, layout: &Layout, intents: &mut Intents) {
    let response = ui.interact(layout.plate, ui.scope_id().with("plate"), Sense::hover());
    theme::describe(&response, "Plate from above", PLATE_HELP);
    let is_double = ui.input(|input| input.pointer.button_double_clicked(egui::PointerButton::Primary));
    let Some(pointer) = response.hover_pos() else { return };
    let near_handle = scene
        .lines
        .iter()
        .any(|line| (layout.axis.screen_from_place(line.place_m) - pointer.x).abs() < HANDLE);
    if is_double && !near_handle {
        intents.push(Intent::Edit(Edit::Add { position_m: layout.axis.place_from_screen(pointer.x) }));
    }
}

/// The step of a key press: 1 mm, or 0.1 mm with Shift.
pub(crate) fn arrow_step_m(input: &mut egui::InputState) -> f64 {
    let mut step = 0.0;
    // Shift is tested first, because a test without modifiers also matches a key with Shift.
    for (modifiers, size) in [(egui::Modifiers::SHIFT, 1e-4), (egui::Modifiers::NONE, 1e-3)] {
        step += size * input.count_and_consume_key(modifiers, Key::ArrowRight) as f64;
        step -= size * input.count_and_consume_key(modifiers, Key::ArrowLeft) as f64;
    }
    step
}
