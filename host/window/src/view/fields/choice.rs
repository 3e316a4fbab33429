//! A list to choose one of, with its name at the left as the fields have theirs, or under a caption.

use crate::view::fields::field::labelled;
use crate::view::theme;
use eframe::egui::{self, RichText};

/// Shows the list called `name`, `width` points wide; closed it shows `shown`. While it is open, `entries` shows the
/// choices and returns what was chosen.
pub(crate) fn choice<T>(
    ui: &mut egui::Ui,
    words: (&str, &str, &str),
    width: f32,
    entries: impl FnOnce(&mut egui::Ui) -> Option<T>,
) -> Option<T> {
    labelled(ui, words.0, |ui| list(ui, "", words, width, entries))
}

/// As [`choice`] under a caption, which need not be its name.
pub(crate) fn choice_under<T>(
    ui: &mut egui::Ui,
    caption: &str,
    words: (&str, &str, &str),
    width: f32,
    entries: impl FnOnce(&mut egui::Ui) -> Option<T>,
) -> Option<T> {
    let captioned = ui.vertical(|ui| {
        ui.label(RichText::new(caption).small().color(theme::palette(ui).weak));
        list(ui, caption, words, width, entries)
    });
    captioned.inner
}

fn list<T>(
    ui: &mut egui::Ui,
    caption: &str,
    (name, shown, help): (&str, &str, &str),
    width: f32,
    entries: impl FnOnce(&mut egui::Ui) -> Option<T>,
) -> Option<T> {
    // Two lists of one name may stand under different captions.
    let list = egui::ComboBox::from_id_salt((name, caption)).selected_text(shown).width(width);
    let list = list.show_ui(ui, entries);
    let label = format!("{name}: {shown}");
    list.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
    list.response.on_hover_text(help);
    list.inner.flatten()
}
