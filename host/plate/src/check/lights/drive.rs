//! The light for the driven end: its reflection of the returning wave.

use crate::check::grading::{Finding, Site, colour};
use crate::check::interval::{End, Interval};
use crate::check::report::{Colour, Limit};
use crate::check::thresholds::DRIVE_REFLECTION;
use crate::definition::drive::DriveEnd;
use crate::definition::impedance::Impedance;
use crate::definition::plate::Plate;
use crate::definition::source::Source;
use crate::frequency::driven_end::{reflection, resistance_reflection};
use crate::quantity::show_si;

/// The light's value is |r| of the real end; for an end in bending whose near field the file leaves out, that of the
/// free end with the same damper.
pub(in crate::check) fn match_light(site: &Site<'_>) -> Finding {
    let reflected = |plate: &Plate| reflection(plate, site.frequency_hz).map_or(1.0, |r| r.norm());
    let in_equation = reflected(site.plate);
    let end = site.plate.spec().drive_end;
    let is_one_mode_bending =
        site.plate.spec().model.bending().is_some() && matches!(end, DriveEnd::Resistance { .. });
    let value_of = |plate: &Plate, in_equation: f64| {
        if is_one_mode_bending {
            resistance_reflection(plate, site.frequency_hz).map(|r| r.norm())
        } else {
            Some(in_equation)
        }
    };
    let value = value_of(site.plate, in_equation);
    let at_least = if is_one_mode_bending { Colour::Amber } else { Colour::Green };
    let colour_of = |in_equation: f64| colour(in_equation, DRIVE_REFLECTION).max(at_least);
    let judged = colour_of(in_equation);
    let percent = 100.0 * value.unwrap_or(in_equation);
    let sentence = match (judged, end) {
        (_, DriveEnd::Resistance { .. }) if is_one_mode_bending => {
            let really = value.map_or_else(
                || "an unknown share".to_owned(),
                |_| format!("{percent:.0} %"),
            );
            format!(
                "A damper alone does not match a plate in bending: at a real end it sends {really} of the returning wave back (this file leaves the near field out). Use a source with a damped lead-in."
            )
        }
        (Colour::Green | Colour::Unchecked, _) => format!(
            "The drive end absorbs the returning wave ({percent:.0} % comes back): the plate hardly resonates."
        ),
        (_, DriveEnd::Source(source)) if hides_its_match(site, source) => format!(
            "The mass and the stiffness of the drive end hide the resistance that would absorb the wave: {percent:.0} % of it comes back. Use a softer actuator."
        ),
        (Colour::Amber, _) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: the plate resonates a little; a closer match of its resistance helps."
        ),
        (Colour::Red, DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. }) => {
            "The drive end holds its displacement and sends every wave back: the plate is a resonator, and a damper or a lead-in behind it would be hidden. Drive it by a force.".to_owned()
        }
        (Colour::Red, DriveEnd::Force { .. }) => {
            "The drive end holds its force and sends every wave back: the plate is a resonator, put a damper at its end.".to_owned()
        }
        (Colour::Red, DriveEnd::Resistance { .. }) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: choose its resistance for this frequency."
        ),
        (Colour::Red, DriveEnd::Source(_)) if site.plate.spec().model.bending().is_some() => format!(
            "The drive end sends {percent:.0} % of the returning wave back: give it a longer or more lossy lead-in."
        ),
        (Colour::Red, DriveEnd::Source(_)) => format!(
            "The drive end sends {percent:.0} % of the returning wave back: give it the wave's resistance, and less mass and stiffness."
        ),
    };
    let found = site
        .judged("drive match", value, "", judged, in_equation, sentence)
        .over_corners(
            site,
            |interval| known(site, interval),
            |end| {
                let plates = with_losses(site, end);
                let plates = plates.iter().flat_map(|plate| with_sources(plate, source_tolerance(site)));
                let judged = plates.map(|plate| {
                    let in_equation = reflected(&plate);
                    let value = value_of(&plate, in_equation).unwrap_or(in_equation);
                    (value, colour_of(in_equation))
                });
                judged.collect()
            },
        )
        .at(0.0);
    // The limit does not apply to the value here: the colour follows from the equation, the value from the end with
    // its near field.
    if is_one_mode_bending { found } else { found.limited(Limit::AtMost(DRIVE_REFLECTION)) }
}

fn source_tolerance(site: &Site<'_>) -> Option<Impedance> {
    site.plate.spec().calibration.as_ref()?.source_tolerance
}

/// The accuracy of the quantities behind the light, in words.
fn known(site: &Site<'_>, interval: &Interval) -> String {
    match source_tolerance(site) {
        Some(half) => format!(
            "{}, the drive's resistance to ±{}",
            interval.boundary(),
            show_si(half.resistance_n_s_per_m, "N s/m")
        ),
        None => format!("{}; the drive is as stated in the file, not measured", interval.boundary()),
    }
}

/// The plate with the lowest and the highest loss of the interval. Between clamped edges a loss needs its own law,
/// which takes long to compute, and the reflection hardly depends on it: there the plate is returned unchanged.
fn with_losses(site: &Site<'_>, end: &End) -> Vec<Plate> {
    let is_clamped = end.plate.spec().model.is_clamped();
    let factor = site.interval.as_ref().filter(|_| !is_clamped).map_or(1.0, |interval| interval.loss);
    let lossy = [factor.recip(), factor].into_iter().filter_map(|factor| end.plate.with_loss(factor).ok());
    if is_clamped { vec![end.plate.clone()] } else { lossy.collect() }
}

/// The plate with its source at the corners of the interval. The impedances with a reflection of at most a given
/// value below 1 fill a disc in the plane of resistance and reactance, so a limit that holds at the corners holds
/// between them.
fn with_sources(plate: &Plate, half: Option<Impedance>) -> Vec<Plate> {
    let (Some(half), DriveEnd::Source(source)) = (half, plate.spec().drive_end) else {
        return vec![plate.clone()];
    };
    let Impedance { resistance_n_s_per_m, mass_kg, stiffness_n_per_m } = source.impedance;
    let at_corner = |[resists, reacts]: [f64; 2]| {
        let impedance = Impedance {
            resistance_n_s_per_m: (resistance_n_s_per_m + resists * half.resistance_n_s_per_m).max(0.0),
            mass_kg: (mass_kg + reacts * half.mass_kg).max(0.0),
            stiffness_n_per_m: (stiffness_n_per_m - reacts * half.stiffness_n_per_m).max(0.0),
        };
        plate.with_drive_end(DriveEnd::Source(Source { impedance, ..source }))
    };
    [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(at_corner).to_vec()
}

/// Whether the end would match without its own mass and stiffness.
fn hides_its_match(site: &Site<'_>, source: Source) -> bool {
    let mut spec = site.plate.spec().clone();
    let impedance = Impedance::damper(source.impedance.resistance_n_s_per_m);
    spec.drive_end = DriveEnd::Source(Source { impedance, ..source });
    let soft = Plate::new(spec).ok().and_then(|plate| reflection(&plate, site.frequency_hz));
    soft.is_some_and(|r| r.norm() <= DRIVE_REFLECTION.green)
}
