//! The light for a plate that is too thick for its wave or for its own width.

use crate::check::grading::{Finding, Site, colour, pick};
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::{THICKNESS_SHARE, THIN_PLATE_PERCENT};
use crate::quantity::number_format::with_decimals;
use crate::spec::model::Model;
use std::f64::consts::TAU;

/// Its value is what the wavenumber misses, in %: Mindlin's relation against the thin plate's, both for K h. Where the plate
/// is thick against its own width that decides instead, also for a plate that is taken as thick.
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
    // The plate is narrowest, and the wave shortest, at the boundary.
    let share_at = |x: f64| bending.thickness_m / (2.0 * site.plate.half_width_m(x));
    let share = share_at(site.boundary_m);
    let percent = 100.0 * ((thick.wavenumber_squared(omega) / thin.wavenumber_squared(omega)).sqrt() - 1.0);
    let by_width = colour(share, THICKNESS_SHARE);
    let by_wave = if bending.thick_plate { Colour::Green } else { colour(percent, THIN_PLATE_PERCENT) };
    let missed = if bending.thick_plate { 0.0 } else { percent };
    // By how much each number exceeds its green limit, so that the two can be compared over a span.
    let severity = (share / THICKNESS_SHARE.green).max(missed / THIN_PLATE_PERCENT.green);
    let shares = format!("the plate is {} times as thick as it is wide here", with_decimals(share, 2));
    let sentence = if by_width > by_wave {
        pick(
            by_width,
            [
                String::new(),
                format!(
                    "For any plate theory {shares}, which is much: measure before you trust the boundary."
                ),
                format!("No plate theory holds: {shares}, take a thinner or a wider plate."),
            ],
        )
    } else if bending.thick_plate {
        format!("Shear and rotary inertia are included, {percent:.1} % of the wavenumber, and {shares}.")
    } else {
        pick(
            by_wave,
            [
                format!(
                    "The plate is thin for this wave: the thin-plate wavenumber is {percent:.1} % too small."
                ),
                format!(
                    "The thin-plate wavenumber is {percent:.1} % too small here: take it as a thick plate (thick_plate = true) to place the boundary better."
                ),
                format!(
                    "The thin-plate wavenumber is {percent:.1} % too small: this is a thick plate for the wave, take it as one (thick_plate = true)."
                ),
            ],
        )
    };
    let found = site.judged(name, Some(missed), "%", by_wave.max(by_width), severity, sentence);
    if by_width > by_wave {
        let fails = |x: f64| colour(share_at(x), THICKNESS_SHARE) > Colour::Green;
        found.over(|| vec![Stretch::about(site.boundary_m, site.boundary_m, fails)])
    } else {
        // The wave is as short against the thickness on its whole way.
        let whole = || vec![Stretch { from_m: 0.0, to_m: site.boundary_m }];
        found.limited(Limit::AtMost(THIN_PLATE_PERCENT)).over(whole)
    }
}
