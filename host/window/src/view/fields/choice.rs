//! A list to choose one of, with its name at the left as the fields have theirs.

use crate::view::fields::field::labelled;
use eframe::egui;

/// Shows the list called `name`, `width` points wide; closed it shows `shown`. While it is open, `entries` shows what
/// there is and returns what was chosen.
pub(crate) fn choice<T>(
    ui: &mut egui::Ui,
    (name, shown, help): (&str, &str, &str),
    width: f32,
    entries: impl FnOnce(&mut egui::Ui) -> Option<T>,
) -> Option<T> {
    labelled(ui, name, |ui| {
        let list = egui::ComboBox::from_id_salt(name).selected_text(shown).width(width).show_ui(ui, entries);
        let label = format!("{name}: {shown}");
        list.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
        list.response.on_hover_text(help);
        list.inner.flatten()
    })
}
