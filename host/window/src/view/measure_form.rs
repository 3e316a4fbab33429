//! What is measured with the device: the sensor's place and kind, the level; the button, and the progress with Cancel.

use super::field::InputField;
use super::{Scene, ViewState, theme};
use crate::intent::{Intent, Intents, MeasureDraft, MeasureIntent};
use eframe::egui::{self, RichText};
use slipline_plate::calibrate::SensorKind;
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity::{self, OutOfRange, Range, show_place};

/// Shows the form. `answers` is the calibration's place that the measurement is for.
pub(super) fn show(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    view: &mut ViewState,
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
        return;
    }
    let draft = *live.draft;
    let mut reason = None;
    ui.horizontal_top(|ui| {
        let length_m = scene.setup.plate.length_m();
        let place = show_place(draft.place_m);
        let hint = "Where the sensor stands, from the driven end (32 mm)";
        let field = InputField {
            name: "Sensor at",
            value: &place,
            hint,
            width: 72.0,
            caption: Some("Sensor at"),
            is_live: false,
        };
        let taken = field.show_apart(ui, &mut view.fields, &mut reason, |text| {
            let place_m = quantity::length_m(text).map_err(|error| error.to_string())?;
            let on_plate = Range::new(0.0, length_m, "m");
            OutOfRange::check("sensor", place_m, on_plate).map_err(|error| error.in_suitable_units())?;
            Ok(MeasureDraft { place_m, ..draft })
        });
        taken.into_iter().for_each(|draft| ask(MeasureIntent::Draft(draft)));
        let level = with_decimals(draft.level, 2);
        let hint = "What all tones together may be of full scale: 0.001 to 1, or in dB";
        let field = InputField {
            name: "Level",
            value: &level,
            hint,
            width: 52.0,
            caption: Some("Level"),
            is_live: false,
        };
        let taken = field.show_apart(ui, &mut view.fields, &mut reason, |text| {
            let level = quantity::level(text).map_err(|error| error.to_string())?;
            let allowed = slipline_model::measure::LEVEL;
            OutOfRange::check("level", level, allowed).map_err(|error| error.in_suitable_units())?;
            Ok(MeasureDraft { level, ..draft })
        });
        taken.into_iter().for_each(|draft| ask(MeasureIntent::Draft(draft)));
        ui.vertical(|ui| {
            ui.label(RichText::new("It shows").small().color(theme::palette(ui).weak));
            let chosen =
                egui::ComboBox::from_id_salt("sensor kind").selected_text(draft.kind.word()).width(108.0);
            let chosen = chosen.show_ui(ui, |ui| {
                for kind in SensorKind::ALL {
                    let choice = ui.selectable_label(kind == draft.kind, kind.word());
                    if choice.on_hover_text("The sensor's voltage stands for this of the plate").clicked() {
                        ask(MeasureIntent::Draft(MeasureDraft { kind, ..draft }));
                    }
                }
            });
            let name = format!("Sensor: {}", draft.kind.word());
            chosen.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
            chosen.response.on_hover_text(
                "What the sensor tells of the plate's motion, so that its model is compared rightly",
            );
        });
    });
    if let Some(reason) = reason {
        ui.add(egui::Label::new(RichText::new(reason).small().color(theme::palette(ui).wrong)).wrap());
    }
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
    let help = "Play tones over the plate's band and measure the sensor's answer to each; never louder than the level";
    if ui.button(RichText::new("Measure now").strong()).on_hover_text(help).clicked() {
        ask(MeasureIntent::Begin(answers));
    }
}
