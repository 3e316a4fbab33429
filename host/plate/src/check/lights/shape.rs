//! Lights that depend only on the taper and the turning point.

use crate::check::grading::{Finding, Site, colour, colour_at_least, pick};
use crate::check::interval::Interval;
use crate::check::report::{Colour, Limit};
use crate::check::stretch::Stretch;
use crate::check::thresholds::{
    EDGE_CURVATURE, EDGE_SLOPE, EDGE_SLOPE_STRICT, EDGE_WIDTH, FINGERTIP_M, WAVELENGTHS,
};
use crate::definition::model::Model;
use crate::definition::plate::Plate;
use crate::definition::turning_width::TurningWidth;
use crate::quantity::number_format::with_decimals;
use std::f64::consts::TAU;

/// Number of positions between the driven end and the boundary at which the taper is evaluated.
const TAPER_PLACES: usize = 201;
/// Highest width mode that is checked for ghost boundaries.
const MODES_MAX: u32 = 9;

/// |W'| at `x` metres (clamped to the plate), where the wave turns; d W for the exponential taper.
pub(crate) fn edge_slope(plate: &Plate, x: f64) -> f64 {
    let x = x.clamp(0.0, plate.length_m());
    (plate.narrowing_per_m(x) * plate.half_width_m(x)).abs()
}

/// Largest W |W''| between the driven end and `to_m` metres (clamped to the plate); d^2 W0^2 for the exponential taper.
pub(crate) fn edge_curvature(plate: &Plate, to_m: f64) -> f64 {
    // W'' = ((ln W)'' + (ln W)'^2) W
    most_curved(plate, to_m).0
}

/// W |W''| at `x` metres.
fn curvature_at(plate: &Plate, x: f64) -> f64 {
    let width = plate.width.at(x);
    let half_width_m = width.value.exp();
    (half_width_m * half_width_m * (width.curvature + width.slope * width.slope)).abs()
}

/// Number of wavelengths from the driven end to the boundary at `boundary_m` metres, at the boundary's frequency.
pub(crate) fn wavelengths(plate: &Plate, boundary_m: f64) -> f64 {
    plate.width_mode(1).phase_to(boundary_m, plate.frequency_for_boundary_hz(boundary_m)) / TAU
}

/// The largest W |W''| up to `to_m` metres, and where it is.
fn most_curved(plate: &Plate, to_m: f64) -> (f64, f64) {
    let to_m = to_m.clamp(0.0, plate.length_m());
    let places = (0..TAPER_PLACES).map(|i| to_m * i as f64 / (TAPER_PLACES - 1) as f64);
    places
        .map(|x| (curvature_at(plate, x), x))
        .fold((0.0, 0.0), |most, found| if found.0 > most.0 || found.0.is_nan() { found } else { most })
}

pub(in crate::check) fn slope_light(site: &Site<'_>) -> Finding {
    let slope = edge_slope(site.plate, site.boundary_m);
    let turning_width = site.plate.spec().turning_width;
    // Largest relative error of the turning width, over W'^2.
    let share = match turning_width {
        TurningWidth::Arc => 1.0 / 9.0,
        TurningWidth::Plain => 1.0 / 3.0,
    };
    let limits = match (turning_width, &site.plate.spec().model) {
        (TurningWidth::Plain, _) | (_, Model::BendingClamped(_)) => EDGE_SLOPE_STRICT,
        (TurningWidth::Arc, _) => EDGE_SLOPE,
    };
    let off = 100.0 * share * slope * slope;
    let measured = turning_width.words();
    site.graded(
        "edge slope",
        slope,
        "",
        Limit::AtMost(limits),
        [
            format!(
                "The edges converge slowly (|W'| = {} at the boundary): the turning width, {measured}, holds to {} %.",
                with_decimals(slope, 2),
                with_decimals(off, 1)
            ),
            format!(
                "|W'| is {slope:.2} at the boundary, which is not small: the turning width, {measured}, may be off by {off:.0} %, measure before you trust the boundary."
            ),
            format!(
                "|W'| is {slope:.2} at the boundary: the edges converge too fast for one width mode and the amplitude equation, take a gentler taper."
            ),
        ],
    )
    .over_interval(site, Interval::boundary, |end| {
        let slope = edge_slope(&end.plate, end.boundary_m);
        (slope, colour(slope, limits))
    })
    .at(site.boundary_m)
}

pub(in crate::check) fn curvature_light(site: &Site<'_>) -> Finding {
    let (curvature, at_m) = most_curved(site.plate, site.boundary_m);
    let fails = |x: f64| colour(curvature_at(site.plate, x), EDGE_CURVATURE) > Colour::Green;
    site.graded(
        "edge curvature",
        curvature,
        "",
        Limit::AtMost(EDGE_CURVATURE),
        [
            format!(
                "The edges are nearly straight over their own width (W |W''| up to {}): the width changes gradually.",
                with_decimals(curvature, 3)
            ),
            format!(
                "W |W''| reaches {curvature:.2}: the edges bend within their own width, so the wave is no longer quite one mode; a gentler taper is safer."
            ),
            format!(
                "W |W''| reaches {curvature:.2}: the edges bend too much for a wave that follows the local width, take a gentler taper."
            ),
        ],
    )
    .over_interval(site, Interval::boundary, |end| {
        let curvature = edge_curvature(&end.plate, end.boundary_m);
        (curvature, colour(curvature, EDGE_CURVATURE))
    })
    .over(|| vec![Stretch::about(at_m, site.boundary_m, fails)])
}

pub(in crate::check) fn wavelengths_light(site: &Site<'_>) -> Finding {
    let count = wavelengths(site.plate, site.boundary_m);
    site.graded(
        "wavelengths",
        count,
        "",
        Limit::AtLeast(WAVELENGTHS),
        [
            format!(
                "{count:.1} wavelengths fit between the drive and the boundary: the vibrating side has whole antinodes."
            ),
            format!(
                "Only {count:.2} wavelengths fit between the drive and the boundary: the plate has the peak, but no whole antinode before it; move the boundary away from the drive."
            ),
            format!("{} wavelengths: the boundary is so near the drive that the peak has no room, move it away from the drive.", with_decimals(count, 2)),
        ],
    )
    .over_interval(site, Interval::boundary, |end| {
        let count = wavelengths(&end.plate, end.boundary_m);
        (count, colour_at_least(count, WAVELENGTHS))
    })
    .over(|| vec![Stretch { from_m: 0.0, to_m: site.boundary_m }])
}

pub(in crate::check) fn edge_light(site: &Site<'_>) -> Finding {
    let edge_m = site.plate.edge_width_m(site.frequency_hz).unwrap_or(f64::NAN);
    let fingers = edge_m / FINGERTIP_M;
    let edge_mm = edge_m * 1e3;
    site.graded(
        "edge width",
        fingers,
        "fingertips",
        Limit::AtMost(EDGE_WIDTH),
        [
            format!("From the peak to a tenth of it is {edge_mm:.0} mm: a short stroke crosses the edge."),
            format!(
                "From the peak to a tenth of it is {edge_mm:.0} mm, {fingers:.0} fingertips: the edge is soft; a steeper taper or a higher frequency makes it crisper."
            ),
            format!(
                "From the peak to a tenth of it is {edge_mm:.0} mm, wider than a hand: it fades rather than ends, take a steeper taper or a higher frequency."
            ),
        ],
    )
    .over_interval(site, Interval::boundary, |end| {
        let fingers = end.plate.edge_width_m(site.frequency_hz).unwrap_or(f64::NAN) / FINGERTIP_M;
        (fingers, colour(fingers, EDGE_WIDTH))
    })
    .over(|| {
        let peak_m = site.peak_m();
        let reaches_m = if edge_m.is_finite() { peak_m + edge_m } else { site.boundary_m };
        let to_m = reaches_m.clamp(peak_m, site.plate.length_m().max(peak_m));
        vec![Stretch { from_m: peak_m, to_m }]
    })
}

pub(in crate::check) fn ghost_light(site: &Site<'_>) -> Finding {
    let off_centre = site.prepared.conditions.off_centre;
    let (first, stride) = if off_centre { (2, 1) } else { (3, 2) };
    let ghosts_on = |plate: &Plate| -> Vec<(u32, f64)> {
        let modes = (first..=MODES_MAX).step_by(stride);
        modes.filter_map(|mode| plate.ghost_boundary_m(site.frequency_hz, mode).map(|x| (mode, x))).collect()
    };
    let ghosts = ghosts_on(site.plate);
    let nearest = ghosts.first().map_or(f64::NAN, |ghost| ghost.1);
    // A mode that enters is never green, because the distribution of the drive over the width is not known: a point
    // drive on the centre line excites all odd modes equally, a uniform drive excites mode m at 1/m of the first.
    let colour_of = |ghosts: &[(u32, f64)]| match (ghosts.is_empty(), off_centre) {
        (true, _) => Colour::Green,
        (false, false) => Colour::Amber,
        (false, true) => Colour::Red,
    };
    let colour = colour_of(&ghosts);
    let listed: Vec<String> =
        ghosts.iter().map(|(mode, x)| format!("{:.0} mm (mode {mode})", x * 1e3)).collect();
    let listed = listed.join(", ");
    site.judged(
        "ghost boundaries",
        ghosts.first().map(|ghost| ghost.1),
        "m",
        colour,
        nearest.max(0.0),
        pick(colour, [
            "No higher width mode enters the plate: this boundary is the only one.".to_owned(),
            format!(
                "Higher width modes have boundaries of their own at {listed}: a drive spread over the width like the wave, most on the centre line and nothing at the edges, leaves them out; an even one gives mode 3 a third of the wanted mode."
            ),
            format!(
                "A drive beside the centre line makes further boundaries at {listed}: move it to the centre line or use a shorter span."
            ),
        ]),
    )
    .over_interval(site, Interval::boundary, |end| {
        let ghosts = ghosts_on(&end.plate);
        // Where no mode enters there is no number, and the light is green.
        (ghosts.first().map_or(f64::NAN, |ghost| ghost.1), colour_of(&ghosts))
    })
    .over(|| match &ghosts[..] {
        // A ghost at an end of the interval only: it enters at the driven end.
        [] => vec![Stretch::at(0.0)],
        ghosts => ghosts.iter().map(|ghost| Stretch::at(ghost.1)).collect(),
    })
}
