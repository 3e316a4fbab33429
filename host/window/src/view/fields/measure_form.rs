//! What is measured with the device: the sensor's place and kind, the level; the button, and the progress with Cancel.

use crate::intent::{Intent, Intents, MeasureDraft, MeasureIntent};
use crate::scene::Scene;
use crate::view::bars::tour;
use crate::view::fields::{
    drive_fields,
    field::refusal_over,
    lines::lines,
    sensor_fields::{kind, number, place},
};
use crate::view::kept::Fields;
use crate::view::theme;
use eframe::egui;
use slipline_instrument::TourStep;
use slipline_instrument::measure::LEVEL;
use slipline_plate::calibrate::{SENSOR_MASS, SENSOR_WIDTH, SensorBody};
use slipline_plate::quantity::number_format::{significant, with_decimals};
use slipline_plate::quantity::{self, show_place};

/// Width of the button that cancels, in points.
const CANCEL: f32 = 140.0;

/// The width of a sensor whose width is not stated, metres: that of a chip.
const CHIP_M: f64 = 4e-3;

/// What the hidden test plate is ([`slipline_instrument::rig::secret`]).
const SECRET_HELP: &str = "To try a calibration: the sensor stands on a plate near this one, whose numbers are not shown. Its wave speed is up \
    to 5 % off, its loss 0.5 to 2.5 times as high, and its drive another one";

/// Shows the form. `answers` is the calibration's place that the measurement is for.
pub(crate) fn show(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    typed: &mut Fields,
    answers: Option<usize>,
    intents: &mut Intents,
) {
    let palette = theme::palette(ui);
    let live = &scene.measure.live;
    let mut ask = |intent: MeasureIntent| intents.push(Intent::Measure(intent));
    let is_measuring = live.progress.is_some();
    // The fields stay while it is measured, so that nothing comes under a pointer that presses twice.
    ui.add_enabled_ui(!is_measuring, |ui| settings(ui, scene, typed, answers, &mut ask));
    let is_answered = answers.is_some_and(|sensor| {
        scene.calibration.as_ref().is_some_and(|shown| shown.calibration.answer(sensor).is_some())
    });
    let help = "Play tones over the plate's band and measure the sensor's answer to each; never louder than the level";
    ui.horizontal(|ui| {
        // As high as the two lines beside the button, whatever stands there.
        ui.set_min_height(2.0 * ui.text_style_height(&egui::TextStyle::Small));
        let is_due = !is_answered && !is_measuring && scene.measure.asked.is_none();
        let button = theme::primary(ui, "Measure now", is_due);
        let button = ui.add_enabled(!is_measuring, button).on_hover_text(help);
        tour::mark(ui, scene, TourStep::Measure, button.rect);
        if button.on_disabled_hover_text("It is being measured").clicked() {
            ask(MeasureIntent::Begin(answers));
        }
        // Beside the button, so that nothing under it moves. A message would lie behind the calibration's pages.
        let Some(progress) = live.progress else {
            return lines(ui, live.failed.unwrap_or_default(), palette.wrong, 2);
        };
        // Beside the page, the top bar has the button.
        let has_cancel = answers.is_some();
        let room = (ui.available_width() - if has_cancel { CANCEL } else { 0.0 }).max(20.0);
        if live.is_checking {
            ui.scope(|ui| {
                ui.set_max_width(room);
                lines(ui, "Quiet tones first: is the drive on?", palette.text, 2);
            });
        } else {
            let percent = format!("{:.0} %", 100.0 * progress.share);
            let bar = ui.add(egui::ProgressBar::new(progress.share).desired_height(8.0).desired_width(room));
            let name = format!("Measured: {percent}");
            bar.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, &name));
        }
        if has_cancel
            && ui.button("Cancel measuring").on_hover_text("Stop the tones; nothing is kept").clicked()
        {
            ask(MeasureIntent::Cancel);
        }
    });
}

/// What the sensor weighs.
pub(crate) fn body(ui: &mut egui::Ui, scene: &Scene<'_>, typed: &mut Fields, intents: &mut Intents) {
    let draft = *scene.measure.live.draft;
    let (mass_kg, width_m) = draft.body.map_or((0.0, CHIP_M), |body| (body.mass_kg, body.width_m));
    let mut reason = None;
    let mut wanted = None;
    let fields = ui.add_enabled_ui(scene.measure.live.progress.is_none(), |ui| {
        ui.horizontal_top(|ui| {
            let field = (
                "Sensor weighs",
                "The mass of a sensor that stands on the plate, within a fifth (50 mg); 0 for one that does not touch it",
                82.0,
            );
            let shown = format!("{} mg", significant(1e6 * mass_kg, 4));
            let of_mass = (shown.as_str(), "mass", SENSOR_MASS);
            if let Some(mass_kg) = number(ui, typed, &mut reason, field, of_mass, quantity::mass_kg) {
                wanted = Some((mass_kg, width_m));
            }
            let field = ("on a width of", "The side of the square on which it stands (4 mm)", 82.0);
            let shown = show_place(width_m);
            let of_width = (shown.as_str(), "width", SENSOR_WIDTH);
            if let Some(width_m) = number(ui, typed, &mut reason, field, of_width, quantity::length_m) {
                wanted = Some((mass_kg, width_m));
            }
        });
    });
    refusal_over(ui, fields.response.rect, reason.as_deref());
    if let Some(body) = wanted.and_then(|(mass_kg, width_m)| SensorBody::new(mass_kg, width_m).ok()) {
        intents.push(Intent::Measure(MeasureIntent::Draft(MeasureDraft { body, ..draft })));
    }
}

/// What is measured, and how.
fn settings(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    typed: &mut Fields,
    answers: Option<usize>,
    ask: &mut impl FnMut(MeasureIntent),
) {
    let live = &scene.measure.live;
    let draft = *live.draft;
    ui.spacing_mut().item_spacing.y = 3.0;
    ui.spacing_mut().interact_size.y = 20.0;
    let mut reason = None;
    let fields = ui.horizontal_top(|ui| {
        let field = ("Sensor at", "Where the sensor stands, from the driven end (32 mm)", 82.0);
        let at = (draft.place_m, scene.setup.plate.length_m());
        if let Some(place_m) = place(ui, typed, &mut reason, field, at) {
            ask(MeasureIntent::Draft(MeasureDraft { place_m, ..draft }));
        }
        // At the places after the first nothing but the place may differ.
        ui.add_enabled_ui(answers.is_none_or(|sensor| sensor == 0), |ui| {
            let field = (
                "Level",
                "The limit of the sum of all tones, as a share of full scale: 0.001 to 1, or in dB",
                52.0,
            );
            let shown = with_decimals(draft.level, 2);
            let of_level = (shown.as_str(), "level", LEVEL);
            if let Some(level) = number(ui, typed, &mut reason, field, of_level, quantity::level) {
                ask(MeasureIntent::Draft(MeasureDraft { level, ..draft }));
            }
            if let Some(kind) = kind(ui, "Sensor type", Some(draft.kind)) {
                ask(MeasureIntent::Draft(MeasureDraft { kind, ..draft }));
            }
        });
    });
    refusal_over(ui, fields.response.rect, reason.as_deref());
    if scene.snapshot.is_simulated() {
        let mut is_secret = live.is_secret;
        let switch = egui::Checkbox::new(&mut is_secret, "Hidden test plate (its numbers differ)");
        let switch = ui.add_enabled(answers != Some(1), switch);
        if switch.on_hover_text(SECRET_HELP).changed() {
            ask(MeasureIntent::Secret(is_secret));
        }
    }
    if let Some(draft) = drive_fields::show(ui, typed, live) {
        ask(MeasureIntent::Draft(draft));
    }
}
