//! The page of measurements: their list, the values of the chosen one, and its agreement with the plate on the screen.

use crate::intent::{Asks as _, CalibrateIntent, Dialog, Intent, Intents, MeasureIntent};
use crate::scene::Scene;
use crate::view::bars::tour;
use crate::view::fields::{field::row, foreign_form, measure_form};
use crate::view::panels::validity;
use crate::view::plots::response::inks::ink;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Rect, RichText, Sense, pos2, vec2};
use slipline_instrument::TourStep;
use slipline_model::response::{Entry, Headroom, differs};
use slipline_plate::quantity::number_format::significant;
use slipline_plate::quantity::{decibels, show_frequency, show_place};

const OPEN_HELP: &str = "A CSV of this page, or what another program measured: a table of frequency and level, text of REW, .frd, a universal file (58)";
/// The formats of recordings that are read.
const RECORDINGS: &str = if cfg!(target_arch = "wasm32") { "WAV" } else { "WAV, FLAC, ALAC (M4A) or AIFF" };
const CALIBRATE_HELP: &str =
    "Fit the plate to the measured response at two places: its speed, its loss, the gain of its drive";
const HARMONICS_HELP: &str = "Measure the second and third harmonic that the drive adds to tones, by the sensor near the driven end, at this level; the \
     plate states them then, and the page Boundary can cancel them";
/// Width of a measurement's colour in the list, in points.
const SWATCH: f32 = 12.0;
/// Width of the button that removes one, in points.
const REMOVE: f32 = 24.0;

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let shelf = scene.measure.shelf;
    ui.horizontal(|ui| {
        let help = format!(
            "{OPEN_HELP}; or a recording of `slipline sweep` (here: {RECORDINGS}); or drop it on the window"
        );
        ui.button("Open measurement…")
            .on_hover_text(help)
            .asks(intents, Intent::Measure(MeasureIntent::OpenFile));
        let calibrate = ui.button("Calibrate…");
        tour::mark(ui, scene, TourStep::Calibrate, calibrate.rect);
        calibrate.on_hover_text(CALIBRATE_HELP).asks(intents, Intent::Calibrate(CalibrateIntent::Open));
    });
    if scene.dialog != Some(&Dialog::Calibrate) {
        foreign_form::show(ui, scene, &mut view.fields, intents);
        measure_form::show(ui, scene, &mut view.fields, None, intents);
        let may = scene.measure.live.progress.is_none();
        ui.add_enabled(may, egui::Button::new("Measure harmonics"))
            .on_hover_text(HARMONICS_HELP)
            .on_disabled_hover_text("It is being measured")
            .asks(intents, Intent::Measure(MeasureIntent::Harmonics));
    }
    if shelf.entries().is_empty() {
        let text = "Measured response over frequency: level and phase beside the model of this plate, and the noise.";
        ui.add(egui::Label::new(RichText::new(text).color(palette.weak)).wrap());
        return;
    }
    ui.add_space(2.0);
    let chosen = shelf.chosen();
    for entry in shelf.entries() {
        let is_chosen = chosen.is_some_and(|chosen| chosen.number == entry.number);
        listed(ui, entry, is_chosen, intents);
    }
    ui.separator();
    if let Some(chosen) = chosen {
        details(ui, scene, chosen, intents);
    }
}

/// A measurement in the list: whether it is drawn, its colour and name, and the button that removes it.
fn listed(ui: &mut egui::Ui, entry: &Entry, is_chosen: bool, intents: &mut Intents) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let mut is_shown = entry.is_shown;
        let switch = ui.checkbox(&mut is_shown, "");
        switch.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::CheckBox, true, is_shown, format!("Show {}", entry.name))
        });
        switch
            .on_hover_text("Draw its curve beside the others")
            .asks(intents, Intent::Measure(MeasureIntent::Show(entry.number, is_shown)));
        let (swatch, _) = ui.allocate_exact_size(vec2(SWATCH, 18.0), Sense::hover());
        let half = if is_chosen { 2.0 } else { 1.0 };
        let line =
            Rect::from_x_y_ranges(swatch.x_range(), swatch.center().y - half..=swatch.center().y + half);
        ui.painter().rect_filled(line, 0.0, ink(entry.number, palette));
        let room = (ui.available_width() - REMOVE - 4.0).max(0.0);
        // An empty text at the right moves the name to the left.
        let name = egui::Button::selectable(is_chosen, &entry.name).truncate().right_text("");
        let name = ui.add_sized(vec2(room, REMOVE), name);
        name.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_chosen, &entry.name));
        name.on_hover_text(
            "Choose it: the plate's model is compared with it, and its numbers are shown below",
        )
        .asks(intents, Intent::Measure(MeasureIntent::Choose(entry.number)));
        let remove = ui.add(egui::Button::new("×").frame(false).min_size(vec2(REMOVE, REMOVE)));
        remove.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Remove {}", entry.name))
        });
        remove
            .on_hover_text("Remove it from the list; its file stays")
            .asks(intents, Intent::Measure(MeasureIntent::Remove(entry.number)));
    });
}

/// The values of the chosen measurement.
fn details(ui: &mut egui::Ui, scene: &Scene<'_>, entry: &Entry, intents: &mut Intents) {
    let palette = theme::palette(ui);
    let sentence = |ui: &mut egui::Ui, text: &str, colour| {
        ui.add(egui::Label::new(RichText::new(text).color(colour)).wrap());
    };
    match scene.measure.compared {
        None => sentence(ui, "Being compared with the plate's model…", palette.weak),
        Some(Err(reason)) => sentence(ui, &reason.to_string(), palette.wrong),
        Some(Ok(comparison)) => {
            let (is_off, text) = differs(comparison);
            sentence(ui, &text, if is_off { palette.wrong } else { palette.good });
            if comparison.level_db != 0.0 {
                let text = "The level is not compared: the sensor is not calibrated.";
                ui.add(egui::Label::new(RichText::new(text).small().color(palette.weak)).wrap());
            }
        }
    }
    ui.add_space(2.0);
    let headroom = Headroom::of(&entry.measurement);
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let (place, _) = ui.allocate_exact_size(vec2(12.0, 18.0), Sense::hover());
        let colour = validity::ink(headroom.colour(), palette);
        validity::mark(ui.painter(), pos2(place.left() + 6.0, place.center().y), headroom.colour(), colour);
        let text = format!("Headroom: {}", headroom.sentence());
        let label = ui.add(egui::Label::new(text).wrap());
        let name = format!("Headroom: {}", headroom.colour().name());
        label.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    });
    ui.add_space(2.0);
    let measurement = &entry.measurement;
    row(ui, "Sensor", measurement.sensor.word());
    row(
        ui,
        "Place",
        format!("{} ± {:.1} mm", show_place(measurement.place_m), 1e3 * measurement.place_tolerance_m),
    );
    if let Some(body) = measurement.body() {
        let mass_mg = significant(1e6 * body.mass_kg, 3);
        row(ui, "Sensor's mass", format!("{mass_mg} mg on {}", show_place(body.width_m)));
    }
    if let Some((first, last)) = measurement.points.first().zip(measurement.points.last()) {
        let (low, high) = (show_frequency(first.frequency_hz), show_frequency(last.frequency_hz));
        row(ui, "Frequencies", format!("{} from {low} to {high}", measurement.points.len()));
    }
    let audible = measurement.points.iter().map(|point| point.response.norm() / point.noise);
    let best = audible.fold(0.0, f64::max);
    row(ui, "Loudest over the noise", format!("{:.0} dB", decibels(best.max(f64::MIN_POSITIVE))));
    ui.add_space(4.0);
    ui.button("Export CSV…")
        .on_hover_text("The chosen measurement as this page reads it")
        .asks(intents, Intent::Measure(MeasureIntent::Save(entry.number)));
}
