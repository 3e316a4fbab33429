//! The light for the air that swings with the plate.

use crate::check::grading::{Finding, Site};
use crate::check::report::Colour;
use crate::check::stretch::Stretch;
use crate::check::thresholds::{AIR_MM, AIR_OPEN};
use crate::definition::air::{Air, AirLoad, AirMounting, Faces, Gas};
use crate::definition::free_wave::FreeWave;
use crate::definition::model::Model;
use crate::quantity::number_format::with_decimals;
use crate::special::airy;

/// Its value is how far the peak may be from where the file puts it, mm. Without `[air]` that is what air on both faces in a
/// baffle does, the most that a mounting can. With it, it is what the coefficient leaves open.
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
        (_, Some(Air::Around { .. })) => {
            let moved = shift_mm(site, spec.air.as_ref());
            let open = AIR_OPEN * moved.abs();
            let moves = format!("The air moves the peak by {} mm, which is counted", with_decimals(moved, 1));
            let open_mm = with_decimals(open, 1);
            let (colour, sentence) = graded(
                open,
                format!("{moves}; {open_mm} mm of it are open."),
                format!("{moves}, and {open_mm} mm of it are open: measure two boundaries, or calibrate."),
            );
            light(Some(open), colour, sentence)
        }
        (_, None) => {
            let mounting = AirMounting::Baffle { faces: Faces::Two };
            let air = Some(Air::Around { gas: Gas::ROOM, mounting });
            if spec.model.surface_density(name).is_err() {
                let sentence = "Not known without the membrane's tension: give tension_n_per_m.".to_owned();
                return light(None, Colour::Unchecked, sentence);
            }
            let off = shift_mm(site, air.as_ref());
            let words = with_decimals(off, if off.abs() < 0.1 { 2 } else { 1 });
            if spec.calibration.is_some() {
                let sentence =
                    format!("Air moves a peak by up to {words} mm here; what was measured holds it.");
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

/// `mm` as a colour, and the sentence that goes with it.
fn graded(mm: f64, green: String, amber: String) -> (Colour, String) {
    if mm.abs() <= AIR_MM { (Colour::Green, green) } else { (Colour::Amber, amber) }
}

/// How much farther from the drive `air` puts the peak of the frequency that turns at the boundary in a vacuum, mm: the
/// peaks of the Airy form.
fn shift_mm(site: &Site<'_>, air: Option<&Air>) -> f64 {
    let (plate, model) = (site.plate, &site.plate.spec().model);
    let width_mode = plate.width_mode(1);
    let still = FreeWave { model, load: None };
    let loaded = FreeWave { model, load: AirLoad::of(air, model) };
    let turning = width_mode.number / plate.turning_at(site.boundary_m).0.exp();
    let omega = still.angular_frequency(turning * turning);
    let peak_m = |wave: FreeWave<'_>| {
        let x0 = width_mode.place_of(wave.wavenumber_squared(omega).sqrt());
        x0 - airy::PEAK_OFFSET / width_mode.fall(x0).cbrt()
    };
    1e3 * (peak_m(loaded) - peak_m(still))
}
