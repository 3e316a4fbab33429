//! Input fields for a value with a unit. A refused text stays in the field, with the reason under it.

use crate::view::kept::{Fields, Typing};
use crate::view::theme;
use eframe::egui::{self, Key, RichText};
use std::fmt::Display;

/// Most letters in a field: the path of a socket has up to 108.
const MOST_LETTERS: usize = 120;

/// One input field: its name for screen readers, its present value as text, and a hint of the allowed range.
pub(crate) struct InputField<'a> {
    pub(crate) name: &'a str,
    pub(crate) value: &'a str,
    pub(crate) hint: &'a str,
    pub(crate) width: f32,
    /// A caption over the field, where its place alone does not explain it.
    pub(crate) caption: Option<&'a str>,
    /// Whether a text that is understood is taken while it is typed, for a picture that follows.
    pub(crate) is_live: bool,
}

impl<'a> InputField<'a> {
    /// A field without a caption, whose text is taken when it is left.
    pub(crate) fn new(name: &'a str, value: &'a str, hint: &'a str, width: f32) -> Self {
        Self { name, value, hint, width, caption: None, is_live: false }
    }

    /// The same under a caption.
    pub(crate) fn under(self, caption: &'a str) -> Self {
        Self { caption: Some(caption), ..self }
    }

    /// Shows the field, with the reason of a refusal under it. The text goes through `take` on Enter or when the
    /// field loses the focus.
    pub(crate) fn show<T, E: Display>(
        self,
        ui: &mut egui::Ui,
        fields: &mut Fields,
        take: impl FnOnce(&str) -> Result<T, E>,
    ) -> Option<T> {
        ui.vertical(|ui| {
            let mut reason = None;
            let taken = self.show_apart(ui, fields, &mut reason, take);
            // No wider than the field: a reason must not move the controls beside it.
            ui.set_max_width(ui.min_rect().width());
            refusal(ui, reason.as_deref());
            taken
        })
        .inner
    }

    /// Shows the field alone; the caller shows the reason where there is space for it.
    pub(crate) fn show_apart<T, E: Display>(
        self,
        ui: &mut egui::Ui,
        fields: &mut Fields,
        reason: &mut Option<String>,
        take: impl FnOnce(&str) -> Result<T, E>,
    ) -> Option<T> {
        let id = ui.scope_id().with(("field", self.name));
        ui.vertical(|ui| {
            if let Some(caption) = self.caption {
                ui.label(RichText::new(caption).small().color(theme::palette(ui).weak));
            }
            // A refused text is dropped when the value has changed in another way, such as by undo.
            let is_over = fields.texts.get(&id).is_some_and(|typing| typing.over != self.value);
            if is_over && !ui.memory(|memory| memory.has_focus(id)) {
                fields.texts.remove(&id);
            }
            let typing = fields.texts.get(&id);
            let mut text = typing.map_or_else(|| self.value.to_owned(), |typing| typing.text.clone());
            let mut error = typing.and_then(|typing| typing.error.clone());
            let mut edit = egui::TextEdit::singleline(&mut text)
                .id(id)
                .desired_width(self.width)
                .char_limit(MOST_LETTERS);
            if error.is_some() {
                edit = edit.text_color(theme::palette(ui).wrong);
            }
            let response = ui.add(edit).on_hover_text(self.hint);
            theme::name_field(&response, self.name, self.value, &text, self.hint);
            if response.changed() {
                error = None;
            }
            let mut taken = None;
            if response.lost_focus() {
                // Escape discards the text; every other way to leave the field applies it.
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
                        Err(refusal) => {
                            let reason = refusal.to_string();
                            let over = self.value.to_owned();
                            fields.texts.insert(id, Typing { text, error: Some(reason.clone()), over });
                            error = Some(reason);
                        }
                    }
                }
            } else if response.has_focus() {
                if self.is_live && response.changed() {
                    // A text that cannot be parsed yet is refused only when the field is left.
                    taken = take(&text).ok();
                }
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

/// Why a field was refused, under the fields.
pub(crate) fn refusal(ui: &mut egui::Ui, reason: Option<&str>) {
    if let Some(reason) = reason {
        ui.add(egui::Label::new(RichText::new(reason).small().color(theme::palette(ui).wrong)).wrap());
    }
}

/// A control with its name at the left, so that names and controls are aligned.
pub(crate) fn labelled<R>(ui: &mut egui::Ui, name: &str, add: impl FnOnce(&mut egui::Ui) -> R) -> R {
    ui.horizontal_top(|ui| {
        let palette = theme::palette(ui);
        let (rect, _) = ui.allocate_exact_size(egui::vec2(118.0, 26.0), egui::Sense::hover());
        let font = egui::TextStyle::Body.resolve(ui.style());
        ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, name, font, palette.weak);
        add(ui)
    })
    .inner
}

/// The text for an unknown value.
pub(crate) const UNKNOWN: &str = "–";

/// Height of a line of a table of values, in points.
const ROW: f32 = 17.0;

/// One line of a table of values: name on the left, value on the right. Returns its name.
pub(crate) fn row(ui: &mut egui::Ui, name: &str, value: impl Into<RichText>) -> egui::Response {
    let palette = theme::palette(ui);
    ui.scope(|ui| {
        ui.spacing_mut().interact_size.y = ROW;
        ui.horizontal(|ui| {
            let name = ui.label(RichText::new(name).color(palette.weak));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add(egui::Label::new(value.into()).truncate());
            });
            name
        })
        .inner
    })
    .inner
}
