//! Messages to the user. They stand at the bottom of the panel at the side, which gives them room: they cover nothing.

use super::{Scene, ViewState, theme};
use crate::intent::{Intent, Intents};
use crate::scene::Notice;
use eframe::egui::{self, RichText, Sense};
use std::time::Duration;

/// Since when messages stand: their numbers, and the window's time in seconds.
pub(crate) type Since = Vec<(u64, f64)>;

/// How long a message stands that tells of nothing wrong, in seconds.
const NOTICE_S: f64 = 5.0;

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let now_s = ui.input(|input| input.time);
    view.notices.retain(|(number, _)| scene.notices.iter().any(|notice| notice.number == *number));
    let mut shown: Vec<&Notice> = Vec::new();
    for &notice in &scene.notices {
        let known = view.notices.iter().find(|(number, _)| *number == notice.number).map(|(_, since)| *since);
        let since_s = known.unwrap_or_else(|| {
            view.notices.push((notice.number, now_s));
            now_s
        });
        let left_s = since_s + NOTICE_S - now_s;
        if notice.is_error {
            shown.push(notice);
        } else if left_s > 0.0 {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(left_s));
            shown.push(notice);
        } else {
            intents.push(Intent::DismissNotice(notice.number));
        }
    }
    if shown.is_empty() {
        return;
    }
    let panel = egui::Panel::bottom("notices").frame(egui::Frame::NONE).resizable(false);
    panel.show_separator_line(false).show(ui, |ui| {
        for notice in shown {
            if message(ui, notice) {
                intents.push(Intent::DismissNotice(notice.number));
            }
        }
    });
}

/// One message; returns whether it was pressed.
fn message(ui: &mut egui::Ui, notice: &Notice) -> bool {
    let palette = theme::palette(ui);
    let colour = if notice.is_error { palette.bad } else { palette.accent };
    let frame = egui::Frame::popup(ui.style()).stroke(egui::Stroke::new(1.5, colour));
    let width = (ui.available_width() - frame.total_margin().sum().x).max(40.0);
    frame
        .shadow(egui::Shadow::NONE)
        .show(ui, |ui| {
            ui.set_width(width);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
                let is_dismissed = ui.button("Dismiss").clicked();
                let text = RichText::new(&notice.text).color(palette.text);
                // A click on the words dismisses them, too; the Tab key has the button.
                let label = egui::Label::new(text).wrap().selectable(false).sense(Sense::CLICK);
                let words =
                    ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| ui.add(label)).inner;
                is_dismissed || words.clicked()
            })
            .inner
        })
        .inner
}
