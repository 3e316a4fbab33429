//! The pages of a calibration: one step a page, back and cancel at each.

mod drawing;
mod known;
mod result;
mod signal;

use crate::intent::{Asks as _, CalibrateIntent, DeviceIntent, Intent, Intents};
use crate::scene::Scene;
use crate::view::fields::{foreign_form, measure_form};
use crate::view::panels::validity;
use crate::view::plots::response::inks::ink;
use crate::view::stage::aligned;
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Label, RichText, Sense, vec2};
use slipline_instrument::calibration::{CalibrationWizard, WizardPage};
use slipline_instrument::fault_sentence;
use slipline_model::response::Headroom;
use slipline_plate::quantity::show_place;

/// Shows the open page, without its buttons.
pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let Some(shown) = &scene.calibration else { return };
    let palette = theme::palette(ui);
    let calibration = shown.calibration;
    let step = calibration.step;
    ui.horizontal(|ui| {
        ui.heading(format!("Calibrate: {}", lower(step.title())));
        ui.label(
            RichText::new(format!("{} of {}", step.number(), WizardPage::ALL.len())).color(palette.weak),
        );
    });
    ui.add_space(6.0);
    // The bar with its offers lies behind this page.
    if let Some(fault) = fault_sentence(scene.snapshot) {
        wrapped(ui, RichText::new(fault).color(palette.wrong));
        ui.button("Clear fault")
            .on_hover_text("Clear the latched faults whose cause is gone; then measure again")
            .asks(intents, Intent::Device(DeviceIntent::ClearFaults));
        ui.add_space(6.0);
    }
    match step {
        WizardPage::Plate => known::show(ui, calibration, view, intents),
        WizardPage::FirstPlace => {
            place(ui, calibration, 0);
            wrapped(ui, RichText::new(calibration.sensor_note()).small().color(palette.weak));
            signal::show(ui, scene, intents);
        }
        WizardPage::FirstAnswer => answer(ui, scene, view, calibration, 0, intents),
        WizardPage::SecondPlace | WizardPage::Check => {
            let Some(sensor) = step.sensor() else { return };
            place(ui, calibration, sensor);
            signal::show(ui, scene, intents);
            ui.add_space(6.0);
            answer(ui, scene, view, calibration, sensor, intents);
        }
        WizardPage::Result => result::show(ui, shown, intents),
    }
}

fn lower(title: &str) -> String {
    let mut letters = title.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

fn wrapped(ui: &mut egui::Ui, text: impl Into<RichText>) {
    ui.add(Label::new(text.into()).wrap());
}

/// Where to put the sensor: a drawing and a sentence.
fn place(ui: &mut egui::Ui, calibration: &CalibrationWizard, sensor: usize) {
    let place_m = calibration.places_m()[sensor];
    let there = show_place(place_m);
    let text = if sensor == 0 {
        format!(
            "Put the sensor on the centre line, {there} from the driven end. Measure its place: the result cannot be \
             more accurate than this."
        )
    } else {
        format!("Move the same sensor to {there}, and change nothing else: neither its gain nor the level.")
    };
    wrapped(ui, text);
    ui.add_space(4.0);
    drawing::show(ui, calibration, sensor);
}

/// What the sensor answered at a place: taken from the list, or from a file.
fn answer(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    view: &mut ViewState,
    calibration: &CalibrationWizard,
    sensor: usize,
    intents: &mut Intents,
) {
    let palette = theme::palette(ui);
    if sensor == 0 {
        let there = show_place(calibration.places_m()[0]);
        wrapped(
            ui,
            format!(
                "The response at about {there}: measure it with the device, open a file, or choose from the list."
            ),
        );
    }
    measure_form::show(ui, scene, &mut view.fields, Some(sensor), intents);
    if sensor == 0 {
        measure_form::body(ui, scene, &mut view.fields, intents);
    }
    ui.add_space(4.0);
    if foreign_form::show(ui, scene, &mut view.fields, intents) {
        return;
    }
    let mut ask = |intent: CalibrateIntent| intents.push(Intent::Calibrate(intent));
    if ui.button("Open file…").on_hover_text("A measurement, by this app or by another program").clicked() {
        ask(CalibrateIntent::OpenAnswer);
    }
    let taken = calibration.answer(sensor);
    for entry in scene.measure.shelf.entries() {
        let is_taken =
            taken.is_some_and(|taken| std::sync::Arc::ptr_eq(&taken.measurement, &entry.measurement));
        ui.horizontal(|ui| {
            let (swatch, _) = ui.allocate_exact_size(vec2(12.0, 18.0), Sense::hover());
            let line = egui::Rect::from_center_size(swatch.center(), vec2(12.0, 3.0));
            ui.painter().rect_filled(line, 0.0, ink(entry.number, palette));
            let place = show_place(entry.measurement.place_m);
            // The name of a file may be long, and the page keeps its width.
            let name = format!("{} at {place}", entry.name);
            let label = ui.add(egui::Button::selectable(is_taken, name).truncate());
            if label.on_hover_text("Take this measurement for this place").clicked() {
                ask(CalibrateIntent::TakeAnswer(sensor, entry.number));
            }
        });
    }
    if let Some(taken) = taken {
        let headroom = Headroom::of(&taken.measurement);
        ui.add_space(2.0);
        let colour = validity::ink(headroom.colour(), palette);
        wrapped(ui, RichText::new(format!("Headroom: {}", headroom.sentence())).color(colour));
    }
}

/// The buttons that lead on, back and out, which stay while the page is scrolled; returns whether the calibration was closed.
pub(super) fn steps(ui: &mut egui::Ui, scene: &Scene<'_>, intents: &mut Intents) -> bool {
    let Some(shown) = &scene.calibration else { return true };
    let step = shown.calibration.step;
    let mut ask = |intent: CalibrateIntent| intents.push(Intent::Calibrate(intent));
    ui.horizontal(|ui| {
        let cancel = ui.button("Cancel").on_hover_text("Cancel the calibration; the plate does not change");
        let is_cancelled = cancel.clicked();
        if is_cancelled {
            ask(CalibrateIntent::Cancel);
        }
        let back = ui.add_enabled(step.back().is_some(), egui::Button::new("Back"));
        let back = back.on_hover_text("The previous page; your files and entries stay");
        if let Some(back) = step.back().filter(|_| back.clicked()) {
            ask(CalibrateIntent::Page(back));
        }
        if let Some(next) = step.next() {
            let is_measuring = scene.measure.live.progress.is_some();
            let waits = is_measuring.then_some("Wait until it is measured, or cancel that.");
            let obstacle = waits.or(shown.calibration.obstacle());
            let next_is_due = obstacle.is_none();
            let button = theme::primary(ui, "Next", next_is_due);
            let button = ui.add_enabled(obstacle.is_none(), button);
            let button = button.on_hover_text("The next page; Back returns to this one");
            if button.on_disabled_hover_text(obstacle.unwrap_or_default()).clicked() {
                ask(CalibrateIntent::Page(next));
            }
        } else if matches!(shown.result, Some(Ok(_))) {
            // Not in the place of Next, which may have been pressed twice.
            aligned::at_right(ui, |ui| result::actions(ui, ask));
        }
        is_cancelled
    })
    .inner
}
