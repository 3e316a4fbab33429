//! Lights that depend on the computed amplitude and on the material.

use crate::check::error::CheckError;
use crate::check::grading::{Finding, Site, colour, pick};
use crate::check::report::Colour;
use crate::check::thresholds::{LOSS, THIN_PLATE_PERCENT};
use crate::frequency::equation::Equation;
use crate::frequency::respond::{Response, respond};
use crate::quantity::number_format::with_decimals;
use crate::spec::model::Model;
use crate::spec::plate::Plate;
use crate::table::error::TableError;
use std::f64::consts::TAU;

/// Points of the computed amplitude; the solver's own grid is finer where needed.
pub(super) const POINTS: usize = 513;

/// Loss integral I: the integral of Im k from the driven end to the boundary at `boundary_m` metres, at the boundary's
/// frequency. The wave arrives with e^-I of its amplitude.
///
/// With small eta, I is the integral of eta d(k^2)/d ln(K^2)/(2 k); the derivative is a K^2 except between clamped edges.
/// For the exponential taper with a = 1 it is (eta/2) nu acosh(nu/s0), where nu = K/d and s0 = q/(W0 d).
pub fn loss_integral(plate: &Plate, boundary_m: f64) -> f64 {
    let width_mode = plate.width_mode(1);
    let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
    // 1/k has an inverse-square-root singularity at the turning point, which x = boundary (1 - u^2) removes.
    let steps = 400;
    let total: f64 = (0..steps)
        .map(|i| {
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            let place = boundary_m * (1.0 - u * u);
            let wavenumber = width_mode.wavenumber_squared(place, frequency_hz).max(f64::MIN_POSITIVE).sqrt();
            2.0 * u * width_mode.wavenumber_rise(place, frequency_hz) / wavenumber
        })
        .sum();
    0.5 * plate.wave_loss() * total * boundary_m / f64::from(steps)
}

pub(in crate::check) fn loss_light(site: &Site<'_>) -> Finding {
    let loss = loss_integral(site.plate, site.boundary_m);
    let percent = 100.0 * (-loss).exp();
    let percent_left = if percent < 0.01 { "Less than 0.01 %".to_owned() } else { format!("{percent:.2} %") };
    site.graded(
        "loss",
        loss,
        "",
        LOSS,
        [
            format!(
                "{percent:.0} % of the wave's amplitude arrives at the boundary: the peak stands above the rest."
            ),
            format!(
                "Only {percent:.1} % of the wave's amplitude arrives at the boundary: the drive end vibrates more than the peak."
            ),
            format!("{percent_left} of the wave's amplitude arrives: there is no peak left to feel."),
        ],
    )
}

/// The amplitude over the plate at the site's frequency.
pub(in crate::check) fn response(site: &Site<'_>) -> Result<Response, CheckError> {
    respond(site.plate, site.frequency_hz, POINTS, Equation::Corrected).map_err(|_| {
        CheckError::Table(TableError::Silent { position_m: site.boundary_m, frequency_hz: site.frequency_hz })
    })
}

pub(in crate::check) fn peak_light(site: &Site<'_>) -> Result<Finding, CheckError> {
    let response = response(site)?;
    let (value, colour) = match response.peak {
        Some(peak) if peak.is_largest => (Some(peak.amplitude), Colour::Green),
        Some(peak) => (Some(peak.amplitude), Colour::Amber),
        None => (None, Colour::Red),
    };
    let amplitude = value.unwrap_or(0.0);
    let times = with_decimals(amplitude, 2);
    let at_mm = response.peak.map_or(0.0, |peak| peak.position_m * 1e3);
    Ok(site.judged(
        "peak",
        value,
        "times the drive",
        colour,
        -amplitude,
        pick(colour, [
            format!("The peak stands at {at_mm:.0} mm with {times} times the drive, the largest amplitude on the plate."),
            format!("The peak at {at_mm:.0} mm has {times} times the drive, but other places on the plate vibrate more."),
            "There is no peak before this boundary: the amplitude just falls from the drive on.".to_owned(),
        ]),
    ))
}

pub(in crate::check) fn thin_plate_light(site: &Site<'_>) -> Finding {
    let name = "thin plate";
    let bending = match &site.plate.spec().model {
        Model::BendingSupported(bending) | Model::BendingClamped(bending) => bending,
        Model::Membrane { .. } | Model::ShearHorizontal { .. } => {
            let sentence = "The wave's speed does not depend on the thickness.".to_owned();
            return site.judged(name, None, "%", Colour::Green, 0.0, sentence);
        }
    };
    let mut thick = bending.clone();
    thick.thick_plate = true;
    let mut thin = bending.clone();
    thin.thick_plate = false;
    let omega = TAU * site.frequency_hz;
    let percent = 100.0 * ((thick.wavenumber_squared(omega) / thin.wavenumber_squared(omega)).sqrt() - 1.0);
    if bending.thick_plate {
        let sentence = format!(
            "Shear and rotary inertia are included; without them the wavenumber would be {percent:.1} % too small."
        );
        return site.judged(name, Some(0.0), "%", Colour::Green, 0.0, sentence);
    }
    let colour = colour(percent, THIN_PLATE_PERCENT);
    site.judged(
        name,
        Some(percent),
        "%",
        colour,
        percent,
        pick(colour, [
            format!("The plate is thin for this wave: the thin-plate wavenumber is {percent:.1} % too small."),
            format!(
                "The thin-plate wavenumber is {percent:.1} % too small here: take it as a thick plate (thick_plate = true) to place the boundary better."
            ),
            format!(
                "The thin-plate wavenumber is {percent:.1} % too small: this is a thick plate for the wave, take it as one (thick_plate = true)."
            ),
        ]),
    )
}
