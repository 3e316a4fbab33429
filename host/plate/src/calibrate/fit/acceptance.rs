//! The limits within which a fit is accepted, and the refusals beyond them.

use super::pairs::Pair;
use super::unknowns::{AIR, EDGE_GIVE, HALF_WIDTH, INTERVAL, SPEED, TAPER};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{MeasuredPoint, Measurement};
use crate::definition::{Air, AirMounting, Plate, PlateSpec};

/// Fewest frequencies that both sensors measured: twice the number of what is fitted but for how far the edges give, which is known
/// beforehand.
const FREQUENCIES_MIN: usize = 12;
/// Largest chi^2 over the number of residuals. On plates in two dimensions it is up to 4.7 where the one-mode
/// equation serves; a finger that moves the boundary by 1 mm makes 12 and more.
pub(crate) const CHI2_PER_N_MAX: f64 = 6.0;
/// Farthest that a wave speed may be from the file's, as a logarithm: no material is less well known.
pub(crate) const SPEED_MAX: f64 = 0.12;
/// Standard deviations by which the widths, the edges and the places together may differ from what was known beforehand: the root of
/// the sum of their squares. A sensor 10 mm from its mark spreads its mistake over all of them.
const DEVIATIONS_MAX: f64 = 4.5;
/// Standard deviations by which the air of a frame in the open may be more than its mounting has.
const MORE_AIR_MAX: f64 = 3.0;
/// Largest standard deviation of the boundary over the one that is left if how far clamped edges give is known. Places are planned with
/// as much on the nominal plate; most have 1.2 to 1.6.
pub(crate) const CLAMPED_OPEN_MAX: f64 = 1.75;
/// Largest standard deviation of the boundary over the plate's length, and of the carried level in dB.
const BOUNDARY_MAX: f64 = 5e-3;
pub(crate) const LEVEL_MAX_DB: f64 = 1.5;
/// Share of a frequency by which the span may reach beyond the measured band.
const BEYOND: f64 = 0.005;

/// Refuses two measurements that have no ratio: too few common frequencies, two kinds of sensor, one place.
pub(crate) fn check_pair([a, b]: [&Measurement; 2], pairs: &[Pair]) -> Result<(), CalibrateError> {
    let same_body = a.sensor_mass_kg == b.sensor_mass_kg && a.sensor_width_m == b.sensor_width_m;
    if a.sensor != b.sensor || a.unit_per_response != b.unit_per_response || !same_body {
        return Err(CalibrateError::DifferentSensors);
    }
    check_places([a.place_m, b.place_m], [a.place_tolerance_m, b.place_tolerance_m])?;
    check_count(pairs.len())
}

/// Refuses two places of a sensor, metres, that may be one: at most four standard deviations of their distance apart.
/// `tolerances_m` are the standard deviations of the two, metres.
///
/// # Errors
/// [`CalibrateError::SamePlace`].
pub fn check_places(places_m: [f64; 2], tolerances_m: [f64; 2]) -> Result<(), CalibrateError> {
    let [(a_m, b_m), (of_a_m, of_b_m)] = [places_m, tolerances_m].map(|[a, b]| (a, b));
    if (a_m - b_m).abs() <= 4.0 * of_a_m.hypot(of_b_m) {
        return Err(CalibrateError::SamePlace { place_m: a_m });
    }
    Ok(())
}

/// Refuses too few frequencies.
pub(crate) fn check_count(count: usize) -> Result<(), CalibrateError> {
    if count < FREQUENCIES_MIN {
        return Err(CalibrateError::FewFrequencies { count, least: FREQUENCIES_MIN });
    }
    Ok(())
}

/// Refuses coordinates that no plate of this file has, or that the sensors' places do not have, which follow the `of_plate` of
/// the plate; `end` is that of the driven end, where it is open.
pub(crate) fn check_coordinates(
    coordinates: &[f64],
    deviations: &[f64],
    (of_plate, end): (usize, Option<usize>),
    sensors: &[&Measurement],
) -> Result<(), CalibrateError> {
    if coordinates[SPEED].abs() > SPEED_MAX {
        return Err(CalibrateError::AnotherPlate { what: "wave speed", share: coordinates[SPEED].exp() });
    }
    let in_deviations = |at: usize| coordinates[at] / deviations[at];
    let of_sensors = (0..sensors.len()).map(|i| of_plate + i);
    let known = [HALF_WIDTH, TAPER, EDGE_GIVE].into_iter().chain(of_sensors).chain(end);
    let square: f64 = known.clone().map(|at| in_deviations(at).powi(2)).sum();
    if square <= DEVIATIONS_MAX * DEVIATIONS_MAX {
        return Ok(());
    }
    let farthest = known.max_by(|a, b| in_deviations(*a).abs().total_cmp(&in_deviations(*b).abs()));
    Err(match farthest {
        Some(HALF_WIDTH) => CalibrateError::AnotherPlate {
            what: "half-width at the driven end",
            share: coordinates[HALF_WIDTH].exp(),
        },
        Some(EDGE_GIVE) => CalibrateError::EdgesGive { by_m: coordinates[EDGE_GIVE] },
        Some(at) if Some(at) == end && !sensors.is_empty() => {
            let place_m = sensors[0].place_m;
            CalibrateError::Misplaced { place_m, found_m: place_m - coordinates[at] }
        }
        Some(at) if at >= of_plate => {
            let place_m = sensors[at - of_plate].place_m;
            CalibrateError::Misplaced { place_m, found_m: place_m + coordinates[at] }
        }
        _ => CalibrateError::AnotherPlate { what: "taper", share: 1.0 + coordinates[TAPER] },
    })
}

/// Refuses air that carries more than a frame in the open has: a table below, which the file does not state, has another course over
/// the frequency than a coefficient.
pub(crate) fn check_air(nominal: &PlateSpec, coordinates: &[f64]) -> Result<(), CalibrateError> {
    match nominal.air {
        Some(Air::Around {
            mounting: mounting @ (AirMounting::BareFrame | AirMounting::Unknown),
            gap_m: None,
            ..
        }) if coordinates[AIR] > MORE_AIR_MAX * mounting.deviation() => {
            Err(CalibrateError::MoreAir { share: coordinates[AIR].exp() })
        }
        _ => Ok(()),
    }
}

/// Refuses two places that hardly show how far clamped edges give: what they do to the wave saturates, so that a fit takes one of 0.8
/// mm for one of 0.4. `known_m` is the boundary's deviation if it were known, `give_m` its value with half of its interval.
pub(crate) fn check_clamped_edges(
    plate: &Plate,
    (boundary_m, known_m): (f64, f64),
    (give_m, half_m): (f64, f64),
) -> Result<(), CalibrateError> {
    let is_clamped = plate.spec().model.is_clamped();
    if !is_clamped || boundary_m <= CLAMPED_OPEN_MAX * known_m {
        return Ok(());
    }
    let (low_m, high_m) = (give_m - half_m, give_m + half_m);
    Err(CalibrateError::EdgesUnseen { low_m, high_m, boundary_m: INTERVAL * boundary_m })
}

/// Refuses measurements at rising `frequencies_hz` that do not cover the span of the fitted plate.
pub(crate) fn check_band(fitted: &Plate, frequencies_hz: &[f64]) -> Result<(), CalibrateError> {
    let [low_hz, .., high_hz] = *frequencies_hz else { return Err(CalibrateError::NoFit) };
    let needed = fitted.band_hz();
    if low_hz <= needed.0 * (1.0 + BEYOND) && high_hz >= needed.1 * (1.0 - BEYOND) {
        return Ok(());
    }
    Err(CalibrateError::NotCovered { measured_hz: (low_hz, high_hz), needed_hz: needed })
}

/// Refuses standard deviations of the boundary, metres, and of the level, dB, that are too large for a plate file; without
/// sensors those by a current.
pub(crate) fn check_carried(
    plate: &Plate,
    sensors: &[&Measurement],
    (boundary_m, level_db): (f64, f64),
) -> Result<(), CalibrateError> {
    if boundary_m <= BOUNDARY_MAX * plate.length_m() && level_db <= LEVEL_MAX_DB {
        return Ok(());
    }
    // The sensor that shows least.
    let silent = |sensor: &Measurement| {
        let is_silent = |point: &&MeasuredPoint| point.response.norm() < 3.0 * point.noise;
        sensor.points.iter().filter(is_silent).count() as f64 / sensor.points.len() as f64
    };
    let weakest = sensors.iter().max_by(|a, b| silent(a).total_cmp(&silent(b)));
    Err(match weakest {
        None => CalibrateError::NotCarriedByCurrent { boundary_m, level_db },
        Some(sensor) => CalibrateError::NotCarried {
            boundary_m,
            level_db,
            place_m: sensor.place_m,
            silent_share: silent(sensor),
            span_end_m: plate.span_m().1,
        },
    })
}
