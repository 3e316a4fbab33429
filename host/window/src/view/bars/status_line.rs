//! The status line at the bottom of the window: the messages beside each other, in two rows of small words where one is too
//! short. One that is cut opens over the line when it is pressed. The line is always there and as high, so no message moves
//! anything.

use crate::intent::{Intent, Intents};
use crate::scene::Notice;
use crate::scene::Scene;
use crate::view::bars::top_bar;
use crate::view::kept::{Seen, SeenNotice};
use crate::view::theme;
use eframe::egui::{
    self, Align2, FontId, Galley, Label, Rect, ScrollArea, Sense, UiBuilder, text::LayoutJob, vec2,
};
use std::sync::Arc;
use std::time::Duration;

/// Height of the line and of a message, in points.
pub(crate) const HEIGHT: f32 = 34.0;
const MESSAGE: f32 = 31.0;
/// Size of the button that dismisses a message, and the space between two messages, in points.
const BUTTON: f32 = 24.0;
const BESIDE: f32 = 6.0;
/// Largest size of a message that is shown in full, in points; it is scrolled if it is longer.
const WHOLE: [f32; 2] = [560.0, 240.0];

/// Shows the line in the rest of `ui`.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, seen: &mut Seen, intents: &mut Intents) {
    let shown = current(ui, scene, seen, intents);
    let area = ui.available_rect_before_wrap();
    let room = ui.allocate_rect(area, Sense::hover());
    if shown.is_empty() {
        let palette = theme::palette(ui);
        let (_, _, sentence) = top_bar::state_words(scene, palette);
        let galley = fitting(ui, &sentence, FontId::proportional(12.5), palette.weak, area.width());
        if galley.elided {
            room.on_hover_text(sentence);
        }
        let place = Align2::LEFT_CENTER.anchor_size(area.left_center(), galley.size());
        ui.painter().galley(place.min, galley, palette.weak);
        return;
    }
    let first = shown.first().map_or(0.0, |(notice, _)| whole_width(ui, &notice.text));
    let widths = widths(area.width(), first, shown.len());
    let mut left = area.left();
    let hidden = shown.len() - widths.len();
    for ((notice, is_open), width) in shown.into_iter().zip(widths) {
        let begin = left;
        left += width + BESIDE;
        let rect =
            Rect::from_min_size(egui::pos2(begin, area.center().y - 0.5 * MESSAGE), vec2(width, MESSAGE));
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let mut cell = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(notice.number).layout(layout));
        match message(&mut cell, notice, rect, is_open) {
            Press::None => {}
            Press::Open => {
                for seen in seen.iter_mut().filter(|seen| seen.number == notice.number) {
                    seen.is_open = !is_open;
                }
            }
            Press::Dismiss => intents.push(Intent::DismissNotice(notice.number)),
        }
        if is_open {
            whole(ui, notice, rect);
        }
    }
    if hidden > 0 {
        let rest = Rect::from_min_max(egui::pos2(left, area.top()), area.max);
        more(ui, rest, hidden);
    }
}

/// How many messages wait, beside one that needs the room.
fn more(ui: &egui::Ui, rect: Rect, count: usize) {
    let palette = theme::palette(ui);
    let words = format!("+{count}");
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, &words, FontId::proportional(13.0), palette.text);
    let seen = ui.interact(rect, ui.scope_id().with("more messages"), Sense::hover());
    seen.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("{count} more messages")));
    seen.on_hover_text("More messages, for which there is no room beside the first one: the log has them");
}

/// The least width of a message beside the first one, in points: some words, and its button.
const LEAST: f32 = 130.0;
/// Width of the number of messages that have no room beside the first one, in points.
const MORE: f32 = 34.0;
/// The share of a message's width in one row that it needs in two rows of smaller words.
const IN_TWO_ROWS: f32 = 0.6;

/// The width of a message that shows all of `text`, in points.
fn whole_width(ui: &egui::Ui, text: &str) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    theme::text_width(ui, text, font) + BUTTON + 20.0
}

/// The widths of `count` messages in a line of this width, in points: equal ones, but the first is whole as far as the others
/// leave it room, because its instruction stands at its end. Where it would be cut in two rows, too, it stands alone.
fn widths(room: f32, first: f32, count: usize) -> Vec<f32> {
    let others = count.saturating_sub(1) as f32;
    let equal = (room - BESIDE * others) / (others + 1.0);
    let most = room - others * (LEAST + BESIDE);
    if count > 1 && IN_TWO_ROWS * first > most {
        return vec![(room - MORE - BESIDE).max(0.0)];
    }
    let first = first.min(most).max(equal);
    let rest = (room - first - BESIDE * others) / others.max(1.0);
    std::iter::once(first).chain(std::iter::repeat(rest)).take(count).collect()
}

/// The messages to show, and whether each is shown in full; those whose time is over are put away.
fn current<'a>(
    ui: &egui::Ui,
    scene: &Scene<'a>,
    seen: &mut Seen,
    intents: &mut Intents,
) -> Vec<(&'a Notice, bool)> {
    let now_s = ui.input(|input| input.time);
    seen.retain(|seen| scene.notices.iter().any(|notice| notice.number == seen.number));
    let mut shown: Vec<(&Notice, bool)> = Vec::new();
    for &notice in &scene.notices {
        let known = seen.iter().position(|seen| seen.number == notice.number);
        let known = known.unwrap_or_else(|| {
            seen.push(SeenNotice { number: notice.number, since_s: now_s, is_open: false });
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
    shown
}

/// A text in one row, or in two rows of smaller words where the room is too narrow; cut where that ends, too.
fn fitting(ui: &egui::Ui, text: &str, font: FontId, ink: egui::Color32, room: f32) -> Arc<Galley> {
    let rows = |font: FontId, rows: usize| {
        let mut job = LayoutJob::simple(text.to_owned(), font, ink, room);
        job.wrap.max_rows = rows;
        job.wrap.break_anywhere = rows == 1;
        ui.painter().layout_job(job)
    };
    let row = rows(font, 1);
    if row.elided { rows(FontId::proportional(SMALL), 2) } else { row }
}

/// Size of the words of a message in two rows, in points.
const SMALL: f32 = 12.0;

/// The colour of a message's rim.
fn rim(ui: &egui::Ui, notice: &Notice) -> egui::Stroke {
    let palette = theme::palette(ui);
    egui::Stroke::new(1.0, if notice.is_error { palette.bad } else { palette.accent })
}

/// The effect of a press on a message.
enum Press {
    None,
    /// Shows it in full, or no longer.
    Open,
    Dismiss,
}

/// One message in its part of the line.
fn message(ui: &mut egui::Ui, notice: &Notice, rect: Rect, is_open: bool) -> Press {
    let palette = theme::palette(ui);
    ui.painter().rect(rect, 4.0, palette.well, rim(ui, notice), egui::StrokeKind::Inside);
    ui.spacing_mut().item_spacing.x = 0.0;
    ui.add_space(8.0);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let room = (rect.width() - BUTTON - 10.0).max(BUTTON);
    let galley = fitting(ui, &notice.text, font, palette.text, room);
    let is_cut = galley.elided;
    // The whole part of the line is pressed, however short the words; the button has the keyboard focus.
    let (place, mut words) = ui.allocate_exact_size(vec2(room, MESSAGE), Sense::CLICK);
    let at = Align2::LEFT_CENTER.anchor_size(place.left_center(), galley.size());
    ui.painter().galley(at.min, galley, palette.text);
    let said = if is_open { "The message above, cut" } else { &notice.text };
    words.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, said));
    if is_cut && !is_open {
        words = words.on_hover_text("Press to read all of it; the log has it, too");
    }
    let button = egui::Button::new("×").frame(false).min_size(vec2(BUTTON, BUTTON));
    let button = ui.add(button);
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Dismiss"));
    match (words.clicked(), is_cut) {
        _ if button.on_hover_text("Put this message away").clicked() => Press::Dismiss,
        (true, true) => Press::Open,
        (true, false) => Press::Dismiss,
        (false, _) => Press::None,
    }
}

/// The whole text of a message, over its place in the line.
fn whole(ui: &egui::Ui, notice: &Notice, place: Rect) {
    let palette = theme::palette(ui);
    let width = WHOLE[0].min(ui.ctx().content_rect().width() - 2.0 * BESIDE);
    let area = egui::Area::new(ui.scope_id().with(("whole", notice.number)))
        .order(egui::Order::Foreground)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(place.left_top() - vec2(0.0, 4.0))
        .constrain_to(ui.ctx().content_rect());
    area.show(ui.ctx(), |ui| {
        let frame = egui::Frame::popup(ui.style()).fill(palette.panel).stroke(rim(ui, notice));
        frame.show(ui, |ui| {
            ui.set_width(width - frame.total_margin().sum().x);
            ScrollArea::vertical().max_height(WHOLE[1]).show(ui, |ui| {
                theme::clear_of_bar(ui);
                ui.add(Label::new(&notice.text).wrap());
            });
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_message_is_whole_beside_others_as_long_as_they_have_room() {
        assert_eq!(widths(1000.0, 300.0, 1), [1000.0]);
        // Equal parts suffice.
        assert_eq!(widths(1006.0, 300.0, 2), [500.0, 500.0]);
        assert_eq!(widths(1006.0, 800.0, 2), [800.0, 200.0]);
        assert_eq!(widths(1006.0, 1300.0, 2), [1006.0 - LEAST - BESIDE, LEAST], "in two rows");
        assert_eq!(widths(1006.0, 2000.0, 2), [1006.0 - MORE - BESIDE], "alone");
        assert_eq!(widths(300.0, 400.0, 3), [300.0 - MORE - BESIDE]);
        let three = widths(1012.0, 600.0, 3);
        assert_eq!(three.iter().sum::<f32>() + 2.0 * BESIDE, 1012.0);
        assert_eq!(three[0], 600.0);
    }
}
