//! Sliders whose value can also be typed. The typed text is parsed with its unit; a refused text leaves the value
//! unchanged, and the reason is shown under the slider.

use crate::intent::{Intent, Intents};
use crate::view::fields::field::{InputField, refusal_over};
use crate::view::fields::refusal::Refusal;
use crate::view::kept::Fields;
use crate::view::theme;
use eframe::egui::{self, Slider};
use slipline_model::setup::edit::Edit;
use slipline_model::setup::{MASTER_SLIDER_MIN_DB, Setup};
use slipline_plate::quantity::{self, QuantityError, ticks};
use std::ops::RangeInclusive;

/// A value that a slider and a field show and change.
pub(crate) struct Quantity<'a> {
    /// The slider's name.
    name: &'a str,
    /// The field's name, if it differs from the slider's.
    field: String,
    help: &'static str,
    /// The value on the slider's scale.
    value: f64,
    /// The value as text in the field.
    shown: String,
    /// The allowed range, in the form in which it is typed.
    allowed: &'static str,
    slider: fn(&mut f64) -> Slider<'_>,
    /// Parses a typed text; the result is in the edit's unit.
    read: fn(&str) -> Result<f64, QuantityError>,
    /// Converts a slider value to the edit's unit.
    unit: f64,
    edit: &'a dyn Fn(f64) -> Edit,
}

/// The hint for a level.
pub(crate) const LEVELS: &str = "0 to 1, or 0 to 100 %";
/// The hints for the master level and a glide time. [`edit::apply`] checks the limits.
const MASTERS: &str = "-96 to 0 dB";
const GLIDES: &str = "5 ms to 10 s";

impl<'a> Quantity<'a> {
    /// A tone's level, 0..=1; `field` names the field of this tone.
    pub(crate) fn level(field: String, level: f64, edit: &'a dyn Fn(f64) -> Edit) -> Self {
        Self {
            name: "Level",
            field,
            help: "Its peak relative to the most the table allows",
            value: level,
            shown: format!("{level:.2}"),
            allowed: LEVELS,
            slider: |value| Slider::new(value, 0.0..=1.0).fixed_decimals(2),
            read: quantity::level,
            unit: 1.0,
            edit,
        }
    }

    /// The master level in dB.
    pub(crate) fn master(master_db: f64) -> Self {
        Self {
            name: "Master",
            field: "Master".to_owned(),
            help: "Scales all tones",
            value: master_db.max(MASTER_SLIDER_MIN_DB),
            shown: format!("{} dB", ticks::label(master_db, 0.1)),
            allowed: MASTERS,
            slider: |value| Slider::new(value, MASTER_SLIDER_MIN_DB..=0.0).fixed_decimals(1),
            read: quantity::decibel,
            unit: 1.0,
            edit: &Edit::Master,
        }
    }

    /// The glide time in seconds; the slider shows milliseconds.
    pub(crate) fn glide(glide_s: f64) -> Self {
        Self {
            name: "Glide",
            field: "Glide".to_owned(),
            help: "How long a change takes; the device ramps, so nothing clicks",
            value: glide_s * 1e3,
            shown: format!("{:.0} ms", glide_s * 1e3),
            allowed: GLIDES,
            slider: |value| Slider::new(value, 5.0..=2000.0).logarithmic(true).fixed_decimals(0),
            read: quantity::short_time_s,
            unit: 1e-3,
            edit: &Edit::Glide,
        }
    }

    /// The edit for a typed text.
    fn typed(&self, setup: &Setup, text: &str) -> Result<Edit, Refusal> {
        let value = Refusal::read(&self.field, text, self.allowed, self.read)?;
        Refusal::check(setup, (self.edit)(value), &self.field, text, self.allowed)
    }

    /// Shows the slider, the field beside it, and the reason of a refusal over what is under both.
    pub(crate) fn show(self, ui: &mut egui::Ui, setup: &Setup, typed: &mut Fields, intents: &mut Intents) {
        let mut reason = None;
        let shown = ui.horizontal(|ui| {
            let mut value = self.value;
            if slide(ui, self.name, (self.slider)(&mut value), self.help).changed() {
                intents.push(Intent::Edit((self.edit)(value * self.unit)));
            }
            let hint = format!("{}: {}", self.help, self.allowed);
            let field = InputField::new(&self.field, &self.shown, &hint, VALUE - FIELD_EDGES);
            let taken = field.show_apart(ui, typed, &mut reason, |text| self.typed(setup, text));
            intents.extend(taken.map(Intent::Edit));
        });
        refusal_over(ui, shown.response.rect, reason.as_deref());
    }
}

/// A slider and field of a value that is no part of the setup.
pub(crate) struct FreeSlider<'a> {
    pub(crate) name: &'a str,
    pub(crate) help: &'a str,
    /// The value, in the unit in which `read` gives it.
    pub(crate) value: f64,
    pub(crate) range: RangeInclusive<f64>,
    pub(crate) is_logarithmic: bool,
    /// The value as text in the field.
    pub(crate) shown: String,
    /// The allowed range, in the form in which it is typed.
    pub(crate) allowed: String,
    /// Parses a typed text.
    pub(crate) read: fn(&str) -> Result<f64, QuantityError>,
}

impl FreeSlider<'_> {
    /// Shows it, and the reason of a refusal over what is under it; returns the value that was chosen, if any.
    pub(crate) fn show(self, ui: &mut egui::Ui, fields: &mut Fields) -> Option<f64> {
        let Self { name, help, value, range, is_logarithmic, shown, allowed, read } = self;
        let mut reason = None;
        let mut chosen = None;
        let shown_at = ui.horizontal(|ui| {
            let mut slid = value;
            let slider = Slider::new(&mut slid, range.clone()).logarithmic(is_logarithmic);
            if slide(ui, name, slider, help).changed() {
                chosen = Some(slid);
            }
            let hint = format!("{help}: {allowed}");
            let field = InputField::new(name, &shown, &hint, VALUE - FIELD_EDGES);
            let typed = field.show_apart(ui, fields, &mut reason, |text| {
                let value = Refusal::read(name, text, &allowed, read)?;
                range.contains(&value).then_some(value).ok_or_else(|| Refusal::beyond(name, text, &allowed))
            });
            chosen = typed.or(chosen);
        });
        refusal_over(ui, shown_at.response.rect, reason.as_deref());
        chosen
    }
}

/// Width of the box with a slider's value, in points: the longest is "10000 ms".
const VALUE: f32 = 76.0;
/// Width that the margins of a field add, in points.
const FIELD_EDGES: f32 = 8.0;
/// Width of a slider's name, in points.
const NAME: f32 = 58.0;
/// The shortest a slider is, in points.
const LEAST_SLIDER: f32 = 60.0;

/// A slider with its name at the left, so that names and sliders are aligned, and space for a field at the right.
fn slide(ui: &mut egui::Ui, name: &str, slider: Slider<'_>, help: &str) -> egui::Response {
    let size = egui::vec2(NAME, ui.spacing().interact_size.y);
    let label = ui
        .scope(|ui| {
            ui.set_min_size(size);
            ui.set_max_width(size.x);
            ui.label(name)
        })
        .inner;
    ui.spacing_mut().slider_width =
        (ui.available_width() - VALUE - ui.spacing().item_spacing.x).max(LEAST_SLIDER);
    // Only what the user does changes the value: by itself a slider would round it to the decimals that it shows.
    let slider = slider.show_value(false).clamping(egui::SliderClamping::Edits);
    let response = ui.add(slider).labelled_by(label.id).on_hover_text(help);
    if response.has_focus() {
        // The slider's own style hardly shows the keyboard focus.
        let ring = response.rect.expand(2.0);
        let stroke = egui::Stroke::new(2.0, theme::palette(ui).accent);
        ui.painter().rect_stroke(ring, 6.0, stroke, egui::StrokeKind::Inside);
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_model::setup::edit;
    use slipline_model::setup::{GLIDE_RANGE_S, MASTER_MIN_DB};

    #[test]
    fn a_slider_accepts_what_an_edit_accepts() {
        assert_eq!(MASTERS, quantity::show_range(MASTER_MIN_DB, 0.0, quantity::Measure::Plain("dB")));
        let (least, most) = GLIDE_RANGE_S;
        assert_eq!(GLIDES, quantity::show_range(least, most, quantity::Measure::Time));
        let plate = slipline_plate::presets()[0].plate().unwrap();
        let setup = Setup::new(std::sync::Arc::new(plate));
        let level = |level| Edit::Level { slot: 0, level };
        for (value, is_taken) in [(0.0, true), (1.0, true), (-1e-9, false), (1.0 + 1e-9, false)] {
            assert_eq!(edit::apply(&setup, &level(value)).is_ok(), is_taken, "{value}");
        }
    }
}
