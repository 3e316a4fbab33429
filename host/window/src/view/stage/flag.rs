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

/// The words of the flag on a line, in the longest form first: without the edge, then without the frequency, it is
/// shorter. `is_held` adds where the span ends.
pub(super) fn flag_of(scene: &Scene<'_>, line: &Line, is_held: bool) -> Option<[String; 3]> {
    let plate = &scene.setup.plate;
    let position_m = scene.setup.tone(line.slot)?.position_m;
    let frequency_hz = plate.frequency_for_boundary_hz(position_m);
    let (place, frequency) = (show_place(line.place_m), show_frequency(frequency_hz));
    let edge = || format!("   fall-off {:.0} mm", plate.edge_width_m(frequency_hz).unwrap_or(f64::NAN) * 1e3);
    let (place, edge, why) = match line.holds {
        Holds::FeltEdge => (format!("felt to {place}"), edge(), String::new()),
        Holds::TurningPoint => (format!("turning point {place}"), edge(), String::new()),
        Holds::PlateEnd => ("felt to the plate's end".to_owned(), String::new(), String::new()),
        Holds::Unfelt(why) => {
            (format!("turning point {place}"), String::new(), format!("   {}", why.words()))
        }
    };
    let end = if is_held { end_of_span(plate.span_m(), position_m) } else { "" };
    Some([
        format!("{place}   {frequency}{edge}{why}{end}"),
        format!("{place}   {frequency}{why}{end}"),
        format!("{place}{why}{end}"),
    ])
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
    /// The flag on a line at `x`, in the longest form that fits in the row. If none does, the left end of the shortest
    /// stays visible.
    pub(super) fn of(ui: &egui::Ui, row: Rangef, x: f32, forms: [String; 3]) -> Self {
        let palette = theme::palette(ui);
        let ink = if palette.dark { palette.page } else { palette.well };
        let text = |text: String| ui.painter().layout_no_wrap(text, FontId::proportional(13.5), ink);
        let width = |galley: &Galley| galley.size().x + 2.0 * INSET.x;
        let [whole, shorter, shortest] = forms;
        let mut galley = text(whole);
        for form in [shorter, shortest] {
            if width(&galley) > row.span() {
                galley = text(form);
            }
        }
        let width = width(&galley);
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
