//! Controls at the right end of a row. In a right-to-left layout the Tab key would visit them from right to left;
//! here they are laid out in reading order, after a gap that fills the rest of the row.

use crate::view::theme;
use eframe::egui;

/// A width that is kept from one pass of the window to the next.
pub(crate) struct Width {
    id: egui::Id,
    known: Option<f32>,
}

/// A smaller change of width is only rounding, in points.
const DIFFERS: f32 = 0.5;

impl Width {
    /// The width of this name in this row.
    pub(crate) fn of(ui: &egui::Ui, name: &str) -> Self {
        let id = ui.scope_id().with(("width", name));
        Self { id, known: ui.data(|data| data.get_temp(id)) }
    }

    /// The width in the pass before, in points; 0 before the first pass.
    pub(crate) fn points(&self) -> f32 {
        self.known.unwrap_or(0.0)
    }

    /// Stores the measured width. If it has changed, the window is laid out again before it is shown.
    pub(crate) fn note(self, ui: &egui::Ui, points: f32) {
        if self.known.is_none_or(|known| (known - points).abs() > DIFFERS) {
            ui.data_mut(|data| data.insert_temp(self.id, points));
            ui.ctx().request_discard("a width has changed");
        }
    }
}

/// A heading, and controls at the right end of its row; the heading is shortened if there is too little space.
pub(crate) fn headed<R>(ui: &mut egui::Ui, heading: &str, add: impl FnOnce(&mut egui::Ui) -> R) -> R {
    let show = |ui: &mut egui::Ui| {
        let taken = Width::of(ui, AT_RIGHT).points() + ui.spacing().item_spacing.x;
        ui.scope(|ui| {
            ui.set_max_width((ui.available_width() - taken).max(0.0));
            let text = egui::RichText::new(heading).strong().size(theme::HEADING);
            ui.add(egui::Label::new(text).truncate());
        });
        at_right(ui, add)
    };
    ui.push_id(heading, |ui| ui.horizontal(show).inner).inner
}

const AT_RIGHT: &str = "at right";

/// Adds controls at the right end of the row. Beside another such row, each needs an id of its own: the width is kept under it.
pub(crate) fn at_right<R>(ui: &mut egui::Ui, add: impl FnOnce(&mut egui::Ui) -> R) -> R {
    let width = Width::of(ui, AT_RIGHT);
    // Before the first pass nothing is left free: beyond the row they would widen a page, which stands in the middle.
    let free = width.known.map_or(0.0, |points| (ui.available_width() - points).max(0.0));
    ui.add_space(free);
    // Uses the whole height of the row, so that high and low controls are centred on the same line.
    let shown = ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), add);
    width.note(ui, shown.response.rect.width());
    shown.inner
}
