//! What the mass of a sensor at two places leaves of the wave, in a fit that knows no source.

use super::response::plate_response::Units;
use super::response::sensor_body::{BODY_COORDINATES, Closed, ClosedEnd, OpenSource, deviations_of};
use super::response::wave::Wave;
use crate::calibrate::measurement::sensor::Measurement;
use crate::definition::{Plate, PlateSpec};

/// The sensor at both places.
#[derive(Clone)]
pub(crate) struct SensorLoad {
    masses_kg: [f64; 2],
    width_m: f64,
    source: Option<OpenSource>,
}

impl SensorLoad {
    /// `None` where the sensor does not weigh.
    pub(crate) fn of(plate: &Plate, sensors: [&Measurement; 2]) -> Option<Self> {
        let width_m = sensors.iter().filter_map(|sensor| sensor.body()).map(|body| body.width_m).next()?;
        let masses_kg = sensors.map(|sensor| sensor.body().map_or(0.0, |body| body.mass_kg));
        let source = Units::of(plate, &sensors[0].points).and_then(|units| OpenSource::of(plate, units));
        Some(Self { masses_kg, width_m, source })
    }

    pub(crate) fn swap(&mut self) {
        self.masses_kg.swap(0, 1);
    }

    /// Standard deviations of the coordinates of mass and source beforehand.
    pub(crate) fn deviations(&self, held: f64) -> [f64; BODY_COORDINATES] {
        deviations_of(self.source.as_ref(), held)
    }

    /// Its effect on the plate of `spec`, whose wave is `wave`, at places of the sensors with these numbers.
    pub(crate) fn on(
        &self,
        wave: &Wave,
        spec: &PlateSpec,
        (places_m, sensors): (&[f64], &'static [usize]),
        frequencies_hz: &[f64],
    ) -> Option<Load<'_>> {
        let end = ClosedEnd::of(spec, self.source.as_ref())?;
        let receptances = wave.receptances(self.width_m, places_m, frequencies_hz);
        let closed = frequencies_hz.iter().zip(receptances).map(|(hz, it)| end.close(*hz, it)).collect();
        Some(Load { sensor: self, sensors, closed })
    }
}

/// The same on one plate, for every mass and source.
pub(crate) struct Load<'a> {
    sensor: &'a SensorLoad,
    /// The number of the sensor at each place.
    sensors: &'static [usize],
    closed: Vec<Closed>,
}

impl Load<'_> {
    /// Turns the magnitudes of the bare wave at the places, a row for each frequency, into those that the sensors show.
    /// Coordinates that are absent are 0.
    pub(crate) fn lessen(&self, rows: &mut [Vec<f64>], coordinates: &[f64]) {
        let at = |i: usize| coordinates.get(i).copied().unwrap_or(0.0);
        let (factor, source) = (at(0).exp(), [at(1), at(2), at(3)]);
        for (row, closed) in rows.iter_mut().zip(&self.closed) {
            for (place, (p, &sensor)) in row.iter_mut().zip(self.sensors).enumerate() {
                let mass_kg = factor * self.sensor.masses_kg[sensor];
                *p /= closed.rise(place, mass_kg, source).norm();
            }
        }
    }
}
