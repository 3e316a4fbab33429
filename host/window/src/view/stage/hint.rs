//! The hint of a first start: that the line can be dragged.

use super::flag::{Flag, INSET, flag_of};
use super::layout::{GAP, Layout};
use crate::axis::Axis;
use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{self, CornerRadius, FontId, Galley, Rangef, Rect, Sense, Stroke, pos2};
use std::sync::Arc;

/// The text of the hint, in the longest form that fits.
const HINTS: [&str; 2] = ["Drag the line: it moves the boundary", "Drag the line"];

/// The hint of a first start: beside the flag of the line if it has room there, else in a row of its own. It covers
/// nothing.
pub(super) struct Hint {
    galley: Arc<Galley>,
    /// Its left end, in points.
    left: f32,
    /// Whether it needs a row of its own.
    pub(super) is_apart: bool,
}

impl Hint {
    pub(super) fn of(ui: &egui::Ui, scene: &Scene<'_>, axis: &Axis, row: Rangef) -> Option<Self> {
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

    pub(super) fn show(self, ui: &egui::Ui, layout: &Layout) {
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
