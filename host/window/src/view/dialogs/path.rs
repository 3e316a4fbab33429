//! The page for typing a path, on a system without a file dialog.

use crate::intent::{Intent, Intents, PathQuestion};
use crate::view::fields::lines::lines;
use crate::view::kept::TypedPath;
use crate::view::theme;
use eframe::egui::{self, Key, RichText};

/// Shows the question; returns whether it was cancelled.
pub(super) fn show(
    ui: &mut egui::Ui,
    question: &PathQuestion,
    path: &mut Option<TypedPath>,
    intents: &mut Intents,
) -> bool {
    let is_new = path.as_ref().is_none_or(|typed| typed.question != *question);
    let typed = match path {
        Some(typed) if !is_new => typed,
        state => state.insert(TypedPath { question: question.clone(), text: question.offered.clone() }),
    };
    let palette = theme::palette(ui);
    ui.heading(question.title);
    ui.add_space(6.0);
    let why = "This system offers no dialog for files (a desktop portal or zenity would): type the path.";
    ui.add(egui::Label::new(RichText::new(why).color(palette.weak)).wrap());
    ui.add_space(4.0);
    let edit = egui::TextEdit::singleline(&mut typed.text).desired_width(f32::INFINITY);
    let field = ui.add(edit);
    theme::name_field(&field, "File path", &question.offered, &typed.text, "");
    let field = field.on_hover_text("A path of this computer, such as /home/me/plate.toml");
    if is_new {
        field.request_focus();
    }
    // The warning applies only to the path whose file was found, not to a text that was edited since.
    let is_replacing = question.existing.as_deref() == Some(typed.text.trim());
    let warning =
        if is_replacing { "A file of that name exists. Replace it, or type another name." } else { "" };
    lines(ui, warning, palette.warn, 1);
    ui.add_space(6.0);
    let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    ui.horizontal(|ui| {
        let verb = if is_replacing { "Replace" } else { question.verb };
        let is_typed = !typed.text.trim().is_empty();
        // Keeps its width when its label changes, so that Cancel does not move.
        let button = theme::primary(ui, verb, is_typed).min_size(egui::vec2(80.0, 0.0));
        let button = ui.add_enabled(is_typed, button).on_hover_text("Use the typed path");
        let is_pressed = button.on_disabled_hover_text("Type a path first").clicked();
        // To replace a file, the user must press the button that says so; Enter is not enough.
        if is_pressed || (is_entered && !is_replacing && !typed.text.trim().is_empty()) {
            intents.push(Intent::Path(typed.text.trim().to_owned(), is_replacing));
        }
        ui.button("Cancel").on_hover_text("Open and write nothing").clicked()
    })
    .inner
}
