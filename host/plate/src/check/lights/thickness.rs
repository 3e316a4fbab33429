//! The light for a plate that is too thick for its wave or for its own width.

use crate::check::grading::{Finding, Site, colour, pick};
use crate::check::interval::Interval;
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::{FILM_PERCENT, THICKNESS_SHARE, THIN_PLATE_PERCENT};
use crate::definition::film::FilmEdge;
use crate::definition::model::{Bending, Model};
use crate::definition::plate::Plate;
use crate::quantity::number_format::{at_most, with_decimals};
use crate::quantity::show_length;
use std::f64::consts::TAU;

/// Its value is what the wavenumber misses, in %: Mindlin's relation against the thin plate's, both for K h. Where the plate
/// is thick against its own width that decides instead, also for a plate that is taken as thick. Of a membrane it is what the
/// stiffness of its film leaves open.
pub(in crate::check) fn thin_plate_light(site: &Site<'_>) -> Finding {
    let name = "thin plate";
    let bending = match &site.plate.spec().model {
        Model::BendingSupported(bending) | Model::BendingClamped(bending) => bending,
        Model::Membrane { .. } => return film_light(site, name),
        Model::ShearHorizontal { .. } => {
            let sentence = "The wave's speed does not depend on the thickness.".to_owned();
            return site.judged(name, None, "%", Colour::Green, 0.0, sentence);
        }
    };
    // The plate is narrowest, and the wave shortest, at the boundary.
    let thickness_at = |plate: &Plate, x: f64| plate.thickness_m(x).unwrap_or(bending.thickness_m);
    let share_on = |plate: &Plate, x: f64| thickness_at(plate, x) / (2.0 * plate.half_width_m(x));
    let share_at = |x: f64| share_on(site.plate, x);
    let share = share_at(site.boundary_m);
    // K h goes with the root of the thickness, so the wave is shortest against it where the plate is thickest.
    let thickest = |plate: &Plate, bending: &Bending, to_m: f64| {
        let places = (0..=PLACES).map(|i| to_m * f64::from(i) / f64::from(PLACES));
        let thickness_m = places.map(|x| thickness_at(plate, x)).fold(bending.thickness_m, f64::max);
        Bending { thickness_m, ..bending.clone() }
    };
    let percent = missed_percent(&thickest(site.plate, bending, site.boundary_m), site.frequency_hz);
    let by_width = colour(share, THICKNESS_SHARE);
    let missed_by = |percent: f64| {
        if bending.thick_plate {
            (0.0, Colour::Green)
        } else {
            (percent, colour(percent, THIN_PLATE_PERCENT))
        }
    };
    let (missed, by_wave) = missed_by(percent);
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
    let found = site
        .judged(name, Some(missed), "%", by_wave.max(by_width), severity, sentence)
        .over_interval(site, Interval::boundary, |end| {
            let bending = end.plate.spec().model.bending().unwrap_or(bending);
            let bending = thickest(&end.plate, bending, end.boundary_m);
            let (missed, by_wave) = missed_by(missed_percent(&bending, site.frequency_hz));
            (missed, by_wave.max(colour(share_on(&end.plate, end.boundary_m), THICKNESS_SHARE)))
        });
    if by_width > by_wave {
        let fails = |x: f64| colour(share_at(x), THICKNESS_SHARE) > Colour::Green;
        found.over(|| vec![Stretch::about(site.boundary_m, site.boundary_m, fails)])
    } else {
        // The wave is as short against the thickness on its whole way.
        let whole = || vec![Stretch { from_m: 0.0, to_m: site.boundary_m }];
        found.limited(Limit::AtMost(THIN_PLATE_PERCENT)).over(whole)
    }
}

/// A film's stiffness: its value is how much the law of the turning half-width misses of the wavenumber just before the
/// boundary, %.
fn film_light(site: &Site<'_>, name: &'static str) -> Finding {
    let model = &site.plate.spec().model;
    let half_width_m = site.plate.half_width_m(site.boundary_m);
    let (Some(film), Some(square)) = (model.film(), model.film_square()) else {
        let sentence = if site.plate.spec().calibration.is_some() {
            "The file has an ideal membrane; what a film's stiffness does was measured with the rest."
        } else {
            "The file has an ideal membrane. A film's stiffness raises its frequencies: give youngs_modulus_pa, poisson_ratio and thickness_m."
        };
        return site.judged(name, None, "%", Colour::Green, 0.0, sentence.to_owned());
    };
    let edge_m = square.sqrt();
    let percent = FilmEdge::new(half_width_m / edge_m).missed_percent();
    let narrower = format!(
        "The film's stiffness makes the plate {} narrower for the wave here, which is counted",
        show_length(2.0 * (half_width_m - site.plate.swinging_half_width_m(site.boundary_m)))
    );
    let thinner = format!(
        "a film of up to {} of this material, at the same wave speed, is near to a membrane",
        show_length(at_most(film.thickest_m(FILM_PERCENT.green, edge_m, half_width_m), 2))
    );
    let missed = with_decimals(percent, 1);
    let sentences = [
        format!("{narrower}."),
        format!("{narrower} but for {missed} % of the wavenumber: {thinner}."),
        format!(
            "This film is a plate rather than a membrane here, {missed} % of the wavenumber is missed: {thinner}."
        ),
    ];
    site.graded(name, percent, "%", FILM_PERCENT, sentences)
        .over_interval(site, Interval::boundary, |end| {
            let edge = end.plate.film_edge(end.boundary_m);
            let percent = edge.map_or(percent, FilmEdge::missed_percent);
            (percent, colour(percent, FILM_PERCENT))
        })
        .over(|| {
            let fails = |x: f64| {
                let edge = site.plate.film_edge(x);
                edge.is_some_and(|edge| edge.missed_percent() > FILM_PERCENT.green)
            };
            vec![Stretch::about(site.boundary_m, site.boundary_m, fails)]
        })
}

/// Intervals up to the boundary at which the thickness is looked at.
const PLACES: u32 = 16;

/// How much larger Mindlin's wavenumber is than the thin plate's, %.
fn missed_percent(bending: &Bending, frequency_hz: f64) -> f64 {
    let squared =
        |thick_plate: bool| Bending { thick_plate, ..bending.clone() }.wavenumber_squared(TAU * frequency_hz);
    100.0 * ((squared(true) / squared(false)).sqrt() - 1.0)
}
