//! Small words whose room does not change with them, so that no control under them moves.

use eframe::egui::{self, Color32, text::LayoutJob, vec2};

/// Shows `text` in a fixed number of lines, also if it is shorter. A tooltip shows words that are cut.
pub(crate) fn lines(ui: &mut egui::Ui, text: impl Into<String>, colour: Color32, rows: usize) {
    let height = rows as f32 * ui.text_style_height(&egui::TextStyle::Small);
    let size = vec2(ui.available_width(), height);
    ui.allocate_ui_with_layout(size, egui::Layout::top_down(egui::Align::Min), |ui| {
        ui.set_min_size(size);
        let font = egui::TextStyle::Small.resolve(ui.style());
        let mut words = LayoutJob::simple(text.into(), font, colour, size.x);
        words.wrap.max_rows = rows;
        ui.label(words);
    });
}
