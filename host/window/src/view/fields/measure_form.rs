//! What is measured with the device: the sensor's place and kind, the level; the button, and the progress with Cancel.

use crate::intent::{Intent, Intents, MeasureDraft, MeasureIntent};
use crate::scene::Scene;
use crate::view::fields::field::Fields;
use crate::view::fields::{
    drive_fields,
    sensor_fields::{kind, number, place, refusal},
};
use eframe::egui::{self, RichText};
use slipline_instrument::measure::LEVEL;
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity;

/// Shows the form. `answers` is the calibration's place that the measurement is for.
pub(crate) fn show(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    typed: &mut Fields,
    answers: Option<usize>,
    intents: &mut Intents,
) {
    let live = &scene.measure.live;
    let mut ask = |intent: MeasureIntent| intents.push(Intent::Measure(intent));
    if let Some(share) = live.progress {
        ui.horizontal(|ui| {
            if ui.button("Cancel measuring").on_hover_text("Stop the tones; nothing is kept").clicked() {
                ask(MeasureIntent::Cancel);
            }
            let percent = format!("{:.0} %", 100.0 * share);
            let bar = ui.add(egui::ProgressBar::new(share).desired_height(8.0));
            let name = format!("Measured: {percent}");
            bar.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, &name));
        });
        if live.is_checking {
            ui.label(RichText::new("Quiet tones first: is the drive on?").small());
        }
        return;
    }
    let draft = *live.draft;
    let mut reason = None;
    ui.horizontal_top(|ui| {
        let field = ("Sensor at", "Where the sensor stands, from the driven end (32 mm)", 82.0);
        let at = (draft.place_m, scene.setup.plate.length_m());
        if let Some(place_m) = place(ui, typed, &mut reason, field, at) {
            ask(MeasureIntent::Draft(MeasureDraft { place_m, ..draft }));
        }
        let field = ("Level", "What all tones together may be of full scale: 0.001 to 1, or in dB", 52.0);
        let shown = with_decimals(draft.level, 2);
        let of_level = (shown.as_str(), "level", LEVEL);
        if let Some(level) = number(ui, typed, &mut reason, field, of_level, quantity::level) {
            ask(MeasureIntent::Draft(MeasureDraft { level, ..draft }));
        }
        if let Some(kind) = kind(ui, "It shows", Some(draft.kind)) {
            ask(MeasureIntent::Draft(MeasureDraft { kind, ..draft }));
        }
    });
    refusal(ui, reason.as_deref());
    if scene.snapshot.is_simulated() {
        let mut is_secret = live.is_secret;
        let switch = ui.checkbox(&mut is_secret, "A secret plate, a few per cent off");
        if switch
            .on_hover_text("To try a calibration: nobody knows the plate that the sensor stands on")
            .changed()
        {
            ask(MeasureIntent::Secret(is_secret));
        }
    }
    if let Some(draft) = drive_fields::show(ui, typed, live) {
        ask(MeasureIntent::Draft(draft));
    }
    let help = "Play tones over the plate's band and measure the sensor's answer to each; never louder than the level";
    if ui.button(RichText::new("Measure now").strong()).on_hover_text(help).clicked() {
        ask(MeasureIntent::Begin(answers));
    }
    // A message would lie behind the calibration's pages.
    refusal(ui, live.failed);
}
