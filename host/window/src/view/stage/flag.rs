//! The flag on the selected line: its place, its frequency, and how wide the edge is or why there is none.

use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{self, CornerRadius, FontId, Galley, Rangef, Rect, Sense, Vec2, vec2};
use slipline_model::field::line::{Holds, Line};
use slipline_plate::quantity::{show_frequency, show_place};
use std::sync::Arc;

/// Space around the text of a flag or hint, in points.
pub(super) const INSET: Vec2 = vec2(10.0, 3.0);

const FLAG_HELP: &str = "Where the line is, the frequency of its tone, and how far it is from the peak to a tenth of it, or \
    why there is no edge";

/// The words of the flag on the selected line: its place, its frequency, and how wide the edge is or why there is none.
fn flag(line: &Line, frequency_hz: f64, edge_m: f64) -> String {
    let (place, frequency) = (show_place(line.place_m), show_frequency(frequency_hz));
    match line.holds {
        Holds::FeltEdge => format!("felt edge {place}   {frequency}   edge {:.0} mm", edge_m * 1e3),
        Holds::TurningPoint => format!("turning point {place}   {frequency}   edge {:.0} mm", edge_m * 1e3),
        Holds::PlateEnd => format!("felt to the plate's end   {frequency}"),
        Holds::Unfelt(why) => format!("turning point {place}   {frequency}   {}", why.words()),
    }
}

/// The words of the flag on a line; `is_held` adds where the span ends.
pub(super) fn flag_of(scene: &Scene<'_>, line: &Line, is_held: bool) -> Option<String> {
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

/// The flag at the top of the selected line.
pub(super) struct Flag {
    galley: Arc<Galley>,
    /// Its left and right end, in points.
    pub(super) extent: Rangef,
}

impl Flag {
    /// The flag with this text on a line at `x`. If it does not fit in the row, its left end stays visible.
    pub(super) fn of(ui: &egui::Ui, row: Rangef, x: f32, text: String) -> Self {
        let palette = theme::palette(ui);
        let ink = if palette.dark { palette.page } else { palette.well };
        let galley = ui.painter().layout_no_wrap(text, FontId::proportional(13.5), ink);
        let width = galley.size().x + 2.0 * INSET.x;
        let left = (x - 0.5 * width).min(row.max - width).max(row.min);
        Self { galley, extent: Rangef::new(left, left + width) }
    }

    pub(super) fn show(self, ui: &egui::Ui, row: Rect) {
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
