//! What a sensor that weighs leaves of the motion that it measures.
//!
//! It moves by w/(1 - omega^2 m G), with the bare plate's motion w and the receptance G under its own width (see
//! `frequency/finger/receptance.rs`). The driven end enters G, so a fit that knows no source has four more coordinates for a
//! sensor that weighs ([`BODY_COORDINATES`]).

use super::plate_response::{
    LoadedEnd, PlateResponse, Units, dynamic_stiffness, soft_source, takes_a_source,
};
use super::wave::{FINE, Wave, points};
use crate::calibrate::error::CalibrateError;
use crate::calibrate::measurement::sensor::{Measurement, SensorBody};
use crate::definition::{DriveEnd, Plate, PlateSpec, Source};
use crate::frequency::driven_end::DrivenEnd;
use crate::frequency::finger::{Receptance, Receptances};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Standard deviation of ln of a sensor's mass over the stated one: it is stated within a fifth.
pub(crate) const OF_MASS: f64 = 0.1;
/// The same of the resistance of a source over the file's, and standard deviations of the reactances of its mass and of its
/// stiffness in the middle of the band, over that resistance.
const OF_RESISTANCE: f64 = 0.7;
const OF_REACTANCE: f64 = 0.7;
/// Least resistance that these are shares of, in units of the plate's impedance.
const RESISTANCE_MIN: f64 = 0.1;
/// Standard deviations by which a mass may differ from the stated one.
const DEVIATIONS_MAX: f64 = 4.0;
/// A sensor must keep this share of the bare plate's motion at every frequency.
const KEPT: f64 = 0.2;

/// The driven end of a plate while its source is open: the file's source, or another one.
#[derive(Clone, Copy)]
pub(crate) struct OpenSource {
    soft: Source,
    pub(crate) units: Units,
    /// Resistance, mass and stiffness of the file, in units.
    impedance: [f64; 3],
}

impl OpenSource {
    /// That of a plate file; `None` where the end is moved, or where the file does not state what a source needs.
    pub(crate) fn of(plate: &Plate, units: Units) -> Option<Self> {
        let spec = plate.spec();
        takes_a_source(spec).ok()?;
        let resistance = match spec.drive_end {
            DriveEnd::Displacement | DriveEnd::DisplacementAndSlope { .. } => return None,
            DriveEnd::Force { .. } => 0.0,
            DriveEnd::Resistance { ratio, at_frequency_hz } => {
                ratio * plate.wave_impedance_n_s_per_m(at_frequency_hz)? / units.impedance
            }
            DriveEnd::Source(source) => source.impedance.resistance_n_s_per_m / units.impedance,
        };
        let (mass, stiffness) = match spec.drive_end {
            DriveEnd::Source(source) => (
                source.impedance.mass_kg * units.omega / units.impedance,
                source.impedance.stiffness_n_per_m / (units.impedance * units.omega),
            ),
            _ => (0.0, 0.0),
        };
        let soft = soft_source(spec, units.omega / TAU);
        Some(Self { soft, units, impedance: [resistance, mass, stiffness] })
    }

    /// The source at the coordinates of a fit.
    fn at(&self, coordinates: [f64; 3]) -> [f64; 3] {
        let [of_resistance, of_mass, of_stiffness] = coordinates;
        let [resistance, mass, stiffness] = self.impedance;
        let size = resistance.max(RESISTANCE_MIN);
        [size * of_resistance.exp(), mass + size * of_mass, stiffness + size * of_stiffness]
    }
}

/// Coordinates of a fit without a source, after the places: ln of the sensor's mass over the stated one, ln of the source's
/// resistance over the file's, its reactances of mass and of stiffness over that resistance, beside the file's.
pub(crate) const BODY_COORDINATES: usize = 4;

/// Their standard deviations beforehand; `held` for those of a driven end without a source.
pub(crate) fn deviations_of(source: Option<&OpenSource>, held: f64) -> [f64; BODY_COORDINATES] {
    match source {
        Some(_) => [OF_MASS, OF_RESISTANCE, OF_REACTANCE, OF_REACTANCE],
        None => [OF_MASS, held, held, held],
    }
}

/// The driven end that closes a receptance.
pub(crate) enum ClosedEnd {
    /// That of a plate file.
    Own(Box<Plate>),
    /// A source that is open.
    Open(Box<LoadedEnd>, OpenSource),
}

impl ClosedEnd {
    /// That of the plate of `spec`; `None` where it is refused.
    pub(crate) fn of(spec: &PlateSpec, source: Option<&OpenSource>) -> Option<Self> {
        match source {
            Some(source) => {
                let end = LoadedEnd::new(spec, source.soft, source.units)?;
                Some(Self::Open(Box::new(end), *source))
            }
            None => Some(Self::Own(Box::new(Plate::new(spec.clone()).ok()?))),
        }
    }

    /// The receptances at one frequency, closed by this end.
    pub(crate) fn close(&self, frequency_hz: f64, receptances: Receptances) -> Closed {
        let Receptances { places, starts } = receptances;
        let (loads, source) = match self {
            Self::Own(plate) => {
                let end = DrivenEnd::of(plate, frequency_hz);
                let load = |[value, slope]: [Complex64; 2]| end.alpha * value + end.beta * slope;
                (starts.map(|start| [load(start), Complex64::ZERO]), None)
            }
            Self::Open(end, open) => {
                let load = |[value, slope]: [Complex64; 2]| end.of_wave(frequency_hz, value, slope);
                (starts.map(load), Some(*open))
            }
        };
        Closed { frequency_hz, places, loads, source }
    }
}

/// Receptances at one frequency with the loads of u and r on the driven end.
pub(crate) struct Closed {
    frequency_hz: f64,
    places: Vec<Receptance>,
    loads: [[Complex64; 2]; 2],
    source: Option<OpenSource>,
}

impl Closed {
    /// 1 - omega^2 m G for a body of `mass_kg` at one of the places, with an open source at these coordinates.
    pub(crate) fn rise(&self, place: usize, mass_kg: f64, source: [f64; 3]) -> Complex64 {
        let stiffness = self.source.map_or(Complex64::ZERO, |open| {
            dynamic_stiffness(open.at(source), open.units.rate(self.frequency_hz))
        });
        let [of_u, of_r] = self.loads.map(|[force, motion]| force + stiffness * motion);
        let Receptance { held, returned } = self.places[place];
        let omega = TAU * self.frequency_hz;
        1.0 - omega * omega * mass_kg * (held - of_u / of_r * returned)
    }
}

/// Puts a sensor of this body at the first place of `answers`, those of the plate of `spec` on a grid of `points`. With the
/// loads of u and r on a source, 1 - omega^2 m G is linear in its dynamic stiffness once it is multiplied by the load of r:
///
/// load' = load(r) (1 - omega^2 m held) + omega^2 m returned load(u)
pub(crate) fn weigh(
    answers: &mut [PlateResponse],
    spec: &PlateSpec,
    points: usize,
    units: Units,
    (body, place_m): (SensorBody, f64),
) -> Option<()> {
    let end = LoadedEnd::new(spec, soft_source(spec, units.omega / TAU), units)?;
    let still = PlateSpec { drive_end: DriveEnd::Displacement, ..spec.clone() };
    let wave = Wave::new(still, points).ok()?;
    let frequencies_hz: Vec<f64> = answers.iter().map(|answer| answer.frequency_hz).collect();
    let all = wave.receptances(body.width_m, &[place_m], &frequencies_hz);
    for (answer, receptances) in answers.iter_mut().zip(all) {
        let of_wave = |[value, slope]: [Complex64; 2]| end.of_wave(answer.frequency_hz, value, slope);
        let [of_u, of_r] = receptances.starts.map(of_wave);
        // Both are loads of one wave, in two scales.
        let bare = [answer.force, answer.motion];
        let scale =
            (bare[0] * of_r[0].conj() + bare[1] * of_r[1].conj()) / (of_r[0].norm_sqr() + of_r[1].norm_sqr());
        let inertia = (TAU * answer.frequency_hz).powi(2) * body.mass_kg;
        let Receptance { held, returned } = receptances.places[0];
        let loaded = |i: usize| bare[i] * (1.0 - inertia * held) + inertia * returned * scale * of_u[i];
        (answer.force, answer.motion, answer.bare) = (loaded(0), loaded(1), Some(bare));
    }
    Some(())
}

/// 1 - omega^2 m G on a plate with the driven end of its file, at each frequency.
pub(crate) fn rises(
    plate: &Plate,
    body: SensorBody,
    place_m: f64,
    frequencies_hz: &[f64],
) -> Result<Vec<Complex64>, CalibrateError> {
    plate.spec().model.surface_density("a sensor's mass")?;
    let Some(highest_hz) = frequencies_hz.iter().copied().reduce(f64::max) else { return Ok(Vec::new()) };
    let wave = Wave::new(plate.spec().clone(), points(plate.spec(), highest_hz, FINE))?;
    let end = ClosedEnd::Own(Box::new(plate.clone()));
    let all = wave.receptances(body.width_m, &[place_m], frequencies_hz);
    let rise =
        |(hz, receptances): (&f64, Receptances)| end.close(*hz, receptances).rise(0, body.mass_kg, [0.0; 3]);
    Ok(frequencies_hz.iter().zip(all).map(rise).collect())
}

/// The largest masses of a sensor at one place, kg.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SensorMasses {
    /// With a stated mass: the sensor keeps a fifth of the bare plate's motion.
    // JSON: Largest mass of a sensor on a square of 4 mm at the proposed places, with its mass stated
    pub stated_kg: f64,
    /// Without a statement: what it changes is below the error of the model, 1.5 %.
    // JSON: The same without a stated mass
    pub unstated_kg: f64,
}

impl SensorMasses {
    /// Those of a sensor on a square of side `width_m` at `place_m`, at frequencies that enter the plate, with the driven
    /// end of the file.
    pub(crate) fn at(
        plate: &Plate,
        place_m: f64,
        width_m: f64,
        frequencies_hz: &[f64],
        model_error: f64,
    ) -> Result<Self, CalibrateError> {
        let body = SensorBody { mass_kg: 1.0, width_m };
        let rises = rises(plate, body, place_m, frequencies_hz)?;
        let largest = rises.iter().map(|rise| (1.0 - rise).norm()).fold(0.0, f64::max);
        // |1 - z| is at most 1/KEPT while |z| is at most 1/KEPT - 1.
        Ok(Self { stated_kg: (KEPT.recip() - 1.0) / largest, unstated_kg: model_error / largest })
    }
}

/// Refuses a sensor that leaves less than a fifth of the bare plate's motion.
pub(crate) fn check_mass(
    plate: &Plate,
    sensor: &Measurement,
    frequencies_hz: &[f64],
) -> Result<(), CalibrateError> {
    let Some(body) = sensor.body() else { return Ok(()) };
    let masses = SensorMasses::at(plate, sensor.place_m, body.width_m, frequencies_hz, 0.0)?;
    let (place_m, mass_kg, most_kg) = (sensor.place_m, body.mass_kg, masses.stated_kg);
    if mass_kg > most_kg {
        return Err(CalibrateError::HeavySensor { place_m, mass_kg, most_kg });
    }
    Ok(())
}

/// Refuses a fitted mass, at its coordinate, that is another one than stated.
pub(crate) fn check_fitted_mass(sensor: &Measurement, coordinate: Option<f64>) -> Result<(), CalibrateError> {
    let mass_kg = sensor.sensor_mass_kg;
    match coordinate {
        Some(at) if at.abs() > DEVIATIONS_MAX * OF_MASS => {
            Err(CalibrateError::AnotherMass { mass_kg, found_kg: mass_kg * at.exp() })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::preset;
    use crate::frequency::equation::Equation;
    use crate::frequency::finger::{Finger, share_left};
    use crate::frequency::numerov::Grid;

    /// A finger without damping is a body, too; its field is computed over cells that move apart.
    #[test]
    fn a_body_changes_the_response_as_a_finger_of_its_mass_and_a_heavy_one_within_15_per_cent() {
        for (name, place_m, width_m, masses_kg, frequencies_hz) in [
            ("membrane", 0.11, 5e-3, [1e-7, 3e-5], [95.0, 130.0, 180.0, 215.0]),
            ("membrane-heavy", 0.09, 8e-3, [1e-6, 5e-4], [95.0, 130.0, 180.0, 215.0]),
        ] {
            let plate = preset(name).expect("a preset");
            let points = points(plate.spec(), frequencies_hz[3], 0.25 * FINE);
            let grid = Grid::new(&plate, Equation::Corrected, points, 1);
            for (mass_kg, most) in masses_kg.into_iter().zip([5e-2, 0.15]) {
                let found =
                    rises(&plate, SensorBody { mass_kg, width_m }, place_m, &frequencies_hz).expect("rises");
                for (&hz, rise) in frequencies_hz.iter().zip(found) {
                    let finger = Finger { place_m, resistance_n_s_per_m: 0.0, mass_kg, contact_m: width_m };
                    let wanted = share_left(&grid, &plate, &finger, hz).inv();
                    println!("{name} {mass_kg} kg {hz} Hz: {rise:.4}, as a finger {wanted:.4}");
                    let off = (rise - wanted).norm() / (wanted - 1.0).norm().max(1e-12);
                    assert!(off < most, "{name} {mass_kg} kg {hz} Hz: {rise} {wanted}");
                }
            }
        }
    }

    /// The fit of a source with its plate finds the same share as the file's own end.
    #[test]
    fn a_source_that_is_stated_and_one_that_is_open_close_a_receptance_alike() {
        for (name, place_m, frequencies_hz) in
            [("membrane", 0.11, [95.0, 150.0, 215.0]), ("al-bending", 0.08, [21e3, 28e3, 37e3])]
        {
            let plate = preset(name).expect("a preset");
            let middle_hz = frequencies_hz[1];
            let impedance = 0.7 * plate.wave_impedance_n_s_per_m(middle_hz).expect("stated");
            let units = Units { impedance, omega: TAU * middle_hz };
            let source = [1.3, 0.4, 0.2];
            let soft = soft_source(plate.spec(), middle_hz);
            let ended = Source { impedance: units.impedance(source), ..soft };
            let plate = plate.with_drive_end(DriveEnd::Source(ended));
            let body = SensorBody { mass_kg: 5e-5, width_m: 5e-3 };
            let wanted = rises(&plate, body, place_m, &frequencies_hz).expect("rises");
            let open = OpenSource::of(&plate, units).expect("a source");
            let end = ClosedEnd::of(plate.spec(), Some(&open)).expect("an end");
            let count = points(plate.spec(), frequencies_hz[2], FINE);
            let still = PlateSpec { drive_end: DriveEnd::Displacement, ..plate.spec().clone() };
            let wave = Wave::new(still, count).expect("a wave");
            let all = wave.receptances(body.width_m, &[place_m], &frequencies_hz);
            let kind = crate::calibrate::SensorKind::Displacement;
            let places = [place_m];
            let mut found = super::super::plate_response::answers(
                plate.spec(),
                count,
                units,
                kind,
                &places,
                &frequencies_hz,
                false,
            )
            .expect("answers");
            weigh(&mut found, plate.spec(), count, units, (body, place_m)).expect("weighs");
            for (((&hz, receptances), wanted), answer) in
                frequencies_hz.iter().zip(all).zip(wanted).zip(&found)
            {
                let rise = end.close(hz, receptances).rise(0, body.mass_kg, [0.0; 3]);
                assert!((rise - wanted).norm() < 1e-6 * wanted.norm(), "{name} {hz}: {rise} {wanted}");
                let whole = answer.rise(source);
                assert!((whole / wanted.norm() - 1.0).abs() < 1e-4, "{name} {hz}: {whole} {wanted}");
            }
        }
    }
}
