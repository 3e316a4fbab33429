//! The fitted source in a plate file: driven end, actuator and their parameters.

use crate::calibrate::fit::parameter::Parameter;
use crate::calibrate::fit::response::plate_response::{Units, soft_source};
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
    /// Offset of the coordinate of a1 from `first`; that of a2 follows.
    pub(crate) actuator_at: usize,
    /// The delay in units and the offset of its coordinate from `first`; `None` where it is not a result.
    pub(crate) delay: Option<(f64, usize)>,
}

impl FittedSource {
    /// The plate of `spec` with this source, and with the resonator 1/(1 + a1 sigma + a2 sigma^2), sigma = -j omega
    /// in units. The actuator of the file is kept where its travel is limited, because the limit is stated for it,
    /// and where a1 and a2 are not those of a resonator. The correction of the gain then compensates.
    pub(crate) fn on(&self, mut spec: PlateSpec) -> Result<Plate, PlateError> {
        let source = soft_source(&spec, self.units.omega / TAU);
        let impedance = self.units.impedance(self.impedance);
        spec.drive_end = DriveEnd::Source(Source { impedance, ..source });
        let resonator = spec.actuator.as_ref().and_then(Actuator::resonator);
        if resonator.is_none_or(|resonator| resonator.travel.is_none()) {
            spec.actuator = self.resonator().map(Actuator::Resonator);
        }
        Plate::new(spec)
    }

    /// The resonator of a1 and a2, if its resonance and quality are in range.
    fn resonator(&self) -> Option<Resonator> {
        let [a1, a2] = self.actuator;
        let resonance_hz = self.units.omega / TAU / a2.sqrt();
        let quality = a2.sqrt() / a1;
        let is_one = limits::RESONANCE.contains(resonance_hz) && limits::QUALITY.contains(quality);
        is_one.then_some(Resonator { resonance_hz, quality, travel: None })
    }

    /// Halves of the intervals of resistance, mass and stiffness; `half` gives that of a coordinate.
    fn halves(&self, half: impl Fn(usize) -> f64) -> Impedance {
        self.units.impedance([0, 1, 2].map(|i| half(self.first + i)))
    }

    /// The same, limited to the largest tolerance that a file may have.
    pub(crate) fn tolerance(&self, half: impl Fn(usize) -> f64) -> Impedance {
        let [resistance_n_s_per_m, mass_kg, stiffness_n_per_m] =
            self.halves(half).fields().map(|(_, half, range)| half.min(range.high));
        Impedance { resistance_n_s_per_m, mass_kg, stiffness_n_per_m }
    }

    /// Its numbers with their names and intervals.
    pub(crate) fn parameters(&self, half: impl Fn(usize) -> f64) -> Vec<Parameter> {
        let names = ["drive.resistance_n_s_per_m", "drive.mass_kg", "drive.stiffness_n_per_m"];
        let [values, halves] =
            [self.units.impedance(self.impedance), self.halves(&half)].map(|it| it.fields().map(|it| it.1));
        let mut parameters: Vec<Parameter> =
            (0..3).map(|i| Parameter::about(names[i], values[i], halves[i])).collect();
        let half = |i: usize| half(self.first + i);
        if let Some(Resonator { resonance_hz, quality, .. }) = self.resonator() {
            // Error propagation: f0 varies as a2^(-1/2), Q as a2^(1/2)/a1.
            let [of_rise, of_curve] = [0, 1].map(|i| half(self.actuator_at + i) / self.actuator[i]);
            let half_hz = 0.5 * of_curve * resonance_hz;
            let of_quality = quality * of_rise.hypot(0.5 * of_curve);
            parameters.push(Parameter::about("actuator.resonance_hz", resonance_hz, half_hz));
            parameters.push(Parameter::about("actuator.quality", quality, of_quality));
        }
        let omega = self.units.omega;
        let delay = |(delay, at): (f64, usize)| Parameter::about("delay_s", delay / omega, half(at) / omega);
        parameters.extend(self.delay.map(delay));
        parameters
    }
}
