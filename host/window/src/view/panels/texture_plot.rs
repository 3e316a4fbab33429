//! The plot of the texture page: what is wanted over the plate, what the tones make of it, and what any number of tones
//! could. A wanted amplitude is drawn here by its breakpoints, a wanted place by its line.

use crate::axis::Axis;
use crate::scene::TextureScene;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{
    self, Align2, CursorIcon, FontId, Id, Key, Pos2, Rangef, Rect, Sense, Shape, Stroke, pos2, vec2,
};
use slipline_model::texture::{BREAKPOINTS_DRAWN_MAX, Lack, WishDraft, WishKind};
use slipline_plate::quantity::show_place;
use theme::{HANDLE, Palette};

/// Height of the plot, in points.
const HEIGHT: f32 = 150.0;
/// Room under it for the places.
const PLACES: f32 = 18.0;
/// The top of the axis over the largest wanted amplitude: what the tones make may be higher, and a note has room over it.
const TOP: f64 = 1.45;
/// The steps of the arrow keys: places in metres, and amplitudes.
const STEP: (f64, f64) = (1e-3, 0.02);

/// The transform between places and amplitudes, which are 1 at the largest wanted, and the screen.
struct Plot {
    axis: Axis,
    rect: Rect,
}

impl Plot {
    fn screen(&self, (place_m, amplitude): (f64, f64)) -> Pos2 {
        let share = (amplitude / TOP).clamp(0.0, 1.0) as f32;
        pos2(self.axis.screen_from_place(place_m), self.rect.bottom() - share * self.rect.height())
    }

    fn value(&self, at: Pos2) -> (f64, f64) {
        let share = (self.rect.bottom() - at.y) / self.rect.height();
        (self.axis.place_from_screen(at.x), TOP * f64::from(share))
    }

    /// A curve of values uniform over the plate.
    fn curve(&self, values: impl ExactSizeIterator<Item = f64>) -> Vec<Pos2> {
        let last = values.len().saturating_sub(1).max(1) as f64;
        let place = |i: usize| i as f64 / last * self.axis.length_m();
        values.enumerate().map(|(i, value)| self.screen((place(i), value))).collect()
    }
}

const HELP: &str =
    "What is wanted at each place, what the tones make of it, and what any number of tones could";

/// Shows the plot; returns the changed draft, if the user changed it.
pub(crate) fn show(
    ui: &mut egui::Ui,
    texture: &TextureScene<'_>,
    length_m: f64,
    view: &mut ViewState,
) -> Option<WishDraft> {
    let size = vec2(ui.available_width(), HEIGHT + PLACES);
    let (whole, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let rect = Rect::from_min_max(whole.min + vec2(8.0, 4.0), whole.max - vec2(8.0, PLACES));
    let axis = Axis::new(length_m, rect.x_range(), ui.pixels_per_point());
    let plot = Plot { axis, rect };
    theme::describe(&response, "Texture over the plate", HELP);
    ground(ui, &plot);
    curves(ui, texture, &plot);
    let draft = texture.draft;
    match draft.kind {
        WishKind::Profile => breakpoints(ui, draft, &plot, &response, view),
        WishKind::Solid => place(ui, "Felt edge", draft.felt_edge_m, &plot, &response)
            .map(|felt_edge_m| WishDraft { felt_edge_m, ..draft.clone() }),
        WishKind::Beat => place(ui, "Place of the beat", draft.beat_place_m, &plot, &response)
            .map(|beat_place_m| WishDraft { beat_place_m, ..draft.clone() }),
        WishKind::Stripes => None,
    }
}

fn ground(ui: &egui::Ui, plot: &Plot) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    painter.rect_filled(plot.rect, 3.0, palette.well);
    let ticks = plot.axis.ticks_mm(60.0);
    let font = FontId::proportional(11.5);
    for &mm in &ticks.places {
        let x = plot.axis.line_from_place(mm * 1e-3);
        painter.vline(x, plot.rect.y_range(), Stroke::new(1.0, palette.grid));
        let at = pos2(x, plot.rect.bottom() + 3.0);
        let (anchor, label) = match mm {
            0.0 => (Align2::LEFT_TOP, "0 mm".to_owned()),
            mm => (Align2::CENTER_TOP, ticks.label(mm)),
        };
        painter.text(at, anchor, label, font.clone(), palette.weak);
    }
    let line = plot.screen((0.0, 1.0)).y.round() + 0.5;
    painter.hline(plot.rect.x_range(), line, Stroke::new(1.0, palette.grid));
}

fn curves(ui: &egui::Ui, texture: &TextureScene<'_>, plot: &Plot) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(plot.rect.expand(1.0));
    if let Some(textured) = texture.latest
        && let Ok(made) = &textured.result
        && textured.wish.wish.kind() == texture.draft.kind
    {
        let fit = made.fitted.as_ref();
        let fitted = fit.map(|fitted| &fitted.texture);
        // Of the wanted profile, or of the present one where nothing is drawn.
        let wanted_m = fitted.map_or(&textured.rms_m, |texture| &texture.wanted_m);
        let largest_m = wanted_m.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let curve = |values: &[f64]| plot.curve(values.iter().map(|metres| metres / largest_m));
        // Dim while it is not yet that of the draft.
        let ink = palette.accent.gamma_multiply(if texture.is_current { 1.0 } else { 0.45 });
        if let Some(texture) = fitted {
            let any = curve(&texture.reach_m);
            painter.extend(Shape::dashed_line(&any, Stroke::new(1.2, palette.weak), 2.0, 3.0));
        }
        if let Some(fit) = fit.filter(|fit| fit.is_solid()) {
            // Only where the fit has a wish: it has none between the area and the still part.
            let points = curve(&fit.texture.wanted_m);
            let counting: Vec<(Pos2, f64)> = points.into_iter().zip(fit.weights().iter().copied()).collect();
            for part in counting.split(|(_, weight)| *weight == 0.0) {
                let line: Vec<Pos2> = part.iter().map(|(at, _)| *at).collect();
                painter.extend(wanted(palette, &line));
            }
        }
        painter.add(Shape::line(curve(&textured.rms_m), Stroke::new(1.8, ink)));
        if let Some(Lack::Reach(_)) = made.lack(textured.wish.most) {
            // At once, and where one looks while one draws: below the curves, which are high where something is wanted.
            let words = "not all of it is in reach".to_owned();
            let galley = painter.layout_no_wrap(words, FontId::proportional(11.5), palette.weak);
            let place = plot.rect.left_bottom() + vec2(4.0, -2.0 - galley.size().y);
            painter.rect_filled(Rect::from_min_size(place, galley.size()).expand(2.0), 2.0, palette.well);
            painter.galley(place, galley, palette.weak);
        }
    }
    if texture.draft.kind == WishKind::Profile {
        let drawn: Vec<Pos2> = texture.draft.profile.iter().map(|&point| plot.screen(point)).collect();
        painter.extend(wanted(palette, &drawn));
    }
}

/// The line of what is wanted.
fn wanted(palette: &Palette, line: &[Pos2]) -> Vec<Shape> {
    Shape::dashed_line(line, Stroke::new(1.5, palette.text), 5.0, 3.0)
}

/// The samples of the curves with their names.
pub(crate) fn legend(ui: &mut egui::Ui, texture: &TextureScene<'_>) {
    let palette = theme::palette(ui);
    let has_target = matches!(texture.draft.kind, WishKind::Solid | WishKind::Profile);
    ui.horizontal_wrapped(|ui| {
        let mut entry = |name: &str, stroke: Stroke, dash: Option<(f32, f32)>| {
            let (rect, _) = ui.allocate_exact_size(vec2(14.0, 12.0), Sense::hover());
            let line = [rect.left_center(), rect.right_center()];
            match dash {
                Some((dash, gap)) => {
                    ui.painter().extend(Shape::dashed_line(&line, stroke, dash, gap));
                }
                None => {
                    ui.painter().line_segment(line, stroke);
                }
            }
            ui.label(egui::RichText::new(name).small().color(palette.weak));
        };
        if has_target {
            entry("wanted", Stroke::new(1.5, palette.text), Some((5.0, 3.0)));
        }
        entry("its tones", Stroke::new(1.8, palette.accent), None);
        if has_target {
            entry("any number", Stroke::new(1.2, palette.weak), Some((2.0, 3.0)));
        }
    });
}

/// The line of a place that is dragged; returns its new place.
fn place(ui: &egui::Ui, name: &str, place_m: f64, plot: &Plot, response: &egui::Response) -> Option<f64> {
    let palette = theme::palette(ui);
    let id = ui.scope_id().with(name);
    let x = plot.axis.line_from_place(place_m.clamp(0.0, plot.axis.length_m()));
    let column = Rect::from_x_y_ranges(Rangef::new(x - 0.5 * HANDLE, x + 0.5 * HANDLE), plot.rect.y_range());
    let handle =
        ui.interact(column, id, Sense::click_and_drag()).on_hover_cursor(CursorIcon::ResizeHorizontal);
    handle.widget_info(|| egui::WidgetInfo::slider(true, place_m * 1e3, name));
    let handle = handle.on_hover_text("Drag it along the plate, or press the arrow keys: 1 mm a press");
    let width = if handle.has_focus() || handle.hovered() { 3.0 } else { 2.0 };
    ui.painter().vline(x, plot.rect.y_range(), Stroke::new(width, palette.boundary));
    let is_held = handle.is_pointer_button_down_on() || response.is_pointer_button_down_on();
    if is_held {
        handle.request_focus();
        let pointer = handle.interact_pointer_pos().or(response.interact_pointer_pos())?;
        return Some(plot.axis.place_from_screen(pointer.x).clamp(0.0, plot.axis.length_m()));
    }
    let (along, _) = arrows(ui, id);
    let by_keys = (along != 0.0).then_some(place_m + along * STEP.0);
    let moved = by_keys.or_else(|| crate::view::stage::handle::by_assistive_technology(ui, id, place_m));
    moved.map(|place_m| place_m.clamp(0.0, plot.axis.length_m()))
}

/// Steps of the arrow keys to the right and up, while this has the focus.
fn arrows(ui: &egui::Ui, id: Id) -> (f64, f64) {
    if !ui.memory(|memory| memory.has_focus(id)) {
        return (0.0, 0.0);
    }
    let filter = egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
    ui.input(|input| {
        let presses = |key| input.num_presses(key) as f64;
        (presses(Key::ArrowRight) - presses(Key::ArrowLeft), presses(Key::ArrowUp) - presses(Key::ArrowDown))
    })
}

/// The breakpoints of a profile: each is dragged; pressing between them adds one, a double click removes it.
fn breakpoints(
    ui: &egui::Ui,
    draft: &WishDraft,
    plot: &Plot,
    response: &egui::Response,
    view: &mut ViewState,
) -> Option<WishDraft> {
    let palette = theme::palette(ui);
    let length_m = plot.axis.length_m();
    if draft.profile.len() > BREAKPOINTS_DRAWN_MAX {
        // From a file: too many to take hold of.
        return None;
    }
    let mut changed: Option<WishDraft> = None;
    let mut change = |act: &mut dyn FnMut(&mut WishDraft)| {
        act(changed.get_or_insert_with(|| draft.clone()));
    };
    let is_down = ui.input(|input| input.pointer.primary_down());
    if !is_down {
        view.held_breakpoint = None;
    }
    for (number, &(place_m, amplitude)) in draft.profile.iter().enumerate() {
        let at = plot.screen((place_m, amplitude));
        let id = ui.scope_id().with(("breakpoint", number));
        let handle = ui
            .interact(Rect::from_center_size(at, vec2(HANDLE, HANDLE)), id, Sense::click_and_drag())
            .on_hover_cursor(CursorIcon::Move);
        let name = format!("Breakpoint {}", number + 1);
        let value = format!("{}, {amplitude:.2}", show_place(place_m));
        handle.widget_info(|| {
            let mut info = egui::WidgetInfo::slider(true, place_m * 1e3, &name);
            info.current_text_value = Some(value.clone());
            info
        });
        if handle.is_pointer_button_down_on() && view.held_breakpoint.is_none() {
            view.held_breakpoint = Some(number);
            handle.request_focus();
        }
        let is_removed = handle.double_clicked()
            || (handle.has_focus()
                && ui.input(|input| input.key_pressed(Key::Delete) || input.key_pressed(Key::Backspace)));
        if is_removed {
            view.held_breakpoint = None;
            change(&mut |draft| draft.remove_breakpoint(number));
        }
        let (along, up) = arrows(ui, id);
        let by_keys = (place_m + along * STEP.0, amplitude + up * STEP.1);
        let by_technology = crate::view::stage::handle::by_assistive_technology(ui, id, place_m);
        let to = by_technology.map_or(by_keys, |place_m| (place_m, amplitude));
        if to != (place_m, amplitude) {
            change(&mut |draft| draft.move_breakpoint(number, to, length_m));
        }
        let is_hot = handle.hovered() || handle.has_focus() || view.held_breakpoint == Some(number);
        let radius = if is_hot { 6.0 } else { 4.5 };
        ui.painter().circle(at, radius, palette.panel, Stroke::new(1.8, palette.text));
        handle.on_hover_text(format!("{value} of the largest. Drag it; a double click or Delete removes it"));
    }
    let pointer = ui.input(|input| input.pointer.interact_pos());
    if let (Some(number), Some(pointer), true) = (view.held_breakpoint, pointer, is_down) {
        change(&mut |draft| draft.move_breakpoint(number, plot.value(pointer), length_m));
    } else if let Some(pointer) = response.interact_pointer_pos()
        && response.is_pointer_button_down_on()
        && plot.rect.expand(4.0).contains(pointer)
        && view.held_breakpoint.is_none()
    {
        let mut added = None;
        change(&mut |draft| added = draft.add_breakpoint(plot.value(pointer), length_m));
        view.held_breakpoint = added;
    }
    changed.filter(|changed| changed != draft)
}
