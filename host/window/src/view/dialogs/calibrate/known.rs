//! The first page: the plate file, and the dimensions measured by calipers and a rule.

use super::wrapped;
use crate::caption::Panel;
use crate::intent::{CalibrateIntent, Intent, Intents};
use crate::view::fields::field::{InputField, labelled};
use crate::view::state::ViewState;
use eframe::egui;
use slipline_instrument::calibration::CalibrationWizard;
use slipline_plate::calibrate::Calipers;
use slipline_plate::quantity::{self, OutOfRange, Range, Unit};

/// Digits of a length in its field.
const DIGITS: usize = 6;
/// How well calipers may know a width, metres: one standard deviation of the whole width.
const TOLERANCE: Range = Range::new(2e-7, 0.02, "m");

pub(super) fn show(
    ui: &mut egui::Ui,
    calibration: &CalibrationWizard,
    view: &mut ViewState,
    intents: &mut Intents,
) {
    let name = calibration.plate().name();
    wrapped(
        ui,
        format!(
            "The file of the plate is \"{name}\". The response of one sensor at two places gives its wave speed, its \
             loss and the gain of the drive. It takes some minutes, and you need a sensor and a ruler."
        ),
    );
    ui.add_space(4.0);
    let mut ask =
        |calipers: Option<Calipers>| intents.push(Intent::Calibrate(CalibrateIntent::Calipers(calipers)));
    let mut is_measured = calibration.calipers().is_some();
    let switch = ui.checkbox(&mut is_measured, "I measured width and length with calipers");
    if switch.on_hover_text("Otherwise they are those of the file, to 0.3 % and 0.4 %").changed() {
        ask(is_measured.then(|| calibration.calipers_of_file()));
    }
    let Some(calipers) = calibration.calipers() else { return };
    ui.add_space(2.0);
    type Put = fn(&mut Calipers, f64);
    let fields: [(&str, f64, Put); 4] = [
        ("Width, driven end", 2.0 * calipers.half_width_m, |it, value| it.half_width_m = 0.5 * value),
        ("Width, narrow end", 2.0 * calipers.end_half_width_m, |it, value| it.end_half_width_m = 0.5 * value),
        ("Length", calipers.length_m, |it, value| it.length_m = value),
        ("Widths known to", 2.0 * calipers.tolerance_m, |it, value| it.tolerance_m = 0.5 * value),
    ];
    for (name, value_m, put) in fields {
        labelled(ui, name, |ui| {
            let value = Unit::Millimetre.written(value_m, DIGITS);
            let hint = "A length (32 mm), of the whole width; for the tolerance, one standard deviation";
            let field = InputField::new(name, &value, hint, 120.0);
            let taken = field.show(ui, &mut view.fields, |text| {
                let value_m = quantity::length_m(text).map_err(|error| error.to_string())?;
                if name == "Widths known to" {
                    OutOfRange::check(name, value_m, TOLERANCE).map_err(|error| error.to_string())?;
                }
                let mut typed = calipers;
                put(&mut typed, value_m);
                let plate = typed.applied_to(calibration.plate());
                plate.map(|_| typed).map_err(|error| error.worded(&Panel::Plate))
            });
            if let Some(typed) = taken {
                ask(Some(typed));
            }
        });
    }
}
