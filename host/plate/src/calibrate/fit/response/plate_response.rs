//! Response of the plate to a force on its driven end: the motion there, at a sensor and at the peak.
//!
//! The driven end's condition is linear in the source's dynamic stiffness D = s - omega^2 m - j omega R, for every
//! model and with a lead-in: the part F_p of the force F that reaches the plate and the motion f(0) of the end are
//! both linear in p(0) and p'(0), and F = F_p + D f(0). So the responses to two sources determine those to all
//! others.

use super::wave::Wave;
use crate::calibrate::measurement::sensor::{MeasuredPoint, SensorKind};
use crate::definition::{DriveEnd, Impedance, Plate, PlateError, PlateSpec, Source};
use crate::frequency::driven_end::DrivenEnd;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Units in which a fit expresses a source: of the order of the plate's own values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Units {
    /// The plate's wave impedance in the middle of the band, N s/m.
    pub(crate) impedance: f64,
    /// The angular frequency of that middle, rad/s.
    pub(crate) omega: f64,
}

impl Units {
    /// Units for a nominal plate measured at these points; `None` if the file does not state what the impedance
    /// needs.
    pub(crate) fn of(plate: &Plate, points: &[MeasuredPoint]) -> Option<Self> {
        let middle_hz = (points.first()?.frequency_hz * points.last()?.frequency_hz).sqrt();
        let impedance = plate.wave_impedance_n_s_per_m(middle_hz).filter(|z| *z > 0.0)?;
        Some(Self { impedance, omega: TAU * middle_hz })
    }

    /// The rate -j omega over the middle's angular frequency.
    pub(crate) fn rate(self, frequency_hz: f64) -> Complex64 {
        Complex64::new(0.0, -TAU * frequency_hz / self.omega)
    }

    /// The impedance with the resistance, mass and stiffness `source` in these units.
    pub(crate) fn impedance(self, [resistance, mass, stiffness]: [f64; 3]) -> Impedance {
        Impedance {
            resistance_n_s_per_m: resistance * self.impedance,
            mass_kg: mass * self.impedance / self.omega,
            stiffness_n_per_m: stiffness * self.impedance * self.omega,
        }
    }
}

/// Response of the plate at one frequency; the scale of the wave is arbitrary.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlateResponse {
    pub(crate) frequency_hz: f64,
    /// -j omega over the middle's angular frequency.
    pub(crate) rate: Complex64,
    /// F_p over the force F, for a unit drive.
    pub(crate) force: Complex64,
    /// f(0) times the unit of stiffness, over F.
    pub(crate) motion: Complex64,
    /// The derivatives of `force` and `motion` by the place of the driven end, 1/m, of the bare plate.
    pub(crate) by_end: [Complex64; 2],
    /// `force` and `motion` of the bare plate where a sensor weighs on it: the two above are then those that give the
    /// sensor's own motion from the bare plate's `seen`.
    pub(crate) bare: Option<[Complex64; 2]>,
    /// p(0) and p'(0).
    pub(crate) at_end: [Complex64; 2],
    /// p at each place; p'' for a strain sensor.
    pub(crate) seen: Vec<Complex64>,
    /// What each place shows of the third width mode, where it was requested: of one as high as p(0) at the driven end, and of what the
    /// taper makes there.
    pub(crate) third: Vec<[Complex64; 2]>,
    /// Amplitude of the peak, where it was requested.
    pub(crate) peak: f64,
}

/// D in these units: s + R (-j omega) + m (-j omega)^2.
pub(crate) fn dynamic_stiffness([resistance, mass, stiffness]: [f64; 3], rate: Complex64) -> Complex64 {
    stiffness + rate * (resistance + rate * mass)
}

impl PlateResponse {
    /// F in the scale of F_p: the force that this source needs for a unit drive.
    pub(crate) fn load(&self, source: [f64; 3]) -> Complex64 {
        self.force + dynamic_stiffness(source, self.rate) * self.motion
    }

    /// The same where the driven end is `end_m` from where the equation has it.
    pub(crate) fn load_of_end(&self, source: [f64; 3], end_m: f64) -> Complex64 {
        let [force, motion] = self.by_end;
        self.load(source) + end_m * (force + dynamic_stiffness(source, self.rate) * motion)
    }

    /// The bare plate's motion over that of a sensor that weighs.
    pub(crate) fn rise(&self, source: [f64; 3]) -> f64 {
        let Some([force, motion]) = self.bare else { return 1.0 };
        (self.load(source) / (force + dynamic_stiffness(source, self.rate) * motion)).norm()
    }
}

/// The driven end with a source of zero impedance and the source kind of the file.
pub(crate) fn soft_source(spec: &PlateSpec, middle_hz: f64) -> Source {
    match spec.drive_end {
        DriveEnd::Source(source) => Source { impedance: Impedance::default(), ..source },
        end => Source::soft(&spec.model, end.at_frequency_hz().unwrap_or(middle_hz)),
    }
}

/// The driven end of a plate under a source of any impedance.
pub(crate) struct LoadedEnd {
    /// The plate with a source of zero impedance, and with one of unit stiffness.
    soft: Plate,
    stiff: Plate,
}

impl LoadedEnd {
    /// `soft` is the source of zero impedance; `None` where the plate is refused.
    pub(crate) fn new(spec: &PlateSpec, soft: Source, units: Units) -> Option<Self> {
        let plate = Plate::new(PlateSpec { drive_end: DriveEnd::Source(soft), ..spec.clone() }).ok()?;
        let stiff = Source { impedance: units.impedance([0.0, 0.0, 1.0]), ..soft };
        Some(Self { stiff: plate.with_drive_end(DriveEnd::Source(stiff)), soft: plate })
    }

    /// The load on the source by a wave with p(0) = `value` and p'(0) = `slope`: F_p over the force F of a unit
    /// drive, and f(0) times the unit of stiffness over F.
    pub(crate) fn of_wave(&self, frequency_hz: f64, value: Complex64, slope: Complex64) -> [Complex64; 2] {
        let condition = |plate: &Plate| {
            let end = DrivenEnd::of(plate, frequency_hz);
            (end.alpha * value + end.beta * slope) / end.drive
        };
        let force = condition(&self.soft);
        [force, condition(&self.stiff) - force]
    }
}

/// Responses of the plate of `spec` at these frequencies, on a grid of `points`; `None` where the plate is refused or
/// a frequency does not enter it.
pub(crate) fn answers(
    spec: &PlateSpec,
    points: usize,
    units: Units,
    sensor: SensorKind,
    places_m: &[f64],
    frequencies_hz: &[f64],
    with_peak: bool,
) -> Option<Vec<PlateResponse>> {
    let (&lowest_hz, &highest_hz) = (frequencies_hz.first()?, frequencies_hz.last()?);
    let middle_hz = units.omega / TAU;
    let end = LoadedEnd::new(spec, soft_source(spec, middle_hz), units)?;
    // For a prescribed slope the field is p(0) over p'(0).
    let wave = Wave::with_slope(spec.clone(), points, middle_hz).ok()?;
    if !(wave.enters(lowest_hz) && wave.enters(highest_hz)) {
        return None;
    }
    let rows = wave.complex(sensor, places_m, frequencies_hz, with_peak);
    let answer = |(&frequency_hz, row): (&f64, super::wave::Row)| {
        let slope = wave.slope(frequency_hz);
        let [force, motion] = end.of_wave(frequency_hz, row.value, slope);
        // f'' by the amplitude equation.
        let square = wave.plate().width_mode(1).wavenumber_squared(0.0, frequency_hz);
        let bend = -wave.plate().narrowing_per_m(0.0) * slope - square * row.value;
        let by_end = end.of_wave(frequency_hz, slope, bend);
        let rate = units.rate(frequency_hz);
        let (at_end, seen, peak) = ([row.value, slope], row.seen, row.peak);
        let third = Vec::new();
        PlateResponse { frequency_hz, rate, force, motion, by_end, bare: None, at_end, seen, third, peak }
    };
    Some(frequencies_hz.iter().zip(rows).map(answer).collect())
}

/// Refuses a plate that a source cannot act on: it needs bending with the same thickness everywhere, or a stated tension
/// or thickness.
pub(crate) fn takes_a_source(spec: &PlateSpec) -> Result<(), PlateError> {
    if spec.thickness.is_some() {
        let reason = "a fit of the source needs the near field of its end, which has no law with it";
        return Err(PlateError::unexpected("thickness", reason));
    }
    spec.model.surface_density("a fit of the source").map(drop)
}
