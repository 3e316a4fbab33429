//! Messages to the user, as compact lines at the bottom of the side panel. Their area is limited to a share of the
//! panel: more messages scroll, and a long message is cut and shown in full when it is pressed.

use crate::intent::{Intent, Intents};
use crate::scene::Notice;
use crate::scene::Scene;
use crate::view::theme;
use eframe::egui::{self, Label, ScrollArea, Sense, text::LayoutJob};
use std::time::Duration;

/// The state of a shown message.
pub(crate) struct Shown {
    number: u64,
    /// The time at which it was shown first, in seconds of the window's clock.
    since_s: f64,
    /// Whether it is shown in full.
    is_open: bool,
}

/// The messages that are shown.
pub(crate) type Seen = Vec<Shown>;

/// The share of the panel's height for messages, and the smallest and largest height in points.
const SHARE: f32 = 0.3;
const HEIGHT: (f32, f32) = (44.0, 140.0);
/// In a panel lower than this, in points, a message gets one line, else two.
const ROOM_FOR_TWO: f32 = 380.0;
/// Size of the button that dismisses a message, in points.
const BUTTON: f32 = 24.0;

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, seen: &mut Seen, intents: &mut Intents) {
    let now_s = ui.input(|input| input.time);
    seen.retain(|seen| scene.notices.iter().any(|notice| notice.number == seen.number));
    let mut shown: Vec<(&Notice, bool)> = Vec::new();
    for &notice in &scene.notices {
        let known = seen.iter().position(|seen| seen.number == notice.number);
        let known = known.unwrap_or_else(|| {
            seen.push(Shown { number: notice.number, since_s: now_s, is_open: false });
            seen.len() - 1
        });
        let seen = &seen[known];
        // A message that is shown in full stays until it is dismissed.
        let left_s = notice.lasts_s.filter(|_| !seen.is_open).map(|lasts_s| seen.since_s + lasts_s - now_s);
        match left_s {
            Some(left_s) if left_s <= 0.0 => intents.push(Intent::DismissNotice(notice.number)),
            left_s => {
                if let Some(left_s) = left_s {
                    ui.ctx().request_repaint_after(Duration::from_secs_f64(left_s));
                }
                shown.push((notice, seen.is_open));
            }
        }
    }
    if shown.is_empty() {
        return;
    }
    let height = ui.available_height();
    let rows = if height < ROOM_FOR_TWO { 1 } else { 2 };
    let most = (SHARE * height).clamp(HEIGHT.0, HEIGHT.1);
    let panel = egui::Panel::bottom("notices").frame(egui::Frame::NONE).resizable(false);
    panel.show_separator_line(false).show(ui, |ui| {
        let area = ScrollArea::vertical().max_height(most).auto_shrink([false, true]);
        area.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 3.0;
            for (notice, is_open) in shown {
                match message(ui, notice, if is_open { usize::MAX } else { rows }) {
                    Press::None => {}
                    Press::Open => {
                        for seen in seen.iter_mut().filter(|seen| seen.number == notice.number) {
                            seen.is_open = true;
                        }
                    }
                    Press::Dismiss => intents.push(Intent::DismissNotice(notice.number)),
                }
            }
        });
    });
}

/// The effect of a press on a message.
enum Press {
    None,
    Open,
    Dismiss,
}

/// One message in at most `rows` rows.
fn message(ui: &mut egui::Ui, notice: &Notice, rows: usize) -> Press {
    let palette = theme::palette(ui);
    let colour = if notice.is_error { palette.bad } else { palette.accent };
    let frame = egui::Frame::new()
        .fill(palette.well)
        .stroke(egui::Stroke::new(1.0, colour))
        .corner_radius(4)
        .inner_margin(egui::Margin { left: 8, right: 2, top: 1, bottom: 1 });
    let width = (ui.available_width() - frame.total_margin().sum().x).max(2.0 * BUTTON);
    let press = frame.show(ui, |ui| {
        ui.set_width(width);
        // The button stays at the top, in sight beside a message that is scrolled.
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let font = egui::TextStyle::Body.resolve(ui.style());
            let room = width - BUTTON - 4.0;
            let mut job = LayoutJob::simple(notice.text.clone(), font, palette.text, room);
            job.wrap.max_rows = rows;
            let galley = ui.painter().layout_job(job);
            let is_cut = galley.elided;
            let height = galley.size().y.max(BUTTON);
            let layout = egui::Layout::left_to_right(egui::Align::Center);
            let words = ui.allocate_ui_with_layout(egui::vec2(room, height), layout, |ui| {
                ui.set_min_width(room);
                // The button has the keyboard focus.
                ui.add(Label::new(galley).selectable(false).sense(Sense::CLICK))
            });
            let mut words = words.inner;
            if is_cut {
                words = words.on_hover_text(&notice.text);
            }
            let button = egui::Button::new("×").frame(false).min_size(egui::vec2(BUTTON, BUTTON));
            let button = ui.add(button);
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Dismiss"));
            match (words.clicked(), is_cut) {
                _ if button.on_hover_text("Put this message away").clicked() => Press::Dismiss,
                (true, true) => Press::Open,
                (true, false) => Press::Dismiss,
                (false, _) => Press::None,
            }
        })
        .inner
    });
    press.inner
}
