//! The last page: the calibrated plate and the errors of the plate before, or the reason why there is none.

use super::wrapped;
use crate::caption::Panel;
use crate::intent::{Asks as _, CalibrateIntent, Intent, Intents};
use crate::scene::CalibrateScene;
use crate::view::theme;
use eframe::egui::{self, RichText};
use slipline_instrument::calibration::{CalibrationWizard, Remedy, WizardPage};
use slipline_instrument::jobs::calibrate::{CalibrationResult, Refused};
use slipline_plate::calibrate::Parameter;
use slipline_plate::quantity::number_format::{significant, with_decimals};
use slipline_plate::quantity::{Form as _, show_place};

pub(super) fn show(ui: &mut egui::Ui, shown: &CalibrateScene<'_>, intents: &mut Intents) {
    match shown.result {
        None => {
            wrapped(ui, "The plate is being fitted to the measured response…");
            if let Some(share) = shown.progress {
                ui.add(egui::ProgressBar::new(share).desired_height(8.0));
            }
        }
        Some(Err(refused)) => why_not(ui, refused, shown.calibration, intents),
        Some(Ok(found)) => {
            accepted(ui, found);
            ui.add_space(4.0);
            check(ui, shown.calibration, intents);
        }
    }
}

/// Why there is no calibrated plate, and what to do.
fn why_not(ui: &mut egui::Ui, refused: &Refused, calibration: &CalibrationWizard, intents: &mut Intents) {
    let palette = theme::palette(ui);
    wrapped(ui, RichText::new("No plate file was made, and the plate stays as it is.").strong());
    ui.add_space(2.0);
    wrapped(ui, RichText::new(format!("Refused: {}.", refused.reason)).color(palette.wrong));
    ui.add_space(4.0);
    wrapped(ui, refused.remedy.sentence());
    let (name, intent) = match refused.remedy {
        Remedy::Exchange => ("Exchange them".to_owned(), CalibrateIntent::Exchange),
        Remedy::Page(step @ WizardPage::Check) => {
            ("Back to the third place".to_owned(), CalibrateIntent::Page(step))
        }
        Remedy::Page(step) => (format!("Back to page {}", step.number()), CalibrateIntent::Page(step)),
    };
    let help = ui.add(theme::primary(ui, &name, true));
    help.on_hover_text("Apply the proposed remedy; your entries stay")
        .asks(intents, Intent::Calibrate(intent));
    if calibration.answer(2).is_some() {
        ui.button("Leave the check out")
            .on_hover_text("The calibration by the two places alone")
            .asks(intents, Intent::Calibrate(CalibrateIntent::LeaveCheckOut));
    }
}

/// The offer of a third place that checks the result, or where it was checked.
fn check(ui: &mut egui::Ui, calibration: &CalibrationWizard, intents: &mut Intents) {
    let place = show_place(calibration.places_m()[2]);
    let (text, name) = match calibration.answer(2) {
        Some(answer) => {
            let place = show_place(answer.measurement.place_m);
            (format!("Checked by a third measurement, at {place}."), "Check at a third place again…")
        }
        None => {
            let text = format!(
                "A third measurement, at {place}, checks this result: its interval widens, or it is refused."
            );
            (text, "Check at a third place…")
        }
    };
    wrapped(ui, text);
    ui.button(name)
        .on_hover_text("A page for the same sensor at a third place; this result stays")
        .asks(intents, Intent::Calibrate(CalibrateIntent::Page(WizardPage::Check)));
}

fn accepted(ui: &mut egui::Ui, found: &CalibrationResult) {
    let palette = theme::palette(ui);
    let calibrated = &found.calibrated;
    let weak = |text: &str| RichText::new(text).small().color(palette.weak);
    let grid = |name: &str| egui::Grid::new(name).num_columns(3).min_col_width(60.0).spacing([24.0, 3.0]);
    let decibel = |db: f64| format!("{} dB", with_decimals(db, 1));
    // One unit for both, so that they are compared at a glance.
    let millimetres = |metres: f64| format!("{} mm", with_decimals(1e3 * metres, 2));
    let has_level = calibrated.level_tolerance_db.is_finite();
    let row = |ui: &mut egui::Ui, cells: [RichText; 3]| {
        cells.into_iter().for_each(|cell| drop(ui.label(cell)));
        ui.end_row();
    };
    let off = |name: &str, before: String, after: String| {
        [name.into(), RichText::new(before).color(palette.wrong), RichText::new(after).color(palette.good)]
    };
    grid("calibration errors").show(ui, |ui| {
        row(ui, ["", "before", "after (95 %)"].map(weak));
        let after = format!("±{}", millimetres(calibrated.boundary_tolerance_m));
        row(ui, off("Boundary off by", millimetres(found.before.boundary_m), after));
        if has_level {
            let after = format!("±{}", decibel(calibrated.level_tolerance_db));
            row(ui, off("Level off by", decibel(found.before.level_db), after));
        }
    });
    if let Some(caution) = calibrated.caution() {
        ui.add_space(4.0);
        wrapped(ui, RichText::new(caution).color(palette.warn));
    }
    ui.add_space(6.0);
    grid("calibration parameters").show(ui, |ui| {
        row(ui, ["", "fitted", "95 % interval"].map(weak));
        for parameter in &calibrated.parameters {
            let (name, [value, low, high]) = parameter_words(parameter);
            row(ui, [name, value, format!("{low} to {high}")].map(RichText::new));
        }
    });
    ui.add_space(4.0);
    let chi2 = with_decimals(calibrated.chi2_per_n, 2);
    let note = calibrated.misfit_note();
    let text = format!(
        "Reduced chi-square is {chi2}: about 1 where the model misses no more than the noise. {note}"
    );
    wrapped(ui, weak(&text));
}

/// What can be done with the plate.
pub(super) fn actions(ui: &mut egui::Ui, mut ask: impl FnMut(CalibrateIntent)) {
    let save = ui.button("Save plate file…");
    if save.on_hover_text("A plate file for the app and the command line").clicked() {
        ask(CalibrateIntent::Save);
    }
    let button = ui.add(theme::primary(ui, "Use this plate", true));
    if button.on_hover_text("Put it on the screen, with its table; Undo takes it back").clicked() {
        ask(CalibrateIntent::Use);
    }
}

/// A parameter by its name in the panels, and its value and interval in their unit.
fn parameter_words(parameter: &Parameter) -> (String, [String; 3]) {
    let Parameter { name, value, low, high } = *parameter;
    if name == "place_m" {
        return ("Sensor's place".to_owned(), [value, low, high].map(show_place));
    }
    // Near zero digits that count say nothing: to a micrometre.
    let micrometres = |value_m: f64| format!("{:.3} mm", (1e6 * value_m).round() / 1e3 + 0.0);
    match Panel::Plate.caption(name) {
        Some(caption) if name == "edge_give_m" => {
            (caption.name.to_owned(), [value, low, high].map(micrometres))
        }
        Some(caption) => {
            let ends = [value, low, high].map(|value| caption.unit.written(value, 5));
            (caption.name.to_owned(), ends)
        }
        None => (name.to_owned(), [value, low, high].map(|value| significant(value, 5))),
    }
}
