//! Fields for what the user states of a sensor: its place, its kind, a number of its measurement.

use crate::view::fields::field::InputField;
use crate::view::kept::Fields;
use crate::view::theme;
use anyhow::anyhow;
use eframe::egui::{self, RichText};
use slipline_plate::calibrate::SensorKind;
use slipline_plate::quantity::{self, OutOfRange, QuantityError, Range, show_place};

/// A field of the forms: its name, what it is for, its width in points.
pub(crate) type Field = (&'static str, &'static str, f32);

/// A number in a field, read by `read` and within `range`; a refusal goes to `reason` and calls the number `term`.
pub(crate) fn number(
    ui: &mut egui::Ui,
    fields: &mut Fields,
    reason: &mut Option<String>,
    (name, hint, width): Field,
    (value, term, range): (&str, &'static str, Range),
    read: impl FnOnce(&str) -> Result<f64, QuantityError>,
) -> Option<f64> {
    let field = InputField { name, value, hint, width, caption: Some(name), is_live: false };
    field.show_apart(ui, fields, reason, |text| -> anyhow::Result<f64> {
        let number = read(text)?;
        OutOfRange::check(term, number, range).map_err(|error| anyhow!(error.in_suitable_units()))?;
        Ok(number)
    })
}

/// A place on a plate of this length, metres.
pub(crate) fn place(
    ui: &mut egui::Ui,
    fields: &mut Fields,
    reason: &mut Option<String>,
    field: Field,
    (place_m, length_m): (f64, f64),
) -> Option<f64> {
    let shown = show_place(place_m);
    let on_plate = (shown.as_str(), "sensor", Range::new(0.0, length_m, "m"));
    number(ui, fields, reason, field, on_plate, quantity::length_m)
}

/// What the sensor measures; `None` while the user has not stated it.
pub(crate) fn kind(ui: &mut egui::Ui, caption: &str, chosen: Option<SensorKind>) -> Option<SensorKind> {
    let mut taken = None;
    ui.vertical(|ui| {
        ui.label(RichText::new(caption).small().color(theme::palette(ui).weak));
        let word = chosen.map_or("choose…", SensorKind::word);
        let list = egui::ComboBox::from_id_salt(("sensor kind", caption)).selected_text(word).width(108.0);
        let list = list.show_ui(ui, |ui| {
            for kind in SensorKind::ALL {
                let choice = ui.selectable_label(Some(kind) == chosen, kind.word());
                if choice.on_hover_text("The sensor's voltage stands for this of the plate").clicked() {
                    taken = Some(kind);
                }
            }
        });
        let name = format!("Sensor: {word}");
        list.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &name));
        list.response
            .on_hover_text("What the sensor measures; the plate's model is compared in this quantity");
    });
    taken
}

/// Why a field was refused, under the fields.
pub(crate) fn refusal(ui: &mut egui::Ui, reason: Option<&str>) {
    if let Some(reason) = reason {
        ui.add(egui::Label::new(RichText::new(reason).small().color(theme::palette(ui).wrong)).wrap());
    }
}
