//! Fields in which the user describes a sensor: its place, its kind and the numbers of its measurement.

use crate::view::fields::choice::choice_under;
use crate::view::fields::field::InputField;
use crate::view::kept::Fields;
use anyhow::anyhow;
use eframe::egui;
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
    let field = InputField::new(name, value, hint, width).under(name);
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
    let word = chosen.map_or("choose…", SensorKind::word);
    let help = "What the sensor measures; the plate's model is compared in this quantity";
    choice_under(ui, caption, ("Sensor", word, help), 108.0, |ui| {
        let pressed = |kind: &SensorKind| {
            let entry = ui.selectable_label(Some(*kind) == chosen, kind.word());
            entry.on_hover_text("The sensor's voltage follows this quantity of the plate").clicked()
        };
        SensorKind::ALL.into_iter().filter(pressed).last()
    })
}
