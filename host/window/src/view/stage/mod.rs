//! The stage: plate, envelope and strip over one x axis, and the boundary line through all three.

pub(crate) mod aligned;
pub(crate) mod brush;
mod displacement;
mod envelope;
pub(crate) mod felt_strip;
pub(crate) mod finger;
mod fingertip;
mod flag;
pub(crate) mod handle;
mod hint;
mod layout;
mod light_marks;
mod line;
mod plate;
pub(crate) mod polyline;
pub(crate) mod press;
mod read_out;
mod relief;
mod sensor;
mod track;

use crate::axis::Axis;
use crate::intent::Intents;
use crate::scene::Scene;
use crate::view::panels::designer::sketch;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Align2, CornerRadius, FontId, Key, Rangef, Rect, Stroke, pos2};
use hint::Hint;
use layout::{LABEL, Layout, MARGIN};
use light_marks::LightMarks;
use slipline_plate::order;

pub(crate) use line::handle_name;

/// Corner of the envelope's well, in points.
const WELL_CORNER: u8 = 3;

/// Shows the stage in the whole of `ui`.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let area = ui.available_rect_before_wrap();
    let plate = &scene.setup.plate;
    let range = Rangef::new(area.left() + MARGIN.0, area.right() - MARGIN.1);
    let density = ui.pixels_per_point();
    let axis = Axis::new(plate.length_m(), range, density);
    let hint = Hint::of(ui, scene, &axis, area.x_range());
    let needs_row = hint.as_ref().is_some_and(|hint| hint.is_apart);
    let hint_height = if needs_row { LABEL + 2.0 } else { 0.0 };
    let layout = Layout::new(area, axis, plate.half_width_m(0.0), density, hint_height);
    // The well's round corners show the page.
    let well = layout.axis.over_plate(layout.envelope);
    theme::fill_page_around(ui, area + theme::MARGIN, well.shrink(f32::from(WELL_CORNER)));
    if layout.title.height() > 0.0 {
        ui.scope_builder(egui::UiBuilder::new().max_rect(layout.title), |ui| {
            plate::title(ui, scene, view, intents);
        });
    }
    grid(ui, scene, &layout);
    plate::show(ui, scene, &layout.axis, layout.plate);
    let is_sketched = view.is_designing()
        && scene.settings.show_panel
        && sketch::show(ui, scene, &mut view.sketched, &layout.axis, layout.plate);
    // Below what explains itself under the pointer.
    press::show(ui, scene, &layout, &mut view.pressing, intents);
    track::show(ui, scene, &layout, intents);
    envelope::show(ui, scene, &layout.axis, layout.envelope);
    felt_strip::show(ui, scene, &layout.axis, layout.strip);
    if is_sketched {
        sketch::cover(ui, &layout.axis, layout.envelope, "Use this plate to see its curve");
        sketch::cover(ui, &layout.axis, layout.strip, "");
    }
    place_scale(ui, scene, &layout);
    let drawn = Rect::from_x_y_ranges(layout.axis.screen(), layout.plate.top()..=layout.envelope.bottom());
    let marks =
        LightMarks::show(ui, scene, view, &layout.axis, area.x_range(), (drawn, layout.envelope.top()));
    // The selected tone comes last, so that it is drawn on top and gets the pointer first.
    let mut order: Vec<u8> = scene.setup.tones.iter().map(|tone| tone.slot).collect();
    order::sort_by_key(&mut order, |&slot| slot == scene.selected);
    for slot in order {
        line::show(ui, scene, &layout, slot, view, intents);
    }
    sensor::show(ui, scene, view, &layout);
    finger::handle(ui, scene, &layout, view, intents);
    if let Some(hint) = hint {
        hint.show(ui, &layout);
    }
    let left_end = brush::show(ui, scene, &layout, &mut view.brush, intents);
    if !is_sketched {
        envelope::legend(ui, scene, &layout.axis, layout.envelope, left_end);
    }
    let views = Rect::from_x_y_ranges(layout.axis.screen(), layout.plate.top()..=layout.strip.bottom());
    // A symbol's text replaces the read-out.
    if !marks.interact(ui, view, intents) && !view.brush.is_drawing() {
        read_out::show(ui, scene, &layout.axis, views);
    }
}

/// Faint lines at the same places in all views.
fn grid(ui: &egui::Ui, scene: &Scene<'_>, layout: &Layout) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    let over = layout.axis.over_plate(layout.envelope);
    painter.rect_filled(over, CornerRadius::same(WELL_CORNER), palette.well);
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
