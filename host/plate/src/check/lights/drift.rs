//! Lights for what moves the boundary on a table: temperature, humidity and age of a stretched sheet, and a finger that presses.

use crate::check::grading::{Finding, Site};
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::{DRIFT_MM_PER_K, PRESS_MM};
use crate::definition::model::Model;
use crate::definition::stretch::{Drift, HUMID_K, PRESS_N};
use crate::quantity::number_format::{significant, with_decimals};
use crate::quantity::show_length;

/// Its value is the shift of the boundary by one kelvin, mm; its sentence has humidity and age, too.
pub(in crate::check) fn drift_light(site: &Site<'_>) -> Finding {
    let name = "drift";
    let light = |colour: Colour, sentence: String| site.judged(name, None, "mm/K", colour, 0.0, sentence);
    let Some(drift) = site.plate.drift(site.boundary_m) else {
        let sentence = "The plate has no tension that temperature, humidity or age could change: a kelvin moves the boundary by \
                        hundredths of a millimetre.";
        return light(Colour::Green, sentence.to_owned());
    };
    let ages = ages(&drift, site.plate.spec().calibration.is_some());
    let (Some(strain), Some(kelvin_m)) = (drift.strain, drift.kelvin_m) else {
        let sentence = format!(
            "The file has an ideal membrane, whose strain is not known: give youngs_modulus_pa, poisson_ratio and thickness_m.{ages}"
        );
        return light(Colour::Unchecked, sentence);
    };
    let percent_or_ppm = if strain >= 1e-3 {
        format!("{} %", significant(100.0 * strain, 2))
    } else {
        format!("{} ppm", significant(1e6 * strain, 2))
    };
    let stretched = format!("The film is stretched by {percent_or_ppm}");
    let moves = show_length(kelvin_m);
    let humid = if drift.swells {
        format!(", and 10 % of humidity as far as {} K", with_decimals(HUMID_K, 0))
    } else {
        String::new()
    };
    let sentences = [
        format!("{stretched}: one kelvin moves the boundary by {moves}{humid}.{ages}"),
        format!(
            "{stretched} alone: one kelvin moves the boundary by {moves}{humid}. Let it settle, or stretch it more.{ages}"
        ),
        format!(
            "{stretched} alone and is a thermometer: in a frame that expands by 6 ppm per kelvin more or less than it, one \
             kelvin moves the boundary by {moves}{humid}. Take a thinner film, a faster wave, or rubber.{ages}"
        ),
    ];
    site.graded(name, 1e3 * kelvin_m, "mm/K", Limit::AtMost(DRIFT_MM_PER_K), sentences)
        .over(|| vec![Stretch { from_m: 0.0, to_m: site.boundary_m }])
}

/// The effect of age, as a sentence to append; empty for a film that is no rubber.
fn ages(drift: &Drift, is_calibrated: bool) -> String {
    let Some(decade_m) = drift.decade_m else { return String::new() };
    let which = if drift.strain.is_some() { "Rubber" } else { "If it is rubber it" };
    let then = if is_calibrated { "the calibration ages: trim or calibrate" } else { "measure it" };
    format!(
        " {which} loses some 3 % of its tension, {} of the boundary, while its age grows tenfold: {then} again after a day and \
         after a month.",
        show_length(decade_m)
    )
}

/// Its value is how far a finger sinks in at the boundary that presses with 0.5 N, mm. Amber at most: a finger that strokes does
/// not press.
pub(in crate::check) fn press_light(site: &Site<'_>) -> Finding {
    let name = "press";
    let Some(press_m) = site.plate.press_m(site.boundary_m) else {
        let (colour, sentence) = match site.plate.spec().model {
            Model::Membrane { .. } => {
                (Colour::Unchecked, "Not known without the membrane's tension: give tension_n_per_m.")
            }
            _ => (
                Colour::Green,
                "The plate's own stiffness carries a finger that presses: it does not sink in.",
            ),
        };
        return site.judged(name, None, "mm", colour, 0.0, sentence.to_owned());
    };
    let sinks = format!("A finger that presses with {PRESS_N} N sinks in by {}", show_length(press_m));
    let value = 1e3 * press_m;
    let (colour, sentence) = if value <= PRESS_MM {
        (Colour::Green, format!("{sinks}: its press does not move the boundary."))
    } else {
        let sentence = format!(
            "{sinks}, which stretches the sheet and moves the boundary: stroke it, or take more tension."
        );
        (Colour::Amber, sentence)
    };
    site.judged(name, Some(value), "mm", colour, value, sentence).at(site.boundary_m)
}
