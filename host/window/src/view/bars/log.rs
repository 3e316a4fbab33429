//! The log: successes and failures, each line whole, with a filter and a copy button. It is a drawer over the lower row, which the
//! status line opens.

use crate::intent::{Intent, Intents};
use crate::scene::Scene;
use crate::view::kept::LogView;
use crate::view::stage::aligned;
use crate::view::theme;
use eframe::egui::{
    self, Align2, Color32, FontId, Galley, Pos2, Rect, ScrollArea, Sense, TextStyle, pos2, vec2,
};
use slipline_link::{LogEntry, Severity};
use std::sync::Arc;

/// Width of the filter, in points.
const FILTER: f32 = 110.0;
/// Space between the time and the words of a line, and under a line, in points.
const BESIDE: f32 = 8.0;
const UNDER: f32 = 4.0;

const LEVELS: [(Severity, &str); 4] = [
    (Severity::Detail, "all"),
    (Severity::Info, "info"),
    (Severity::Warning, "warnings"),
    (Severity::Error, "errors"),
];

/// What is shown from a level on.
fn level_help(level: Severity) -> &'static str {
    match level {
        Severity::Detail => "All lines, including those of the link",
        Severity::Info => "Actions and all errors",
        Severity::Warning => "Warnings and errors only",
        Severity::Error => "Only what failed",
    }
}

/// The button that opens and closes the log.
pub(crate) fn switch(ui: &mut egui::Ui, log: &mut LogView) {
    let button = ui.selectable_label(log.is_open, "Log");
    let name = if log.is_open { "Close the log" } else { "Open the log" };
    button.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, log.is_open, name));
    if button.on_hover_text("What was done and what failed, line by line, over the lower row").clicked() {
        log.is_open = !log.is_open;
    }
}

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, log: &mut LogView, intents: &mut Intents) {
    let needle = log.filter.to_lowercase();
    let shown: Vec<&LogEntry> = scene
        .snapshot
        .record
        .log
        .iter()
        .filter(|entry| entry.severity >= log.least)
        .filter(|entry| needle.is_empty() || entry.text.to_lowercase().contains(&needle))
        .collect();
    aligned::headed(ui, "Log", |ui| {
        let edit = egui::TextEdit::singleline(&mut log.filter).hint_text("find");
        let field = ui.add(edit.desired_width(FILTER).char_limit(64));
        theme::name_field(&field, "Filter the log", "", "", "find");
        field.on_hover_text("Only lines that contain this text are shown and copied");
        let name = LEVELS.iter().find(|(level, _)| *level == log.least).map_or("", |(_, name)| name);
        let chosen = egui::ComboBox::from_id_salt("log level").selected_text(name).width(96.0).truncate();
        let response = chosen.show_ui(ui, |ui| {
            for (level, name) in LEVELS {
                ui.selectable_value(&mut log.least, level, name).on_hover_text(level_help(level));
            }
        });
        response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Log level"));
        response.response.on_hover_text("The least serious lines that are shown and copied");
        let copy = ui.small_button("Copy").on_hover_text("Copy the lines shown");
        if copy.clicked() {
            let text: Vec<String> = shown.iter().map(ToString::to_string).collect();
            intents.push(Intent::Copy(text.join("\n")));
        }
    });
    let area = ScrollArea::vertical().id_salt("log").stick_to_bottom(true).auto_shrink([false, false]);
    area.show_viewport(ui, |ui, seen| lines(ui, &shown, seen));
}

fn ink(ui: &egui::Ui, severity: Severity) -> Color32 {
    let palette = theme::palette(ui);
    match severity {
        Severity::Detail => palette.weak,
        Severity::Info => palette.text,
        Severity::Warning => palette.warn,
        Severity::Error => palette.wrong,
    }
}

/// The lines, of which those in `seen` are painted. A line that is longer than the row is wide goes on in another row.
fn lines(ui: &mut egui::Ui, shown: &[&LogEntry], seen: Rect) {
    theme::clear_of_bar(ui);
    let font = TextStyle::Small.resolve(ui.style());
    let seconds = |entry: &LogEntry| format!("{:.2}", entry.time.as_secs_f64());
    // All times share one column; the latest time is the longest.
    let times = shown
        .last()
        .map_or(0.0, |latest| theme::text_width(ui, &"0".repeat(seconds(latest).len()), font.clone()));
    let width = (ui.available_width() - times - BESIDE).max(1.0);
    let origin = ui.max_rect().min;
    let mut top = 0.0;
    for (number, entry) in shown.iter().enumerate() {
        let words = whole(ui, &entry.text, &font, ink(ui, entry.severity), width);
        let size = words.size();
        if seen.y_range().intersects(egui::Rangef::new(top, top + size.y)) {
            let at = pos2(origin.x, origin.y + top);
            let said = Said { seconds: seconds(entry), entry, number };
            line(ui, at, times, words, &said, &font);
        }
        top += size.y + UNDER;
    }
    ui.allocate_space(vec2(ui.available_width(), top));
}

/// What is said of a line.
struct Said<'a> {
    seconds: String,
    entry: &'a LogEntry,
    number: usize,
}

/// One line: its time, and its words.
fn line(ui: &egui::Ui, at: Pos2, times: f32, words: Arc<Galley>, said: &Said<'_>, font: &FontId) {
    let place = at + vec2(times + BESIDE, 0.0);
    let rect = Rect::from_min_max(at, place + words.size());
    let weak = theme::palette(ui).weak;
    ui.painter().text(at + vec2(times, 0.0), Align2::RIGHT_TOP, &said.seconds, font.clone(), weak);
    ui.painter().galley(place, words, weak);
    let line = ui.interact(rect, ui.scope_id().with(("line", said.number)), Sense::hover());
    // With its time, by which it differs from a message of the same words.
    let name = format!("{} s: {}", said.seconds, said.entry.text);
    line.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
}

/// All of a text, in as many rows as it needs.
fn whole(ui: &egui::Ui, text: &str, font: &FontId, ink: Color32, width: f32) -> Arc<Galley> {
    ui.painter().layout(text.to_owned(), font.clone(), ink, width)
}
