//! Controls at the right end of a row. A row laid out from right to left would hand the Tab key to them in that
//! order; here they are laid out as they are read, after as much room as they leave free.

use super::theme;
use eframe::egui;

/// A width that is kept from one pass of the window to the next.
pub(super) struct Width {
    id: egui::Id,
    known: Option<f32>,
}

/// Less than this is a rounding, in points.
const DIFFERS: f32 = 0.5;

impl Width {
    /// The width of this name in this row.
    pub(super) fn of(ui: &egui::Ui, name: &str) -> Self {
        let id = ui.scope_id().with(("width", name));
        Self { id, known: ui.data(|data| data.get_temp(id)) }
    }

    /// As it was, in points; 0 before it was seen.
    pub(super) fn points(&self) -> f32 {
        self.known.unwrap_or(0.0)
    }

    /// Notes the width as it is. When that is another one, the window is laid out again before it is shown.
    pub(super) fn note(self, ui: &egui::Ui, points: f32) {
        if self.known.is_none_or(|known| (known - points).abs() > DIFFERS) {
            ui.data_mut(|data| data.insert_temp(self.id, points));
            ui.ctx().request_discard("a width has changed");
        }
    }
}

/// A heading, and controls that end where the row ends; the heading gives way to them.
pub(super) fn headed<R>(ui: &mut egui::Ui, heading: &str, add: impl FnOnce(&mut egui::Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let taken = Width::of(ui, AT_RIGHT).points() + ui.spacing().item_spacing.x;
        ui.scope(|ui| {
            ui.set_max_width((ui.available_width() - taken).max(0.0));
            let text = egui::RichText::new(heading).strong().size(theme::HEADING);
            ui.add(egui::Label::new(text).truncate());
        });
        at_right(ui, add)
    })
    .inner
}

const AT_RIGHT: &str = "at right";

/// Adds controls so that they end where the row ends.
pub(super) fn at_right<R>(ui: &mut egui::Ui, add: impl FnOnce(&mut egui::Ui) -> R) -> R {
    let width = Width::of(ui, AT_RIGHT);
    ui.add_space((ui.available_width() - width.points()).max(0.0));
    // In the whole height of the row, so that what is high and what is low stand at one middle.
    let shown = ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), add);
    width.note(ui, shown.response.rect.width());
    shown.inner
}
