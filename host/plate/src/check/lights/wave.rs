//! Lights that depend on the computed amplitude.

use super::shape::wavelengths;
use crate::check::grading::{Finding, Site, pick};
use crate::check::interval::Interval;
use crate::check::report::Colour;
use crate::check::stretch::Stretch;
use crate::check::thresholds::{LOSS_SMALL, PEAK_ROOM};
use crate::definition::plate::Plate;
use crate::quantity::number_format::with_decimals;

/// Loss integral I: the integral of Im k from the driven end to the boundary at `boundary_m` metres, at the boundary's
/// frequency. The wave arrives with e^-I of its amplitude.
///
/// With small eta, I is the integral of eta d(k^2)/d ln(K^2)/(2 k); the derivative is a K^2 except between clamped edges.
/// For the exponential taper with a = 1 it is (eta/2) nu acosh(nu/s0), where nu = K/d and s0 = q/(W0 d).
pub(crate) fn loss_integral(plate: &Plate, boundary_m: f64) -> f64 {
    let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
    let width_mode = plate.width_mode(1);
    let wave = width_mode.at_frequency(frequency_hz);
    // 1/k has an inverse-square-root singularity at the turning point, which x = boundary (1 - u^2) removes.
    let steps = 400;
    let total: f64 = (0..steps)
        .map(|i| {
            let u = (f64::from(i) + 0.5) / f64::from(steps);
            let place = boundary_m * (1.0 - u * u);
            let wavenumber = wave.wavenumber_squared(place).max(f64::MIN_POSITIVE).sqrt();
            2.0 * u * wave.wavenumber_rise(place) / wavenumber
        })
        .sum();
    0.5 * plate.wave_loss_at(frequency_hz) * total * boundary_m / f64::from(steps)
}

/// From [`LOSS_SMALL`] on, the computed peak decides the colour, so that the two lights never contradict each other.
pub(in crate::check) fn loss_light(site: &Site<'_>) -> Finding {
    let name = "loss";
    let loss = loss_integral(site.plate, site.boundary_m);
    let percent = 100.0 * (-loss).exp();
    let arrives = if percent < 0.01 {
        "Less than 0.01 % of the wave's amplitude arrives at the boundary".to_owned()
    } else {
        format!("{} % of the wave's amplitude arrives at the boundary", with_decimals(percent, 1))
    };
    if loss <= LOSS_SMALL {
        let sentence = format!("{arrives}: little is lost on the way.");
        return over_losses(site.judged(name, Some(loss), "", Colour::Green, loss, sentence), site);
    }
    let colour = peak_colour(site);
    let sentence = pick(
        colour,
        [
            format!("{arrives}: the peak still stands above the rest."),
            format!(
                "{arrives}: the peak does not stand out; a boundary nearer the drive or a material of less loss helps."
            ),
            format!(
                "{arrives}: there is no peak left to feel, take a boundary nearer the drive or a material of less loss."
            ),
        ],
    );
    over_losses(site.judged(name, Some(loss), "", colour, loss, sentence), site)
        .over(|| vec![Stretch { from_m: 0.0, to_m: site.boundary_m }])
}

/// The loss light over the interval of the calibration: the loss integral is proportional to the loss.
fn over_losses(found: Finding, site: &Site<'_>) -> Finding {
    let factor = site.interval.as_ref().map_or(1.0, |interval| interval.loss);
    found.over_corners(site, Interval::boundary_and_loss, |end| {
        let loss = loss_integral(&end.plate, end.boundary_m);
        let judged = |loss: f64| {
            (loss, if loss <= LOSS_SMALL { Colour::Green } else { peak_colour_over_interval(site) })
        };
        vec![judged(loss / factor), judged(loss * factor)]
    })
}

/// The worst [`peak_colour`] over the interval of the calibration.
fn peak_colour_over_interval(site: &Site<'_>) -> Colour {
    let here = peak_colour(site);
    let ends = site.interval.iter().flat_map(|interval| &interval.ends);
    let has_room = ends.into_iter().all(|end| wavelengths(&end.plate, end.boundary_m) >= PEAK_ROOM);
    match site.levels.calibrated {
        Some(levels) if !levels.peak_present => Colour::Red,
        Some(_) if !has_room => here.max(Colour::Amber),
        _ => here,
    }
}

/// Green where the peak is the largest amplitude on the plate and has room, amber where there is a peak, red where
/// there is none. It must be the largest also with the near field of a driven end that the file leaves out, and for a
/// wave speed 1 % off (on a calibrated plate: within its intervals), because between two resonances the motion next
/// to the drive may be larger.
fn peak_colour(site: &Site<'_>) -> Colour {
    match site.response.peak {
        Some(_) if site.levels.peak_largest && has_room(site) => Colour::Green,
        Some(_) => Colour::Amber,
        None => Colour::Red,
    }
}

fn has_room(site: &Site<'_>) -> bool {
    wavelengths(site.plate, site.boundary_m) >= PEAK_ROOM
}

pub(in crate::check) fn peak_light(site: &Site<'_>) -> Finding {
    let (value, colour) = (site.response.peak.map(|peak| peak.amplitude), peak_colour(site));
    let amplitude = value.unwrap_or(0.0);
    let at_ends: Vec<(f64, Colour)> = match site.levels.calibrated {
        // The height of the peak depends on the widths as well and does not decide the colour.
        Some(_) => vec![(f64::NAN, peak_colour_over_interval(site))],
        None => Vec::new(),
    };
    let known = site.interval.as_ref().map_or(String::new(), Interval::boundary_and_loss);
    let times = with_decimals(amplitude, 2);
    let at_mm = site.response.peak.map_or(0.0, |peak| peak.position_m * 1e3);
    site.judged(
        "peak",
        value,
        "times the drive",
        colour,
        -amplitude,
        pick(colour, [
            format!("The peak stands at {at_mm:.0} mm with {times} times the drive, the largest amplitude on the plate."),
            if has_room(site) {
                format!("The peak at {at_mm:.0} mm has {times} times the drive, but other places on the plate vibrate more: see drive match and loss.")
            } else {
                format!("The peak at {at_mm:.0} mm has {times} times the drive, but stands so near the drive that a real plate may have none: move the boundary away from it.")
            },
            "There is no peak before this boundary: the amplitude just falls from the drive on, see wavelengths and loss.".to_owned(),
        ]),
    )
    .between(&at_ends, &known)
    .at(site.peak_m())
}
