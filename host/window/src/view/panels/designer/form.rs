//! The form of the designer: the fields of a draft, and the reason of a refusal at the field it names. Fields and
//! terms are those of `slipline design`.

use crate::caption::Panel;
use crate::view::fields::choice::choice;
use crate::view::fields::field::{InputField, labelled, refusal};
use crate::view::kept::Fields;
use eframe::egui;
use slipline_model::jobs::design::{Draft, Kind, Stretch};
use slipline_plate::PlateError;
use slipline_plate::design::{Material, material_names};
use slipline_plate::limits;
use slipline_plate::limits::BAND_WIDTH_MIN_PERCENT;
use slipline_plate::quantity::Notation as _;
use slipline_plate::quantity::{
    self, FIELD_DIGITS, Measure, QuantityError, Range, Unit, frequency_hz, length_m, show_range,
};

/// Width of a field or menu, in points: to the end of the panel.
const FIELD: f32 = 156.0;
/// The text of a field whose value is left to the library.
const AUTOMATIC: &str = "auto";

/// The fields of a draft.
pub(super) struct Form<'a> {
    draft: &'a Draft,
    refusal: Option<&'a PlateError>,
    fields: &'a mut Fields,
    shown: Shown,
}

/// The result of showing the form.
#[derive(Default)]
pub(super) struct Shown {
    /// The changed draft, if the user changed it.
    pub(super) change: Option<Draft>,
    /// Whether the reason of the refusal was shown at its field.
    pub(super) is_told: bool,
}

/// The place of a number in a draft.
type NumberAt = fn(&mut Draft) -> &mut f64;

/// One field: the library's name of it, its text and its allowed range.
struct Entry {
    field: &'static str,
    value: String,
    hint: String,
}

fn millimetres(metres: f64) -> String {
    Unit::Millimetre.written(metres, FIELD_DIGITS)
}

fn lengths(allowed: Range) -> String {
    show_range(allowed.low, allowed.high, Measure::Length)
}

/// The typed value, or `None` for an empty text or `auto`.
fn optional(
    text: &str,
    read: impl FnOnce(&str) -> Result<f64, QuantityError>,
) -> Result<Option<f64>, QuantityError> {
    let text = text.trim();
    if text.is_empty() || text == AUTOMATIC { Ok(None) } else { read(text).map(Some) }
}

impl<'a> Form<'a> {
    /// A form of this draft; `refusal` is why there is no plate for it.
    pub(super) fn new(draft: &'a Draft, refusal: Option<&'a PlateError>, fields: &'a mut Fields) -> Self {
        Self { draft, refusal, fields, shown: Shown::default() }
    }

    /// Shows every field.
    pub(super) fn show(mut self, ui: &mut egui::Ui) -> Shown {
        ui.push_id("design", |ui| {
            self.sheet(ui);
            self.size(ui);
            let more = egui::CollapsingHeader::new("More").show_unindented(ui, |ui| self.rest(ui));
            more.header_response.on_hover_text("Values that are chosen for you unless you give them");
        });
        self.shown
    }

    /// Shows a field; `take` applies the typed text to the draft.
    fn entry(
        &mut self,
        ui: &mut egui::Ui,
        entry: &Entry,
        take: impl FnOnce(&mut Draft, &str) -> Result<(), QuantityError>,
    ) {
        let Entry { field, value, hint } = entry;
        let name = &Panel::Designer.field(field);
        let reason = self.refusal.filter(|refusal| Panel::Designer.field(refusal.field()) == *name);
        labelled(ui, name, |ui| {
            ui.vertical(|ui| {
                let field = InputField { is_live: true, ..InputField::new(name, value, hint, FIELD) };
                let draft = self.draft;
                let taken = field.show(ui, self.fields, |text| {
                    let mut draft = draft.clone();
                    take(&mut draft, text).map(|()| draft)
                });
                self.shown.change = taken.or(self.shown.change.take());
                self.shown.is_told |= reason.is_some();
                refusal(ui, reason.map(|refused| refused.worded(&Panel::Designer)).as_deref());
            });
        });
    }

    /// Shows the field of a length.
    fn length(&mut self, ui: &mut egui::Ui, field: &'static str, hint: String, at: NumberAt) {
        let entry = Entry { field, value: millimetres(*at(&mut self.draft.clone())), hint };
        self.entry(ui, &entry, |draft, text| length_m(text).map(|value| *at(draft) = value));
    }

    /// Shows the field of a length that may be left to the library.
    fn automatic(
        &mut self,
        ui: &mut egui::Ui,
        field: &'static str,
        hint: &str,
        at: fn(&mut Draft) -> &mut Option<f64>,
    ) {
        let value = at(&mut self.draft.clone()).map_or_else(|| AUTOMATIC.to_owned(), millimetres);
        let entry = Entry { field, value, hint: hint.to_owned() };
        self.entry(ui, &entry, |draft, text| optional(text, length_m).map(|value| *at(draft) = value));
    }

    /// Shows a menu of values and their names; `now` is selected, and `take` applies another choice to the draft.
    fn choice<T: PartialEq + Copy>(
        &mut self,
        ui: &mut egui::Ui,
        name: &str,
        (now, help): (T, &str),
        all: impl Iterator<Item = (T, &'static str)>,
        take: impl FnOnce(&mut Draft, T),
    ) {
        let all: Vec<(T, &'static str)> = all.collect();
        let shown = all.iter().find(|(value, _)| *value == now).map_or("", |(_, name)| *name);
        let chosen = choice(ui, (name, shown, help), FIELD, |ui| {
            let mut chosen = None;
            for (value, name) in &all {
                if ui.selectable_label(*value == now, *name).clicked() && *value != now {
                    chosen = Some(*value);
                }
            }
            chosen
        });
        if let Some(value) = chosen {
            let mut draft = self.draft.clone();
            take(&mut draft, value);
            self.shown.change = Some(draft);
        }
    }

    /// The material of the sheet, and the kind of its wave.
    fn sheet(&mut self, ui: &mut egui::Ui) {
        let draft = self.draft;
        let materials = material_names().map(|name| (name, name));
        let help = "What the sheet is made of: its stiffness, density and loss are known";
        self.choice(ui, "Material", (draft.material, help), materials, |draft, name| {
            *draft = draft.clone().of_material(name);
        });
        let hint = format!("The sheet's thickness, {}", lengths(limits::THICKNESS));
        self.length(ui, "model.thickness_m", hint, |draft| &mut draft.thickness_m);
        let kinds = Kind::ALL.into_iter().map(|kind| (kind, kind.name()));
        let help = "How the sheet is held at its edges, and so which wave travels on it";
        self.choice(ui, "Wave", (draft.kind, help), kinds, |draft, kind| draft.kind = kind);
        match draft.kind {
            Kind::Supported | Kind::Clamped => {
                let mut thin = draft.thin;
                let check = labelled(ui, "", |ui| ui.checkbox(&mut thin, "Thin plate"));
                if check.on_hover_text("Leave out shear and rotary inertia").changed() {
                    self.shown.change = Some(Draft { thin, ..draft.clone() });
                }
            }
            Kind::Membrane => self.stretch(ui),
            // As high as the row of another kind.
            Kind::Shear => ui.add_space(ui.spacing().interact_size.y + ui.spacing().item_spacing.y),
        }
    }

    /// The stretch of a membrane: a wave speed or a tension.
    fn stretch(&mut self, ui: &mut egui::Ui) {
        let value = match self.draft.stretch {
            Stretch::WaveSpeed(speed) => format!("{speed} m/s"),
            Stretch::Tension(tension) => format!("{tension} N/m"),
        };
        let stretch = Entry {
            field: "model.wave_speed_m_per_s",
            value,
            hint: "A wave speed (12 m/s) or a tension per width (70 N/m)".to_owned(),
        };
        self.entry(ui, &stretch, |draft, text| {
            draft.stretch = match quantity::plain(text, "m/s") {
                Ok(speed) => Stretch::WaveSpeed(speed),
                Err(_) => Stretch::Tension(quantity::plain(text, "N/m").map_err(|mut error| {
                    if let QuantityError::Unit { allowed, .. } = &mut error {
                        *allowed = "N/m or m/s";
                    }
                    error
                })?),
            };
            Ok(())
        });
    }

    /// The band and the length of the plate.
    fn size(&mut self, ui: &mut egui::Ui) {
        let low = "The boundary's lowest frequency, such as 20 kHz".to_owned();
        let high =
            format!("The boundary's highest frequency, at least {BAND_WIDTH_MIN_PERCENT} % above the lowest");
        let ends: [(_, _, NumberAt); 2] = [
            ("band low", low, |draft| &mut draft.band_hz.0),
            ("band high", high, |draft| &mut draft.band_hz.1),
        ];
        for (field, hint, at) in ends {
            let value = Unit::Hertz.written(*at(&mut self.draft.clone()), FIELD_DIGITS);
            let entry = Entry { field, value, hint };
            self.entry(ui, &entry, |draft, text| frequency_hz(text).map(|value| *at(draft) = value));
        }
        let hint = format!("From the driven end to the narrow end, {}", lengths(limits::LENGTH));
        self.length(ui, "length_m", hint, |draft| &mut draft.length_m);
    }

    /// The values that the library chooses unless the user gives them.
    fn rest(&mut self, ui: &mut egui::Ui) {
        let draft = self.draft;
        let hint = "From the driven end to the nearest boundary; auto: as much as its peak needs";
        self.automatic(ui, "start_margin_m", hint, |draft| &mut draft.start_margin_m);
        let hint = "From the farthest boundary to the narrow end; auto: as much as its tail needs";
        self.automatic(ui, "end_margin_m", hint, |draft| &mut draft.end_margin_m);
        let library = Material::named(draft.material).map_or(0.0, |material| material.loss_factor);
        let loss = Entry {
            field: "loss_factor",
            value: draft.loss_factor.unwrap_or(library).to_string(),
            hint: format!("{}; auto: the library's for this material", limits::LOSS_FACTOR),
        };
        self.entry(ui, &loss, |draft, text| {
            let plain = |text: &str| quantity::plain(text, "");
            optional(text, plain).map(|value| draft.loss_factor = value)
        });
        let hint = "The drive's displacement at DAC full scale; auto: 1 µm from 1 kHz on, else 100 µm";
        self.automatic(ui, "full_scale_m", hint, |draft| &mut draft.full_scale_m);
        let hint = format!("Width of the frame's rim, {}", lengths(limits::RIM));
        self.length(ui, "rim_m", hint, |draft| &mut draft.rim_m);
        let name = Entry {
            field: "name",
            value: draft.name.clone(),
            hint: format!("The plate's name, {}", limits::NAME.with_unit()),
        };
        self.entry(ui, &name, |draft, text| {
            draft.name = text.trim().to_owned();
            Ok(())
        });
    }
}
