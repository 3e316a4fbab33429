//! Fields in which a value with a unit is typed. A value that is not taken stays in the field with the reason under it.

use super::theme;
use eframe::egui::{self, Id, Key, RichText};
use std::collections::HashMap;

/// What stands in the fields that are being typed in.
#[derive(Default)]
pub(crate) struct Fields {
    texts: HashMap<Id, Typing>,
}

struct Typing {
    text: String,
    error: Option<String>,
    /// The value that the text was typed over.
    over: String,
}

/// One field: its name for screen readers, its present value as text, and what is allowed.
pub(super) struct InputField<'a> {
    pub(super) name: &'a str,
    pub(super) value: &'a str,
    pub(super) hint: &'a str,
    pub(super) width: f32,
    /// A word over the field, where its place does not say what it is.
    pub(super) caption: Option<&'a str>,
}

impl InputField<'_> {
    /// Shows the field, and under it why what was typed is not taken. What is typed goes through `take` on Enter or
    /// when the field is left.
    pub(super) fn show<T>(
        self,
        ui: &mut egui::Ui,
        fields: &mut Fields,
        take: impl FnOnce(&str) -> Result<T, String>,
    ) -> Option<T> {
        ui.vertical(|ui| {
            let mut reason = None;
            let taken = self.show_apart(ui, fields, &mut reason, take);
            if let Some(reason) = reason {
                // As wide as the field and no wider: a reason must not move what stands beside it.
                ui.set_max_width(ui.min_rect().width());
                let text = RichText::new(reason).small().color(theme::palette(ui).wrong);
                ui.add(egui::Label::new(text).wrap());
            }
            taken
        })
        .inner
    }

    /// The same, with the reason left to be shown where the caller has room for it.
    pub(super) fn show_apart<T>(
        self,
        ui: &mut egui::Ui,
        fields: &mut Fields,
        reason: &mut Option<String>,
        take: impl FnOnce(&str) -> Result<T, String>,
    ) -> Option<T> {
        let id = ui.scope_id().with(("field", self.name));
        ui.vertical(|ui| {
            if let Some(caption) = self.caption {
                ui.label(RichText::new(caption).small().color(theme::palette(ui).weak));
            }
            // What was refused is over when the value has changed by another way, such as undo.
            let is_over = fields.texts.get(&id).is_some_and(|typing| typing.over != self.value);
            if is_over && !ui.memory(|memory| memory.has_focus(id)) {
                fields.texts.remove(&id);
            }
            let typing = fields.texts.get(&id);
            let mut text = typing.map_or_else(|| self.value.to_owned(), |typing| typing.text.clone());
            let mut error = typing.and_then(|typing| typing.error.clone());
            let mut edit =
                egui::TextEdit::singleline(&mut text).id(id).desired_width(self.width).char_limit(64);
            if error.is_some() {
                edit = edit.text_color(theme::palette(ui).wrong);
            }
            let response = ui.add(edit).on_hover_text(self.hint);
            response.widget_info(|| {
                let mut info = egui::WidgetInfo::text_edit(true, self.value, &text, self.hint);
                info.label = Some(self.name.to_owned());
                info
            });
            if response.changed() {
                error = None;
            }
            let mut taken = None;
            if response.lost_focus() {
                // Escape gives up what was typed; everything else takes it.
                let is_given_up = ui.input(|input| input.key_pressed(Key::Escape));
                if is_given_up || text.trim() == self.value {
                    fields.texts.remove(&id);
                    error = None;
                } else {
                    match take(&text) {
                        Ok(value) => {
                            taken = Some(value);
                            fields.texts.remove(&id);
                            error = None;
                        }
                        Err(reason) => {
                            let over = self.value.to_owned();
                            fields.texts.insert(id, Typing { text, error: Some(reason.clone()), over });
                            error = Some(reason);
                        }
                    }
                }
            } else if response.has_focus() {
                let over = self.value.to_owned();
                fields.texts.insert(id, Typing { text, error: error.clone(), over });
            }
            if error.is_some() {
                *reason = error;
            }
            taken
        })
        .inner
    }
}

/// A control with its name at the left, so that names and controls line up.
pub(super) fn labelled<R>(ui: &mut egui::Ui, name: &str, add: impl FnOnce(&mut egui::Ui) -> R) -> R {
    ui.horizontal_top(|ui| {
        let palette = theme::palette(ui);
        let (rect, _) = ui.allocate_exact_size(egui::vec2(118.0, 26.0), egui::Sense::hover());
        let font = egui::TextStyle::Body.resolve(ui.style());
        ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, name, font, palette.weak);
        add(ui)
    })
    .inner
}

/// Stands for a value that is not known.
pub(super) const UNKNOWN: &str = "–";

/// Height of a line of a table of values, in points.
const ROW: f32 = 17.0;

/// One line of a table of values: name on the left, value on the right.
pub(super) fn row(ui: &mut egui::Ui, name: &str, value: impl Into<RichText>) {
    let palette = theme::palette(ui);
    ui.scope(|ui| {
        ui.spacing_mut().interact_size.y = ROW;
        ui.horizontal(|ui| {
            ui.label(RichText::new(name).color(palette.weak));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add(egui::Label::new(value.into()).truncate());
            });
        });
    });
}
