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
        let shown = ui.vertical(|ui| {
            let mut reason = None;
            let taken = self.show_apart(ui, fields, &mut reason, take);
            (taken, reason)
        });
        let (taken, reason) = shown.inner;
        refusal_over(ui, shown.response.rect, reason.as_deref());
        taken
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
            // A field in which nothing has been typed follows its value: leaving it changes nothing.
            let is_typed = |typing: &&Typing| typing.error.is_some() || typing.text != typing.over;
            let typing = fields.texts.get(&id).filter(is_typed);
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

/// Space around the reason of a refusal that lies over what follows, in points, and the least room for its words.
const INSET: egui::Vec2 = egui::vec2(6.0, 3.0);
const LEAST_WIDTH: f32 = 180.0;
const MOST_WIDTH: f32 = 300.0;

/// Why a field was refused, under `field`, over what follows it: a refusal moves nothing and takes no press.
pub(crate) fn refusal_over(ui: &egui::Ui, field: egui::Rect, reason: Option<&str>) {
    let Some(reason) = reason else { return };
    let palette = theme::palette(ui);
    let room = ui.clip_rect().shrink2(egui::vec2(INSET.x, 0.0));
    let left = field.left().min(room.right() - LEAST_WIDTH - 2.0 * INSET.x).max(room.left());
    let width = (room.right() - left - 2.0 * INSET.x).min(MOST_WIDTH);
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = ui.painter().layout(reason.to_owned(), font, palette.wrong, width);
    let size = galley.size() + 2.0 * INSET;
    let below = field.bottom() + 2.0;
    let top = if below + size.y <= room.bottom() { below } else { field.top() - 2.0 - size.y };
    let rect = egui::Rect::from_min_size(egui::pos2(left, top), size);
    // Over its page, under what opens over that.
    let order = if ui.layer_id().order == egui::Order::Background {
        egui::Order::Middle
    } else {
        egui::Order::Tooltip
    };
    let layer = egui::LayerId::new(order, ui.scope_id().with("refusal"));
    let painter = ui.painter().clone().with_layer_id(layer);
    let rim = egui::Stroke::new(1.0, palette.wrong);
    painter.rect(rect, 4.0, palette.panel, rim, egui::StrokeKind::Inside);
    painter.galley(rect.min + INSET, galley, palette.wrong);
    let seen = ui.interact(rect, ui.scope_id().with(("refusal", reason)), egui::Sense::hover());
    seen.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, reason));
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
