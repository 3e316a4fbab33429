//! The fitted source in a plate file: driven end, actuator and their parameters.

use crate::calibrate::fit::response::plate_response::{Units, soft_source};
use crate::calibrate::fit::result::Parameter;
use crate::definition::{
    Actuator, DriveEnd, Impedance, Plate, PlateError, PlateSpec, Resonator, Source, limits,
};
use std::f64::consts::TAU;

/// The fitted source of a calibration.
pub(crate) struct FittedSource {
    pub(crate) units: Units,
    /// Index of its first coordinate.
    pub(crate) first: usize,
    /// Resistance, mass and stiffness in units.
    pub(crate) impedance: [f64; 3],
    /// a1 and a2.
    pub(crate) actuator: [f64; 2],
    /// Coordinate of a1, counted from `first`; that of a2 follows.
    pub(crate) actuator_at: usize,
    /// The delay in units and its coordinate, counted from `first`; `None` where it is no result.
    pub(crate) delay: Option<(f64, usize)>,
}

impl FittedSource {
    /// The plate of `spec` with this source and its actuator.
    pub(crate) fn on(&self, spec: PlateSpec) -> Result<Plate, PlateError> {
        let spec = with_source(spec, self.units, self.units.impedance(self.impedance));
        Plate::new(with_actuator(spec, self.units, self.actuator))
    }

    /// Halves of the intervals of resistance, mass and stiffness, at most the highest that a file may have. `half` is that
    /// of a coordinate.
    pub(crate) fn tolerance(&self, half: impl Fn(usize) -> f64) -> Impedance {
        let of_file = self.units.impedance([0, 1, 2].map(|i| half(self.first + i)));
        let [resistance_n_s_per_m, mass_kg, stiffness_n_per_m] =
            of_file.fields().map(|(_, half, range)| half.min(range.high));
        Impedance { resistance_n_s_per_m, mass_kg, stiffness_n_per_m }
    }

    /// Its numbers with their names and intervals.
    pub(crate) fn parameters(&self, half: impl Fn(usize) -> f64) -> Vec<Parameter> {
        let half = |i: usize| half(self.first + i);
        let mut parameters = parameters_of_impedance(self.units, self.impedance, [0, 1, 2].map(half));
        let of_actuator = [self.actuator_at, self.actuator_at + 1].map(half);
        parameters.extend(parameters_of_actuator(self.units, self.actuator, of_actuator));
        let omega = self.units.omega;
        let delay = |(delay, at): (f64, usize)| Parameter::about("delay_s", delay / omega, half(at) / omega);
        parameters.extend(self.delay.map(delay));
        parameters
    }
}

/// `spec` with a source of this impedance at its driven end.
fn with_source(mut spec: PlateSpec, units: Units, impedance: Impedance) -> PlateSpec {
    let source = soft_source(&spec, units.omega / TAU);
    spec.drive_end = DriveEnd::Source(Source { impedance, ..source });
    spec
}

/// `spec` with the resonator 1/(1 + a1 sigma + a2 sigma^2), sigma = -j omega in units. An actuator whose travel the file
/// limits stays: the limit is stated for it, and the correction of the gain makes up for the difference. So it does for
/// numbers that are no resonator's.
fn with_actuator(mut spec: PlateSpec, units: Units, [a1, a2]: [f64; 2]) -> PlateSpec {
    let is_limited = spec
        .actuator
        .as_ref()
        .and_then(Actuator::resonator)
        .is_some_and(|resonator| resonator.travel.is_some());
    if !is_limited {
        spec.actuator = resonator(units, [a1, a2]).map(Actuator::Resonator);
    }
    spec
}

/// The resonator of these numbers, if there is one.
fn resonator(units: Units, [a1, a2]: [f64; 2]) -> Option<Resonator> {
    let resonance_hz = units.omega / TAU / a2.sqrt();
    let quality = a2.sqrt() / a1;
    let is_one = limits::RESONANCE.contains(resonance_hz) && limits::QUALITY.contains(quality);
    is_one.then_some(Resonator { resonance_hz, quality, travel: None })
}

/// Resistance, mass and stiffness with their names in the file, each with half of its interval in units.
fn parameters_of_impedance(units: Units, values: [f64; 3], halves: [f64; 3]) -> Vec<Parameter> {
    let names = ["drive.resistance_n_s_per_m", "drive.mass_kg", "drive.stiffness_n_per_m"];
    let in_si = |values: [f64; 3]| {
        let impedance = units.impedance(values);
        [impedance.resistance_n_s_per_m, impedance.mass_kg, impedance.stiffness_n_per_m]
    };
    let (values, halves) = (in_si(values), in_si(halves));
    (0..3).map(|i| Parameter::about(names[i], values[i], halves[i])).collect()
}

/// Resonance and quality with their names, from a1 and a2 with half of their intervals; none where they are no
/// resonator's.
fn parameters_of_actuator(units: Units, a: [f64; 2], halves: [f64; 2]) -> Vec<Parameter> {
    let Some(best) = resonator(units, a) else { return Vec::new() };
    // By propagation: f0 goes with a2^(-1/2), Q with a2^(1/2)/a1.
    let (of_rise, of_curve) = (halves[0] / a[0], halves[1] / a[1]);
    let quality = best.quality * of_rise.hypot(0.5 * of_curve);
    vec![
        Parameter::about("actuator.resonance_hz", best.resonance_hz, 0.5 * of_curve * best.resonance_hz),
        Parameter::about("actuator.quality", best.quality, quality),
    ]
}
