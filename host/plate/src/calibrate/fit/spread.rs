//! Standard deviations of the boundary and of the wave's nodes that a covariance of coordinates leaves, by propagation.

use super::gain::Carried;
use super::least_squares::Fit;
use super::unknowns::{EDGE_GIVE, OF_PLATE_MAX, TAPER, of_plate, spec_at, steps};
use crate::definition::Plate;
use nalgebra::DMatrix;

/// Boundaries over the span.
const PLACES: usize = 9;

/// A number of the plate at each boundary over the span, as a function of the plate's coordinates.
struct Slopes {
    /// The plate's coordinates.
    of_plate: usize,
    /// Derivatives by the coordinates, at each boundary.
    rows: Vec<[f64; OF_PLATE_MAX]>,
}

impl Slopes {
    /// At coordinates of `plate` itself.
    fn of(plate: &Plate, value: impl Fn(&Plate, f64) -> f64) -> Option<Self> {
        let of_plate = of_plate(plate.spec());
        let mut rows = vec![[0.0; OF_PLATE_MAX]; PLACES];
        for (i, step) in steps(plate.spec()).into_iter().enumerate() {
            let mut beside = vec![0.0; of_plate];
            beside[i] = step;
            let other = Plate::new(spec_at(plate.spec(), &beside)).ok()?;
            for (row, boundary_m) in rows.iter_mut().zip(plate.over_span_m(PLACES)) {
                row[i] = (value(&other, boundary_m) - value(plate, boundary_m)) / step;
            }
        }
        Some(Self { of_plate, rows })
    }

    /// The standard deviation at each boundary.
    fn deviations(&self, covariance: &DMatrix<f64>) -> impl Iterator<Item = f64> {
        self.rows.iter().map(|row| {
            let product = |i: usize, j: usize| row[i] * covariance[(i, j)] * row[j];
            let all = 0..self.of_plate;
            let square: f64 = all.clone().flat_map(|i| all.clone().map(move |j| product(i, j))).sum();
            square.max(0.0).sqrt()
        })
    }
}

/// The logarithms of the frequencies that turn at places over the span, as functions of the plate's coordinates.
pub(crate) struct Turning {
    slopes: Slopes,
    /// Derivatives by the place, 1/m.
    per_metre: Vec<f64>,
}

impl Turning {
    /// At coordinates of `plate` itself.
    pub(crate) fn of(plate: &Plate) -> Option<Self> {
        let turning = |plate: &Plate, place_m: f64| plate.frequency_for_boundary_hz(place_m).ln();
        let per_metre = |place_m: f64| {
            (turning(plate, place_m * (1.0 + 1e-6)) - turning(plate, place_m)) / (place_m * 1e-6)
        };
        let per_metre = plate.over_span_m(PLACES).map(per_metre).collect();
        Some(Self { slopes: Slopes::of(plate, turning)?, per_metre })
    }

    /// The largest standard deviation of the boundary at a given frequency, metres, and of the logarithm of the frequency.
    pub(crate) fn deviations(&self, covariance: &DMatrix<f64>) -> (f64, f64) {
        let (mut of_boundary, mut of_frequency) = (0.0_f64, 0.0_f64);
        for (deviation, per_metre) in self.slopes.deviations(covariance).zip(&self.per_metre) {
            of_boundary = of_boundary.max(deviation / per_metre);
            of_frequency = of_frequency.max(deviation);
        }
        (of_boundary, of_frequency)
    }

    /// Largest shift of the boundary, metres, where the coordinates move by these ways.
    fn shift_m(&self, ways: &[f64]) -> f64 {
        let shift = |(row, per_metre): (&[f64; OF_PLATE_MAX], &f64)| {
            (row.iter().zip(ways).map(|(slope, way)| slope * way).sum::<f64>() / per_metre).abs()
        };
        self.slopes.rows.iter().zip(&self.per_metre).map(shift).fold(0.0, f64::max)
    }
}

/// The nodes of the standing wave next to the driven end, as functions of the plate's coordinates at given frequencies. The
/// wave's phase between them and the turning point stays, so they move by the change of all phase over k.
pub(crate) struct Nodes(Slopes);

impl Nodes {
    /// At coordinates of `plate` itself, for the boundaries over its span.
    pub(crate) fn of(plate: &Plate) -> Option<Self> {
        let place_m = |other: &Plate, boundary_m: f64| {
            let frequency_hz = plate.frequency_for_boundary_hz(boundary_m);
            let wavenumber = plate.width_mode(1).wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
            other.width_mode(1).phase_to(f64::INFINITY, frequency_hz) / wavenumber
        };
        Slopes::of(plate, place_m).map(Self)
    }

    /// The largest standard deviation of their place, metres.
    pub(crate) fn deviation_m(&self, covariance: &DMatrix<f64>) -> f64 {
        self.0.deviations(covariance).fold(0.0, f64::max)
    }
}

/// Standard deviations of the boundary, the largest over the span, and what those of the levels need.
pub(crate) struct Spread {
    /// The spread of the boundary at a given frequency, metres.
    pub(crate) boundary_m: f64,
    /// The same if how far the edges give were known.
    pub(crate) of_known_edges_m: f64,
    /// The relative error of the wave speed that would move the boundary by as much.
    pub(crate) speed: f64,
    /// Boundary shift per metre of misplacement, for each sensor.
    pub(crate) boundary_per_place: Vec<f64>,
    /// Derivatives of the gains by each coordinate, over the frequencies.
    pub(crate) slopes: Vec<Vec<f64>>,
}

impl Spread {
    /// `deviations` are the prior deviations of the coordinates; of these, `places_of_sensors` are of sensors'
    /// places. `carried` is the gain to the peak at each frequency for given coordinates, and `here` for those of the fit.
    pub(crate) fn of(
        fitted: &Plate,
        fit: &Fit,
        deviations: &[f64],
        places_of_sensors: usize,
        carried: &dyn Fn(&[f64]) -> Option<Vec<Carried>>,
        here: &[Carried],
    ) -> Option<Self> {
        let mut turning = Turning::of(fitted)?;
        // The taper's coordinate is over the file's, that of the fitted plate over its own.
        turning.slopes.rows.iter_mut().for_each(|row| row[TAPER] /= 1.0 + fit.parameters[TAPER]);
        let (boundary_m, of_frequency) = turning.deviations(&fit.covariance);
        let (of_known_edges_m, _) = turning.deviations(&given(&fit.covariance, EDGE_GIVE));
        let exponent = if fitted.spec().model.bending().is_some() { 2.0 } else { 1.0 };
        let steps = steps(fitted.spec());
        let slopes = (0..fit.parameters.len()).map(|i| {
            let step = steps.get(i).copied().unwrap_or(1e-6);
            let mut beside = fit.parameters.clone();
            beside[i] += step;
            let there = carried(&beside)?;
            Some(there.iter().zip(here).map(|(there, here)| (there.peak - here.peak) / step).collect())
        });
        let slopes = slopes.collect::<Option<_>>()?;
        // A mistake m of the place's prior moves the coordinates by C e m/s^2, with the prior's standard deviation s.
        let per_place = |i: usize| {
            let at = turning.slopes.of_plate + i;
            let of_prior = deviations[at].powi(2);
            let ways = (0..turning.slopes.of_plate).map(|j| fit.covariance[(j, at)] / of_prior);
            turning.shift_m(&ways.collect::<Vec<f64>>())
        };
        let boundary_per_place = (0..places_of_sensors).map(per_place).collect();
        Some(Self {
            boundary_m,
            of_known_edges_m,
            speed: of_frequency / exponent,
            boundary_per_place,
            slopes,
        })
    }
}

/// The covariance of the coordinates where coordinate `i` is given.
pub(crate) fn given(covariance: &DMatrix<f64>, i: usize) -> DMatrix<f64> {
    let column = covariance.column(i);
    covariance - column * column.transpose() / covariance[(i, i)]
}
