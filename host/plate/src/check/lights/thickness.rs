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

/// The light "thin plate". For bending its value is the excess of Mindlin's wavenumber over the thin plate's at the
/// same frequency, %; 0 for a plate that is computed as thick. Thickness over width has limits of its own, for thick
/// plates too, and decides colour and sentence where its colour is worse. For a membrane the value is that of
/// [`film_light`].
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
    // As far as the wave travels, the plate is narrowest at the boundary.
    let thickness_at = |plate: &Plate, x: f64| plate.thickness_m(x).unwrap_or(bending.thickness_m);
    let share_on = |plate: &Plate, x: f64| thickness_at(plate, x) / (2.0 * plate.half_width_m(x));
    let share_at = |x: f64| share_on(site.plate, x);
    let share = share_at(site.boundary_m);
    // K h is proportional to the root of the thickness, so it is largest where the plate is thickest.
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
    // The larger ratio of a value to its green limit, to compare both criteria over a span.
    let severity = (share / THICKNESS_SHARE.green).max(missed / THIN_PLATE_PERCENT.green);
    let shares = format!("the plate is {} times as thick as it is wide here", with_decimals(share, 2));
    let sentence = if by_width > by_wave {
        pick(
            by_width,
            [
                String::new(),
                format!(
                    "No plate theory is certain here, because {shares}: measure before you trust the boundary."
                ),
                format!("No plate theory holds here, because {shares}: take a thinner or a wider plate."),
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
        // K h is large on the whole way to the boundary.
        let whole = || vec![Stretch { from_m: 0.0, to_m: site.boundary_m }];
        found.limited(Limit::AtMost(THIN_PLATE_PERCENT)).over(whole)
    }
}

/// Light for the stiffness of a film. Its value is the amount by which the turning half-width underestimates the
/// wavenumber just before the boundary, %.
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
        format!("{narrower}, except for {missed} % of the wavenumber: {thinner}."),
        format!(
            "This film is a plate rather than a membrane here, {missed} % of the wavenumber is missed: {thinner}."
        ),
    ];
    site.graded(name, percent, "%", Limit::AtMost(FILM_PERCENT), sentences)
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

/// Number of intervals from the driven end to the boundary at whose ends the thickness is evaluated.
const PLACES: u32 = 16;

/// Excess of Mindlin's wavenumber over the thin plate's, %.
fn missed_percent(bending: &Bending, frequency_hz: f64) -> f64 {
    let squared =
        |thick_plate: bool| Bending { thick_plate, ..bending.clone() }.wavenumber_squared(TAU * frequency_hz);
    100.0 * ((squared(true) / squared(false)).sqrt() - 1.0)
}
