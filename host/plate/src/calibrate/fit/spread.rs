//! Standard deviations of boundary and level that a fit leaves, by propagation of its covariance.

use super::gain;
use super::least_squares::Fit;
use super::unknowns::{OF_PLATE, STEPS, TAPER, spec_at};
use crate::definition::Plate;

/// Boundaries over the span.
const PLACES: usize = 9;

/// Standard deviations of boundary and level; the largest over the span.
pub(crate) struct Spread {
    /// Of the boundary at a given frequency, metres.
    pub(crate) boundary_m: f64,
    /// Of the peak over what the sensors show, dB.
    pub(crate) level_db: f64,
    /// The relative error of the wave speed that would move the boundary by as much.
    pub(crate) speed: f64,
    /// Boundary shift per metre of misplacement, for each sensor.
    pub(crate) boundary_per_place: Vec<f64>,
}

impl Spread {
    /// `deviations` are what was known of the coordinates beforehand; of these, `places_of_sensors` are of sensors'
    /// places. `carried` is the logarithm of the gain to the peak at each frequency, in any scale, for given coordinates.
    pub(crate) fn of(
        fitted: &Plate,
        fit: &Fit,
        deviations: &[f64],
        places_of_sensors: usize,
        carried: &dyn Fn(&[f64]) -> Option<Vec<f64>>,
    ) -> Option<Self> {
        // Logarithm of the frequency that turns at each place, and of the peak over the source at each frequency.
        let (start, end) = fitted.span_m();
        let places: Vec<f64> =
            (0..PLACES).map(|i| start + (end - start) * i as f64 / (PLACES - 1) as f64).collect();
        let turning = |plate: &Plate| -> Vec<f64> {
            places.iter().map(|&x| plate.frequency_for_boundary_hz(x).ln()).collect()
        };
        let (turning_here, carried_here) = (turning(fitted), carried(&fit.parameters)?);
        let mut of_turning = vec![vec![0.0; fit.parameters.len()]; turning_here.len()];
        let mut of_carried = vec![vec![0.0; fit.parameters.len()]; carried_here.len()];
        for i in 0..fit.parameters.len() {
            let step = STEPS.get(i).copied().unwrap_or(1e-6);
            let mut beside = fit.parameters.clone();
            beside[i] += step;
            let plate = Plate::new(spec_at(fitted.spec(), &difference(&beside, &fit.parameters))).ok()?;
            for (row, (there, here)) in of_turning.iter_mut().zip(turning(&plate).iter().zip(&turning_here)) {
                row[i] = (there - here) / step;
            }
            let there = carried(&beside)?;
            for (row, (there, here)) in of_carried.iter_mut().zip(there.iter().zip(&carried_here)) {
                row[i] = (there - here) / step;
            }
        }
        let deviation = |row: &Vec<f64>| {
            let row = nalgebra::DVector::from_column_slice(row);
            (row.transpose() * &fit.covariance * &row)[(0, 0)].max(0.0).sqrt()
        };
        let per_metre = |i: usize| {
            let beside = fitted.frequency_for_boundary_hz(places[i] * (1.0 + 1e-6)).ln();
            (beside - turning_here[i]) / (places[i] * 1e-6)
        };
        let of_frequency: Vec<f64> = of_turning.iter().map(deviation).collect();
        let boundary_m = of_frequency.iter().enumerate().map(|(i, d)| d / per_metre(i)).fold(0.0, f64::max);
        let exponent = if fitted.spec().model.bending().is_some() { 2.0 } else { 1.0 };
        let speed = of_frequency.iter().copied().fold(0.0, f64::max) / exponent;
        // Nine tenths: near a node of both sensors the level is not measured at all.
        let mut of_level: Vec<f64> = of_carried.iter().map(deviation).collect();
        of_level.sort_by(f64::total_cmp);
        let level = of_level.get(of_level.len() * 9 / 10).copied()?;
        // A mistake m of the place's prior moves the coordinates by C e m/s^2, with the prior's standard deviation s.
        let per_place = |i: usize| {
            let moved = |row: &Vec<f64>| -> f64 {
                row.iter().enumerate().map(|(j, slope)| slope * fit.covariance[(j, OF_PLATE + i)]).sum()
            };
            let of_prior = deviations[OF_PLATE + i].powi(2);
            let of_each =
                of_turning.iter().enumerate().map(|(k, row)| (moved(row) / per_metre(k) / of_prior).abs());
            of_each.fold(0.0, f64::max)
        };
        let boundary_per_place = (0..places_of_sensors).map(per_place).collect();
        Some(Self { boundary_m, level_db: gain::DECIBELS * level, speed, boundary_per_place })
    }
}

/// Coordinates over those of a fit, as coordinates of the fitted plate.
fn difference(there: &[f64], here: &[f64]) -> Vec<f64> {
    let mut difference: Vec<f64> = there.iter().zip(here).map(|(there, here)| there - here).collect();
    difference[TAPER] /= 1.0 + here[TAPER];
    difference
}
