//! The wave on the plate for a source of any scale: its amplitude at the sensors and at the peak.
//!
//! Beyond the near field of the driven end the amplitude over x is the one solution of the amplitude equation that
//! decays beyond the turning point. The source, the actuator and the amplifier only scale it, so the ratio of the
//! amplitudes at two places does not depend on them.

use crate::calibrate::measurement::sensor::SensorKind;
use crate::definition::{DriveEnd, Plate, PlateError, PlateSpec};
use crate::frequency::driven_end::DrivenEnd;
use crate::frequency::finger::{self, Receptances};
use crate::frequency::numerov::{self, Grid};
use crate::frequency::{Equation, POINTS_MAX, respond_range};
use crate::table::level;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::ops::Range;

/// Radians of the shortest wave per grid step: during the search for the minimum, and for the final fit. Numerov's
/// phase error is (k h)^4/480 per radian, so the wave speed has an error of 1e-5 and of 2e-7.
pub(crate) const COARSE: f64 = 0.27;
pub(crate) const FINE: f64 = 0.1;

/// The wave on a plate, on a grid, at frequencies that all enter the plate.
pub(crate) struct Wave {
    plate: Plate,
    grid: Grid,
    points: usize,
    step_m: f64,
}

impl Wave {
    /// The wave on the plate of a specification, on `points` positions (see [`points`]).
    ///
    /// # Errors
    /// The mistake in the specification.
    pub(crate) fn new(spec: PlateSpec, points: usize) -> Result<Self, PlateError> {
        // The driven end only scales the wave; this one has no near field.
        let plate = Plate::new(PlateSpec { drive_end: DriveEnd::Displacement, ..spec })?;
        let grid = Grid::new(&plate, Equation::Corrected, points, 1);
        let step_m = plate.length_m() / (points - 1) as f64;
        Ok(Self { plate, grid, points, step_m })
    }

    /// As [`Wave::new`], with a prescribed slope p'(0), see [`Wave::slope`], so that the field also gives p(0) over
    /// p'(0). A wave of `at_hz` must enter the plate.
    pub(crate) fn with_slope(spec: PlateSpec, points: usize, at_hz: f64) -> Result<Self, PlateError> {
        let end = DriveEnd::Force { at_frequency_hz: at_hz };
        let mut wave = Self::new(spec, points)?;
        wave.plate = Plate::new(PlateSpec { drive_end: end, ..wave.plate.spec().clone() })?;
        Ok(wave)
    }

    /// The complex wave at sensors of one kind at `places_m` and at the driven end, and its peak if `with_peak`; one row
    /// per frequency.
    pub(crate) fn complex(
        &self,
        sensor: SensorKind,
        places_m: &[f64],
        frequencies_hz: &[f64],
        with_peak: bool,
    ) -> Vec<Row> {
        let mut rows = Vec::with_capacity(frequencies_hz.len());
        let near = places_m.iter().map(|&place_m| Near::new(self.points, self.step_m, place_m, sensor));
        let near: Vec<Near> = near.collect();
        let mut parts: Vec<Range<usize>> = near.iter().map(|near| near.first..near.first + NEAR).collect();
        parts.push(0..if with_peak { self.points } else { 1 });
        numerov::solve_each_in(&self.grid, &self.plate, frequencies_hz, &joined(parts), |number, field| {
            let peak = if with_peak {
                level::peak_amplitude(&self.plate, field, self.step_m, frequencies_hz[number]).0
            } else {
                f64::NAN
            };
            let seen = near.iter().map(|near| near.seen(field)).collect();
            rows.push(Row { seen, value: field[0], peak });
        });
        rows
    }

    /// The receptances of the plate under sensors of this width at `places_m`, at each frequency, for a wave of
    /// [`Wave::new`].
    pub(crate) fn receptances(
        &self,
        width_m: f64,
        places_m: &[f64],
        frequencies_hz: &[f64],
    ) -> Vec<Receptances> {
        let at = |&hz: &f64| finger::receptances(&self.grid, &self.plate, places_m, width_m, hz);
        frequencies_hz.iter().map(at).collect()
    }

    pub(crate) const fn plate(&self) -> &Plate {
        &self.plate
    }

    /// Calls `each` with the index of each frequency and p of [`Wave::with_slope`] on the grid.
    pub(crate) fn fields(&self, frequencies_hz: &[f64], mut each: impl FnMut(usize, &[Complex64])) {
        numerov::solve_each(&self.grid, &self.plate, frequencies_hz, |number, field| each(number, field));
    }

    /// p'(0) of a plate of [`Wave::with_slope`], 1/m.
    pub(crate) fn slope(&self, frequency_hz: f64) -> Complex64 {
        let end = DrivenEnd::of(&self.plate, frequency_hz);
        end.drive / end.beta
    }

    /// Whether a wave of this frequency enters the plate.
    pub(crate) fn enters(&self, frequency_hz: f64) -> bool {
        respond_range(&self.plate).contains(frequency_hz)
    }

    /// The signals of sensors of one kind at `places_m`: the deflection, or for strain the curvature (1/m^2 of the
    /// deflection's unit). For each frequency one magnitude per place, all on one scale.
    pub(crate) fn at(&self, sensor: SensorKind, places_m: &[f64], frequencies_hz: &[f64]) -> Vec<Vec<f64>> {
        self.complex(sensor, places_m, frequencies_hz, false).iter().map(Row::magnitudes).collect()
    }

    /// As [`Wave::at`]; also returns the amplitude of the peak as a drive table levels it.
    pub(crate) fn with_peak(
        &self,
        sensor: SensorKind,
        places_m: &[f64],
        frequencies_hz: &[f64],
    ) -> Vec<(Vec<f64>, f64)> {
        let rows = self.complex(sensor, places_m, frequencies_hz, true);
        rows.iter().map(|row| (row.magnitudes(), row.peak)).collect()
    }
}

/// The wave at one frequency.
pub(crate) struct Row {
    /// p, or p'' for strain, at each place.
    pub(crate) seen: Vec<Complex64>,
    /// p(0).
    pub(crate) value: Complex64,
    /// Amplitude of the peak; NaN if it was not requested.
    pub(crate) peak: f64,
}

impl Row {
    fn magnitudes(&self) -> Vec<f64> {
        self.seen.iter().map(|p| p.norm()).collect()
    }
}

/// Number of grid positions on a plate for frequencies up to `highest_hz`. A fit keeps it while it varies the plate's
/// parameters: another number has another error, which a derivative would take for a change of the wave.
pub(crate) fn points(nominal: &PlateSpec, highest_hz: f64, radians_per_step: f64) -> usize {
    let squared = nominal.free_wave().wavenumber_squared(TAU * highest_hz);
    let shortest = (nominal.model.width_slope(1) * squared).sqrt();
    let points = (nominal.length_m * shortest / radians_per_step).ceil();
    (points as usize).clamp(POINTS_MIN, POINTS_MAX)
}

/// Least number of points of a grid, for plates shorter than a wavelength.
const POINTS_MIN: usize = 64;
/// Points of the polynomial through the field near a place.
const NEAR: usize = 6;

/// The field or its second derivative at a place, from the polynomial through the six points around it.
pub(crate) fn seen(field: &[Complex64], step_m: f64, place_m: f64, sensor: SensorKind) -> Complex64 {
    Near::new(field.len(), step_m, place_m, sensor).seen(field)
}

/// These parts without what two of them share.
fn joined(mut parts: Vec<Range<usize>>) -> Vec<Range<usize>> {
    parts.sort_by_key(|part| part.start);
    let mut end = 0;
    for part in &mut parts {
        part.start = part.start.max(end).min(part.end);
        end = end.max(part.end);
    }
    parts
}

/// The six points of a grid around a place, and their weights in the field or its second derivative there.
struct Near {
    first: usize,
    weights: [f64; NEAR],
}

impl Near {
    fn new(points: usize, step_m: f64, place_m: f64, sensor: SensorKind) -> Self {
        let at = place_m / step_m;
        let first = (at - 0.5 * (NEAR - 1) as f64).round().max(0.0) as usize;
        let first = first.min(points - NEAR);
        let t = at - first as f64;
        let weights = std::array::from_fn(|i| match sensor {
            SensorKind::Strain => curvature_weight(i, t) / (step_m * step_m),
            _ => weight(i, t),
        });
        Self { first, weights }
    }

    fn seen(&self, field: &[Complex64]) -> Complex64 {
        let points = &field[self.first..self.first + NEAR];
        points.iter().zip(self.weights).map(|(f, weight)| f * weight).sum()
    }
}

/// Lagrange polynomial of point `i` at `t`, in steps from the first point.
fn weight(i: usize, t: f64) -> f64 {
    (0..NEAR).filter(|&j| j != i).map(|j| (t - j as f64) / (i as f64 - j as f64)).product()
}

/// Second derivative of [`weight`] with respect to `t`.
fn curvature_weight(i: usize, t: f64) -> f64 {
    let mut sum = 0.0;
    let others = || (0..NEAR).filter(|&j| j != i);
    let over = |j: usize| (i as f64 - j as f64).recip();
    for a in others() {
        for b in others().filter(|&b| b != a) {
            let rest = others().filter(|&j| j != a && j != b);
            let product: f64 = rest.map(|j| (t - j as f64) * over(j)).product();
            sum += over(a) * over(b) * product;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::preset;
    use crate::{Impedance, Source, respond};

    #[test]
    fn between_the_points_a_wave_and_its_curvature_are_interpolated() {
        let (k, step_m) = (2.0, 0.05);
        let field: Vec<Complex64> = (0..40).map(|i| Complex64::cis(k * step_m * f64::from(i))).collect();
        for place_m in [0.0, 0.012, 0.731, 1.95] {
            let wave = Complex64::cis(k * place_m);
            let found = seen(&field, step_m, place_m, SensorKind::Displacement);
            assert!((found - wave).norm() < 1e-7, "{place_m}: {found}");
            let bent = seen(&field, step_m, place_m, SensorKind::Strain);
            assert!((bent + k * k * wave).norm() < 1e-3, "{place_m}: {bent}");
        }
    }

    #[test]
    fn the_ratio_of_two_places_and_the_peak_over_one_do_not_depend_on_the_source() {
        for (name, places_m, frequency_hz) in
            [("membrane", [0.03, 0.176], 150.0), ("al-bending", [0.04, 0.187], 28e3)]
        {
            let plate = preset(name).expect("a preset");
            let points = points(plate.spec(), frequency_hz, FINE);
            let wave = Wave::new(plate.spec().clone(), points).expect("a plate");
            let shapes = wave.with_peak(SensorKind::Displacement, &places_m, &[frequency_hz]);
            let (shape, top) = &shapes[0];
            let impedance = Impedance { resistance_n_s_per_m: 0.3, mass_kg: 2e-4, stiffness_n_per_m: 300.0 };
            let source = Source { impedance, ..Source::soft(&plate.spec().model, frequency_hz) };
            let spec = PlateSpec { drive_end: DriveEnd::Source(source), ..plate.spec().clone() };
            let driven = Plate::new(spec).expect("valid");
            let field = respond(&driven, frequency_hz, 4001, Equation::Corrected).expect("a field");
            let step_m = plate.length_m() / 4000.0;
            let at = places_m
                .map(|place_m| seen(&field.amplitude, step_m, place_m, SensorKind::Displacement).norm());
            let ratio = (at[1] / at[0]) / (shape[1] / shape[0]);
            assert!((ratio - 1.0).abs() < 1e-3, "{name}: {ratio}");
            let peak = field.peak.expect("a peak").amplitude / at[0];
            assert!((peak / (top / shape[0]) - 1.0).abs() < 1e-3, "{name}");
        }
    }
}
