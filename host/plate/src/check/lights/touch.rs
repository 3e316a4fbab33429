//! Lights for the finger on the plate: whether it finds room between the edges, and whether the peak survives it.

use crate::check::grading::{Finding, Site};
use crate::check::report::Colour;
use crate::check::thresholds::{FINGER_LOAD, FINGERTIP_M, WIDTH};
use crate::frequency::Finger;
use crate::quantity::number_format::with_decimals;
use crate::spec::plate::Plate;
use crate::special::airy;
use std::f64::consts::PI;

/// Whether a fingertip fits between the edges at the boundary; the value is the plate's width there in fingertips.
pub(in crate::check) fn width_light(site: &Site<'_>) -> Finding {
    let width_m = 2.0 * site.plate.half_width_m(site.boundary_m);
    let fingers = width_m / FINGERTIP_M;
    let millimetres = with_decimals(width_m * 1e3, 1);
    let colour = if fingers >= WIDTH.green {
        Colour::Green
    } else if fingers >= WIDTH.amber {
        Colour::Amber
    } else {
        Colour::Red
    };
    let told = match colour {
        Colour::Green | Colour::Unchecked => "a fingertip rests between the edges",
        Colour::Amber => "a fingertip also rests on the edges, which do not move",
        Colour::Red => "most of a fingertip rests on the edges, which do not move",
    };
    let sentence = format!("The plate is {millimetres} mm wide at the boundary: {told}.");
    site.judged("width", Some(fingers), "fingertips", colour, -fingers, sentence)
}

/// |Z_f|/Z of a light touch, and what it takes from the peak.
pub(in crate::check) fn finger_load_light(site: &Site<'_>) -> Finding {
    let name = "finger load";
    let Ok(light) = Finger::light(site.boundary_m).load(site.plate, site.frequency_hz) else {
        let sentence = "The plate file tells no tension or thickness: how heavy a finger is for the wave was not checked.";
        return site.judged(name, None, "", Colour::Unchecked, 0.0, sentence.to_owned());
    };
    let firm = Finger::firm(site.boundary_m).load(site.plate, site.frequency_hz).unwrap_or(f64::NAN);
    let [light_db, firm_db] =
        [light, firm].map(|load| with_decimals(touched_db(site.plate, site.frequency_hz, load), 1));
    let costs =
        format!("A light touch takes about {light_db} dB from the peak under it, a firm press {firm_db} dB");
    site.graded(
        name,
        light,
        "",
        FINGER_LOAD,
        [
            format!("{costs}: the peak survives a light touch."),
            format!("{costs}: the peak is felt weaker than it is computed; a heavier plate keeps it."),
            format!("{costs}: a finger stops the wave that it should feel, take a heavier plate."),
        ],
    )
}

/// By how many dB a finger of that load lowers the peak under it, on a plate whose driven end sends nothing back.
///
/// The wave of a driven end that launches 1 stands before its turning point as 2 sqrt(pi k0 W0/(kappa W)) Ai, with its peak
/// P = 0.5357 times that factor. What a finger there pushes back travels to the driven end, with the amplitude that reciprocity gives a
/// force at the peak: P/(2 omega Z) of it. Its power 1/2 Z omega^2 |.|^2 is that of the force on the velocity under it, so
/// the plate answers the finger with the mobility P^2/(4 Z), and the peak is lower by 1 + (P^2/4) |Z_f|/Z.
pub(in crate::check) fn touched_db(plate: &Plate, frequency_hz: f64, load: f64) -> f64 {
    let mode = plate.width_mode(1);
    let k0 = mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
    let turning_width = plate.half_width_m(mode.turning_point_m(frequency_hz));
    let kappa = plate.kappa_per_m(frequency_hz).unwrap_or(f64::NAN);
    let quarter_square =
        PI * airy::PEAK_VALUE.powi(2) * k0 * plate.half_width_m(0.0) / (kappa * turning_width);
    20.0 * (1.0 + quarter_square * load).log10()
}
