//! The light for the air that swings with the plate.

use crate::check::grading::{Finding, Site};
use crate::check::report::Colour;
use crate::check::stretch::Stretch;
use crate::check::thresholds::AIR_MM;
use crate::definition::air::{Air, AirMounting, Faces, Gas};
use crate::definition::model::Model;
use crate::quantity::number_format::with_decimals;
use crate::quantity::show_length;

/// The table that is warned of: a frame with feet of 10 mm, metres.
const NEAR_M: f64 = 0.01;

/// Its value is the possible distance of the peak from the place in the file, mm. Without `[air]` it is the shift by
/// air on both faces in a baffle, the largest of all mountings. With it, it is the uncertainty of the coefficient, or on a light
/// membrane in a baffle how far the law of the air is from the field in two dimensions, if that is more.
///
/// It is never red: a wave speed that was measured in the air holds the air already, but for its course over the frequency.
pub(in crate::check) fn air_light(site: &Site<'_>) -> Finding {
    let name = "air";
    let light = |value: Option<f64>, colour: Colour, sentence: String| {
        let severity = value.unwrap_or(0.0);
        let whole = || vec![Stretch { from_m: 0.0, to_m: site.boundary_m }];
        site.judged(name, value, "mm", colour, severity, sentence).over(whole)
    };
    let spec = site.plate.spec();
    match (&spec.model, &spec.air) {
        (Model::ShearHorizontal { .. }, _) => {
            let sentence = "A shear wave moves in its own plane and carries no air.".to_owned();
            light(None, Colour::Green, sentence)
        }
        (_, Some(Air::Vacuum)) => light(None, Colour::Green, "The plate swings in a vacuum.".to_owned()),
        (_, Some(Air::Around { mounting, .. })) => {
            let moved = shift_mm(site, spec.air.as_ref());
            let open = mounting.deviation() * moved.abs();
            let table = table(site, moved);
            let moves =
                format!("The air moves the peak by {} mm{table}, which is counted", with_decimals(moved, 1));
            if spec.calibration.is_some() {
                let sentence = format!("{moves}: its coefficient was measured.");
                return light(None, Colour::Green, sentence);
            }
            let law = site.prepared.air_law.as_ref();
            let off = law.map_or(0.0, |law| 1e3 * law.off_m(site.plate, site.boundary_m));
            if off.abs() > open {
                let (off_mm, way) =
                    (with_decimals(off.abs(), 1), if off > 0.0 { "farther" } else { "nearer" });
                let (colour, sentence) = graded(
                    off,
                    format!("{moves}; in two dimensions it is {off_mm} mm {way}."),
                    format!(
                        "{moves}, but in two dimensions the peak is {off_mm} mm {way}: compute each boundary in two dimensions, or take a heavier film."
                    ),
                );
                return light(Some(off.abs()), colour, sentence);
            }
            let open_mm = with_decimals(open, 1);
            let (colour, sentence) = graded(
                open,
                format!("{moves}; {open_mm} mm of it are open."),
                format!("{moves}, and {open_mm} mm of it are open: measure two boundaries, or calibrate."),
            );
            light(Some(open), colour, sentence + &beside_a_table(site, moved))
        }
        (_, None) => {
            let mounting = AirMounting::Baffle { faces: Faces::Two };
            let air = Some(Air::Around { gas: Gas::ROOM, mounting, gap_m: None });
            if spec.model.surface_density(name).is_err() {
                let sentence = "Not known without the membrane's tension: give tension_n_per_m.".to_owned();
                return light(None, Colour::Unchecked, sentence);
            }
            let off = shift_mm(site, air.as_ref());
            let words = with_decimals(off, if off.abs() < 0.1 { 2 } else { 1 });
            if spec.calibration.is_some() {
                let sentence =
                    format!("Air moves a peak by up to {words} mm here; the measurement includes it.");
                return light(None, Colour::Green, sentence);
            }
            let (colour, sentence) = graded(
                off,
                format!("The file knows of no air, which moves the peak by {words} mm at most."),
                format!(
                    "The file knows of no air, which moves the peak by up to {words} mm: add a section [air], unless the wave speed was measured in it."
                ),
            );
            light(Some(off), colour, sentence)
        }
    }
}

/// What a stated table below does of the `moved_mm` by which the air moves the peak, within a sentence; nothing without one.
fn table(site: &Site<'_>, moved_mm: f64) -> String {
    let Some(Air::Around { gas, mounting, gap_m: Some(gap_m) }) = site.plate.spec().air else {
        return String::new();
    };
    let open = Air::Around { gas, mounting, gap_m: None };
    let by_mm = moved_mm - shift_mm(site, Some(&open));
    format!(", {} mm of it by the table {} below", with_decimals(by_mm, 1), show_length(gap_m))
}

/// What a table would do that the file does not state, beyond the `moved_mm` of the air, as a sentence behind another; nothing where
/// it does little.
fn beside_a_table(site: &Site<'_>, moved_mm: f64) -> String {
    let Some(Air::Around { gas, mounting, gap_m: None }) = site.plate.spec().air else {
        return String::new();
    };
    if let AirMounting::Baffle { .. } = mounting {
        return String::new();
    }
    let near = Air::Around { gas, mounting, gap_m: Some(NEAR_M) };
    let by_mm = shift_mm(site, Some(&near)) - moved_mm;
    if by_mm <= AIR_MM {
        return String::new();
    }
    format!(
        " A table {} below would move it by another {} mm: leave 50 mm free, or state gap_m.",
        show_length(NEAR_M),
        with_decimals(by_mm, 0)
    )
}

/// The colour of `mm`, and its sentence.
fn graded(mm: f64, green: String, amber: String) -> (Colour, String) {
    if mm.abs() <= AIR_MM { (Colour::Green, green) } else { (Colour::Amber, amber) }
}

/// [`crate::Plate::air_shift_m`], mm.
fn shift_mm(site: &Site<'_>, air: Option<&Air>) -> f64 {
    1e3 * site.plate.air_shift_m(air, site.boundary_m)
}
