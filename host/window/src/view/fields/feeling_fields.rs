//! How a finger feels, as fields: every value is illustrative and can be set.

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::fields::field::{InputField, labelled};
use crate::view::fields::refusal::Refusal;
use crate::view::kept::Fields;
use eframe::egui;
use slipline_model::setup::Setup;
use slipline_model::setup::edit::Edit;
use slipline_plate::feeling::Feeling;
use slipline_plate::quantity::{self, QuantityError, show_length};

/// One value of [`Feeling`].
struct Value {
    name: &'static str,
    help: &'static str,
    /// The allowed range, in the form in which it is typed.
    allowed: &'static str,
    shown: fn(&Feeling) -> String,
    read: fn(&str) -> Result<f64, QuantityError>,
    set: fn(&mut Feeling, f64),
}

const VALUES: [Value; 6] = [
    Value {
        name: "Threshold",
        help: "Of a vibration, in units of the threshold at its frequency",
        allowed: "0.01 to 100",
        shown: |feeling| plain(feeling.threshold),
        read: |text| quantity::plain(text, ""),
        set: |feeling, value| feeling.threshold = value,
    },
    Value {
        name: "Friction scale",
        help: "Ultrasonic amplitude at which the friction has fallen by 63 % of its fall",
        allowed: "1 nm to 1 mm",
        shown: |feeling| show_length(feeling.friction.scale_m),
        read: quantity::length_m,
        set: |feeling, value| feeling.friction.scale_m = value,
    },
    Value {
        name: "Residual friction",
        help: "Friction under a large ultrasonic amplitude over that at rest",
        allowed: "0 to 0.99",
        shown: |feeling| plain(feeling.friction.residual),
        read: |text| quantity::plain(text, ""),
        set: |feeling, value| feeling.friction.residual = value,
    },
    Value {
        name: "Exponent",
        help: "Of the amplitude in the friction curve",
        allowed: "0.1 to 10",
        shown: |feeling| plain(feeling.friction.exponent),
        read: |text| quantity::plain(text, ""),
        set: |feeling, value| feeling.friction.exponent = value,
    },
    Value {
        name: "Least change",
        help: "Smallest fall of the friction that is felt, over the friction at rest",
        allowed: "0.001 to 0.99",
        shown: |feeling| plain(feeling.least_friction_change),
        read: |text| quantity::plain(text, ""),
        set: |feeling, value| feeling.least_friction_change = value,
    },
    Value {
        name: "Contact",
        help: "Length of the fingertip's contact along the plate",
        allowed: "0 to 100 mm",
        shown: |feeling| show_length(feeling.contact_m),
        read: quantity::length_m,
        set: |feeling, value| feeling.contact_m = value,
    },
];

fn plain(value: f64) -> String {
    value.to_string()
}

impl Value {
    /// The edit for a typed text.
    fn typed(&self, setup: &Setup, text: &str) -> Result<Edit, Refusal> {
        let value = Refusal::read(self.name, text, self.allowed, self.read)?;
        let mut feeling = setup.feeling;
        (self.set)(&mut feeling, value);
        Refusal::check(setup, Edit::Feeling(feeling), self.name, text, self.allowed)
    }
}

/// Shows the fields, folded at first.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, typed: &mut Fields, intents: &mut Intents) {
    let setup = scene.setup;
    let fields = egui::CollapsingHeader::new("Feeling, illustrative").show(ui, |ui| {
        for value in &VALUES {
            labelled(ui, value.name, |ui| {
                let shown = (value.shown)(&setup.feeling);
                let hint = format!("{}: {}", value.help, value.allowed);
                let field = InputField::new(value.name, &shown, &hint, 90.0);
                let taken = field.show(ui, typed, |text| value.typed(setup, text));
                intents.extend(taken.map(Intent::Edit));
            });
        }
        ui.button("As it was")
            .on_hover_text("All values as at the first start")
            .asks(intents, Intent::Edit(Edit::Feeling(Feeling::default())));
    });
    fields
        .header_response
        .on_hover_text("The numbers behind the felt edge and the strip: fingers differ, set your own");
}
