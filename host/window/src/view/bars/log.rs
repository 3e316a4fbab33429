//! The log: successes and failures, with a filter and a copy button.

use crate::intent::{Intent, Intents};
use crate::scene::Scene;
use crate::view::kept::LogView;
use crate::view::stage::aligned::{self, Width};
use crate::view::theme;
use eframe::egui::{self, RichText, ScrollArea};
use slipline_link::{LogEntry, Severity};

/// Width of the heading and the space after it, in points.
const LEAST_HEADING: f32 = 34.0;
/// Width of the button at the end and the space before it, in points.
const COPY: f32 = 60.0;
/// The least width of the filter, in points; with less space it is left out.
const LEAST_FILTER: f32 = 46.0;

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

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, log: &mut LogView, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let needle = log.filter.to_lowercase();
    let shown: Vec<&LogEntry> = scene
        .snapshot
        .record
        .log
        .iter()
        .filter(|entry| entry.severity >= log.least)
        .filter(|entry| needle.is_empty() || entry.text.to_lowercase().contains(&needle))
        .collect();
    let room = ui.available_width() - LEAST_HEADING;
    aligned::headed(ui, "Log", |ui| {
        let rest = Width::of(ui, "level and copy");
        let width = room - rest.points() - 2.0 * ui.spacing().item_spacing.x;
        // An active filter stays visible, because it hides lines.
        if width >= LEAST_FILTER || !log.filter.is_empty() {
            // A hint that fits a narrow field.
            let edit = egui::TextEdit::singleline(&mut log.filter).hint_text("find");
            let field = ui.add(edit.desired_width(width.clamp(40.0, 110.0)).char_limit(64));
            theme::name_field(&field, "Filter the log", "", "", "find");
            field.on_hover_text("Only lines that contain this text are shown and copied");
        }
        let name = LEVELS.iter().find(|(level, _)| *level == log.least).map_or("", |(_, name)| name);
        // In narrow rows it leaves some space to the filter.
        let width = if room >= 220.0 { 96.0 } else { (room - COPY - 54.0).clamp(40.0, 62.0) };
        let chosen = egui::ComboBox::from_id_salt("log level").selected_text(name).width(width).truncate();
        let response = chosen.show_ui(ui, |ui| {
            for (level, name) in LEVELS {
                ui.selectable_value(&mut log.least, level, name).on_hover_text(level_help(level));
            }
        });
        response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Log level"));
        let response = response.response.on_hover_text("The least serious lines that are shown and copied");
        let copy = ui.small_button("Copy").on_hover_text("Copy the lines shown");
        if copy.clicked() {
            let text: Vec<String> = shown.iter().map(ToString::to_string).collect();
            intents.push(Intent::Copy(text.join("\n")));
        }
        rest.note(ui, copy.rect.right() - response.rect.left());
    });
    // All times share one column; the latest time is the longest.
    let seconds = |entry: &LogEntry| format!("{:.2}", entry.time.as_secs_f64());
    let font = egui::TextStyle::Small.resolve(ui.style());
    let times =
        shown.last().map_or(0.0, |latest| theme::text_width(ui, &"0".repeat(seconds(latest).len()), font));
    let height = ui.text_style_height(&egui::TextStyle::Small) + 3.0;
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = height;
    let area = ScrollArea::vertical().id_salt("log").stick_to_bottom(true).auto_shrink([false, false]);
    area.show_rows(ui, height, shown.len(), |ui, rows| {
        theme::clear_of_bar(ui);
        for entry in shown.get(rows).unwrap_or_default() {
            let colour = match entry.severity {
                Severity::Detail => palette.weak,
                Severity::Info => palette.text,
                Severity::Warning => palette.warn,
                Severity::Error => palette.wrong,
            };
            ui.horizontal(|ui| {
                let column = egui::vec2(times, ui.spacing().interact_size.y);
                let right = egui::Layout::right_to_left(egui::Align::Center);
                ui.allocate_ui_with_layout(column, right, |ui| {
                    ui.label(RichText::new(seconds(entry)).small().color(palette.weak));
                });
                let text = RichText::new(&entry.text).small().color(colour);
                let line = ui.add(egui::Label::new(text).truncate());
                // With its time, by which it differs from a message of the same words.
                let said = format!("{} s: {}", seconds(entry), entry.text);
                line.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &said));
                line.on_hover_text(&entry.text);
            });
        }
    });
}
