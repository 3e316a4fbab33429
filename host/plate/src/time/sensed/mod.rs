//! The plate as sampled by the inputs of a device: DAC codes in, the signal of a sensor at a place and the motion of
//! the drive point out, one value per code.
//!
//! ```text
//! field at sampled frequencies --> poles (fit) --> resonators at the sample rate, common to all places
//!              |                                          |
//!              +--> residues of one place (output) ------>+--> one value per code
//! ```
//! The resonators do not depend on the sensor's place: it may be moved while they ring. There is no filter between
//! the codes and the plate, so a response is delayed by the hold of the DAC alone.

mod drive;
mod error;
mod fields;
mod lanes;
mod output;
mod resonators;

use super::band_plan::BandPlan;
use super::drive_curve::DriveCurve;
use super::fit;
use super::line::{LineError, check_fit};
use crate::calibrate::SensorKind;
use crate::definition::actuator::Actuator;
use crate::definition::plate::Plate;
use crate::definition::sample_rate::{self, hold_droop};
use crate::frequency::finger::Finger;
use crate::quantity::{OutOfRange, Range};
use fields::Fields;
use num_complex::Complex64;
use std::f64::consts::TAU;

pub use error::SenseError;
use error::{CLAMPED_ERROR_MAX, CURVE_ERROR_MAX, ERROR_MAX};
use output::Held;
pub use output::Output;
pub use resonators::Resonators;

/// Number of places for the search of the poles.
const PLACES: usize = 129;
/// Exact band: factors on the lowest and the highest frequency of the span's band.
const BEYOND: (f64, f64) = (0.8, 1.5);
/// The second of them for a drive with harmonics up to the third.
const HARMONICS: f64 = 3.1;
/// The same with a finger: far above the band, its contact is not a sum of resonances.
const BEYOND_TOUCHED: (f64, f64) = (1.0, 1.05);
/// Number of frequencies at which the plate holds its drive.
const HELD_FREQUENCIES: u32 = 24;
/// Their weights over that of the band: the second is used where the first leaves too large an error in the band.
const HELD_WEIGHTS: [f64; 2] = [0.03, 0.01];
/// Factors per sample of signals that decay within a few samples: they follow the codes directly.
const SHORT: [Complex64; 4] =
    [Complex64::ZERO, Complex64::new(0.5, 0.0), Complex64::new(-0.5, 0.0), Complex64::new(0.0, 0.6)];
/// Highest frequency of the background poles over the sample rate.
const TOP_TO_RATE: f64 = 0.4;

/// A plate at a sample rate, prepared for sampling at any place.
///
/// ```
/// use slipline_plate::calibrate::SensorKind;
/// use slipline_plate::{SensedPlate, preset};
///
/// let plate = SensedPlate::new(&preset("membrane").unwrap(), None, 400e3).unwrap();
/// let sensor = plate.sensor(SensorKind::Displacement, 0.03, 0.0).unwrap();
/// let velocity = plate.with_drive_point(|_, velocity| velocity).unwrap();
/// let mut resonators = plate.at_rest();
/// let mut largest_m: f64 = 0.0;
/// for n in 0..40_000 {
///     let code = (std::f64::consts::TAU * 150.0 * f64::from(n) / 400e3).cos();
///     let [metres, _metres_per_s] = resonators.step(code, [&sensor, &velocity]);
///     largest_m = largest_m.max(metres);
/// }
/// assert!(largest_m > 1e-6);
/// ```
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub struct SensedPlate {
    #[serde(with = "crate::exchange::by_text")]
    plate: Plate,
    sample_rate_hz: f64,
    fields: Fields,
    /// e^(-j p T) of each pole p of the plate.
    advance: Vec<Complex64>,
}

impl SensedPlate {
    /// Prepares a plate, optionally with a resting finger, for codes at one of [`crate::sample_rates`].
    ///
    /// From 0.8 of the lowest frequency of the plate's span to 1.5 of its highest one (with a finger that damps from the
    /// lowest to 1.05 of the highest; on a membrane in a baffle at most to 0.95 of the frequency that turns at the plate's end)
    /// the response is that of the frequency domain, between clamped edges within one or two hundredths, in a baffle within
    /// three; above this band it falls off. It includes a measured actuator and the correction of a calibration, with the
    /// minimum phase of their gain; noise between their points is smoothed, see [`Output::error`].
    ///
    /// # Errors
    /// Those of [`super::TimeDomainLine::touched`].
    pub fn new(plate: &Plate, finger: Option<&Finger>, sample_rate_hz: f64) -> Result<Self, LineError> {
        Self::up_to(plate, finger, sample_rate_hz, BEYOND.1)
    }

    /// As [`SensedPlate::new`], and exact up to 3.1 times the highest frequency of the span, for a drive with harmonics; with a
    /// finger that damps no farther than that.
    ///
    /// # Errors
    /// As [`SensedPlate::new`].
    pub fn with_harmonics(
        plate: &Plate,
        finger: Option<&Finger>,
        sample_rate_hz: f64,
    ) -> Result<Self, LineError> {
        Self::up_to(plate, finger, sample_rate_hz, HARMONICS)
    }

    /// A plate that is exact up to `reach` times the highest frequency of the span.
    fn up_to(
        plate: &Plate,
        finger: Option<&Finger>,
        sample_rate_hz: f64,
        reach: f64,
    ) -> Result<Self, LineError> {
        sample_rate::check(plate, sample_rate_hz)?;
        if let Some(finger) = finger {
            finger.check(plate).map_err(LineError::Finger)?;
        }
        // A body without damping is a resonance among those of the plate.
        let beyond = if finger.is_some_and(|it| it.resistance_n_s_per_m > 0.0) {
            BEYOND_TOUCHED
        } else {
            (BEYOND.0, reach)
        };
        let (low_hz, high_hz) = plate.band_hz();
        let far_air_ends_hz = fit::far_air_ends_hz(plate);
        let end_hz = far_air_ends_hz.unwrap_or(f64::INFINITY);
        let top_hz = (beyond.1 * high_hz).min(end_hz).min(TOP_TO_RATE * sample_rate_hz).max(high_hz);
        let plan = BandPlan::new(sample_rate_hz, beyond.0 * low_hz, top_hz);
        let stop_hz = plan.stop_hz();
        let exact_hz = (beyond.0 * low_hz, top_hz);
        let fit = fit::of_plate(plate, finger, &plan, PLACES, exact_hz);
        // Between clamped edges, and in a baffle, only the resonances are taken from an approximate fit; each output has its own
        // error.
        if plate.width_mode(1).strip.is_none() && far_air_ends_hz.is_none() {
            check_fit(&fit)?;
        }
        let decay = |pole: &[Complex64]| -> Vec<Complex64> {
            let decays = pole.iter().map(|p| (Complex64::new(0.0, -1.0) * p / sample_rate_hz).exp());
            decays.chain(SHORT).collect()
        };
        let mut pole = fit.bank.pole;
        pole.extend(drive::resonances(plate, exact_hz, stop_hz, sample_rate_hz, decay));
        let pole = fields::with_background(&pole, stop_hz, sample_rate_hz);
        let fields = Fields::new(plate, finger, &pole, exact_hz, stop_hz, sample_rate_hz);
        let advance = decay(&pole);
        Ok(Self { plate: plate.clone(), sample_rate_hz, fields, advance })
    }

    /// The signal of a sensor at `place_m` (0 to the plate's length) per code of 1, in metres, m/s, m/s^2 or strain,
    /// with an additional delay of `delay_s` (0 to one sample).
    ///
    /// A tone whose codes are cos(omega t_n) gives Re(H e^(-j omega (t_n - delay))) at sample n, with H = the steady
    /// amplitude at the place times the hold's droop sinc(f/fs), and the delay `delay_s` +
    /// [`SensedPlate::hold_delay_s`].
    ///
    /// # Errors
    /// [`SenseError`]: the place is not on the plate, the delay is out of range, the surface of this plate has no
    /// strain, or the response at this place is not a sum of resonances.
    pub fn sensor(&self, sensor: SensorKind, place_m: f64, delay_s: f64) -> Result<Output, SenseError> {
        OutOfRange::check("sensor place", place_m, Range::new(0.0, self.plate.length_m(), "m"))?;
        OutOfRange::check("sensor delay", delay_s, Range::new(0.0, 1.0 / self.sample_rate_hz, "s"))?;
        let per_deflection = self.per_deflection(sensor)?;
        self.output(delay_s, |hz, field| {
            per_deflection(hz) * self.fields.seen(field, place_m, sensor) * self.code_to_drive(hz)
        })
    }

    /// A signal that depends on the drive point: `signal` gets a frequency in Hz and the drive point's velocity per
    /// code of 1 there, m/s, and returns the signal's amplitude per code of 1.
    ///
    /// # Errors
    /// [`SenseError::Unfit`].
    pub fn with_drive_point(
        &self,
        signal: impl Fn(f64, Complex64) -> Complex64,
    ) -> Result<Output, SenseError> {
        self.output(0.0, |hz, field| {
            signal(hz, Complex64::new(0.0, -TAU * hz) * field[0] * self.code_to_drive(hz))
        })
    }

    /// The largest amplitude on the plate per code of 1, at the frequency of the span's band where it is least: about
    /// the level that a table's tone at level 1 reaches everywhere. In metres, m/s, m/s^2 or strain.
    ///
    /// # Errors
    /// [`SenseError::NoStrain`].
    pub fn even_amplitude(&self, sensor: SensorKind) -> Result<f64, SenseError> {
        let (low_hz, high_hz) = self.plate.band_hz();
        let per_deflection = self.per_deflection(sensor)?;
        let deflection = |hz: f64, field: &[Complex64]| {
            field.iter().map(Complex64::norm_sqr).fold(0.0, f64::max).sqrt() * self.code_to_drive(hz).norm()
        };
        let band = || self.fields.each().filter(|(hz, _)| (low_hz..=high_hz).contains(hz));
        let least_m = band().map(|(hz, field)| deflection(hz, field)).fold(f64::INFINITY, f64::min);
        // A table levels the deflection, so for every other kind the highest frequency is the loudest.
        let curvature = match sensor {
            // For a plane wave.
            SensorKind::Strain => self.plate.width_mode(1).wavenumber_squared(0.0, high_hz).max(0.0),
            _ => 1.0,
        };
        Ok(least_m * curvature * per_deflection(high_hz).norm())
    }

    /// The signal of a sensor for a deflection of 1 m (a curvature of 1/m for strain) at a frequency.
    fn per_deflection(&self, sensor: SensorKind) -> Result<impl Fn(f64) -> Complex64 + use<>, SenseError> {
        // The surface is half of the thickness away from the neutral plane.
        let half_thickness_m = self.plate.spec().model.bending().map(|bending| 0.5 * bending.thickness_m);
        if sensor == SensorKind::Strain && half_thickness_m.is_none() {
            return Err(SenseError::NoStrain);
        }
        Ok(move |hz: f64| {
            let omega = TAU * hz;
            match sensor {
                SensorKind::Displacement => Complex64::ONE,
                SensorKind::Velocity => Complex64::new(0.0, -omega),
                SensorKind::Acceleration => Complex64::from(-omega * omega),
                SensorKind::Strain => Complex64::from(half_thickness_m.unwrap_or(f64::NAN)),
            }
        })
    }

    /// Metres of drive per code of 1, over a unit drive of the plate's solver.
    fn code_to_drive(&self, frequency_hz: f64) -> Complex64 {
        let spec = self.plate.spec();
        let resonator = spec.actuator.as_ref().and_then(Actuator::resonator);
        let actuator = resonator.map_or(Complex64::ONE, |it| it.response(frequency_hz));
        let drive = actuator * spec.full_scale_m;
        DriveCurve::of(&self.plate).map_or(drive, |curve| drive * curve.least_phase_response(frequency_hz))
    }

    /// The same without the correction of a calibration: the actuator alone.
    fn code_to_actuator(&self, frequency_hz: f64) -> Complex64 {
        let spec = self.plate.spec();
        let actuator = spec.actuator.as_ref().map_or(Complex64::ONE, |it| it.response(frequency_hz));
        actuator * spec.full_scale_m
    }

    /// The largest deflection of the drive point per code of 1 between two fractions of the cut-off, metres: 0 below the frequencies
    /// at which the field is known, where the plate holds its drive.
    pub fn held_drive_point_m(&self, (low, high): (f64, f64)) -> f64 {
        let cut_off_hz = self.plate.cut_off_hz();
        let in_band =
            self.fields.each().filter(|(hz, _)| (low * cut_off_hz..=high * cut_off_hz).contains(hz));
        in_band.map(|(hz, field)| (field[0] * self.code_to_actuator(hz)).norm()).fold(0.0, f64::max)
    }

    /// As [`SensedPlate::with_drive_point`], and in addition between two fractions of the cut-off, where no wave
    /// enters: there the output is within some per cent of `signal`, below the frequencies at which the field is known for a drive
    /// point at rest.
    ///
    /// The velocity is that behind the actuator alone, in proportion to the actuator's input. It does not include the
    /// correction of a calibration, the gain from the code to the peak.
    ///
    /// # Errors
    /// [`SenseError::Unfit`].
    pub fn with_held_drive_point(
        &self,
        (low, high): (f64, f64),
        signal: impl Fn(f64, Complex64) -> Complex64,
    ) -> Result<Output, SenseError> {
        let cut_off_hz = self.plate.cut_off_hz();
        let (low_hz, high_hz) = (low * cut_off_hz, high * cut_off_hz);
        // Where the field is known it is that of the plate.
        let known_hz = self.fields.each().next().map_or(f64::INFINITY, |(hz, _)| hz);
        let held = || {
            let spread = (0..HELD_FREQUENCIES).map(|i| {
                let share = f64::from(i) / f64::from(HELD_FREQUENCIES - 1);
                low_hz * (high_hz / low_hz).powf(share)
            });
            spread.filter(|hz| *hz < known_hz).map(|hz| (hz, signal(hz, Complex64::ZERO)))
        };
        let drive = |hz: f64, field: &[Complex64]| {
            signal(hz, Complex64::new(0.0, -TAU * hz) * field[0] * self.code_to_actuator(hz))
        };
        let fit =
            |weight: f64| self.output_with(0.0, drive, held().collect(), Held { low_hz, high_hz, weight });
        // The resonances of the band cannot always follow it below as well: the band has priority.
        let [heaviest, lightest] = HELD_WEIGHTS;
        fit(heaviest).or_else(|_| fit(lightest))
    }

    /// The output of a steady signal per code; hold and delay of the codes are added here.
    fn output(
        &self,
        delay_s: f64,
        amplitude: impl Fn(f64, &[Complex64]) -> Complex64,
    ) -> Result<Output, SenseError> {
        self.output_with(delay_s, amplitude, Vec::new(), Held::NOWHERE)
    }

    /// The same with additional amplitudes at frequencies below all fields.
    fn output_with(
        &self,
        delay_s: f64,
        amplitude: impl Fn(f64, &[Complex64]) -> Complex64,
        held: Vec<(f64, Complex64)>,
        where_held: Held,
    ) -> Result<Output, SenseError> {
        let steady = self.fields.each().map(|(hz, field)| (hz, amplitude(hz, field)));
        let goal = |(hz, amplitude): (f64, Complex64)| {
            let lag = Complex64::cis(TAU * hz * (self.hold_delay_s() + delay_s));
            (hz, amplitude * hold_droop(hz, self.sample_rate_hz) * lag)
        };
        let goals = held.into_iter().chain(steady).map(goal).collect();
        let output = Output::fit(goals, self.exact_hz(), where_held, &self.advance, self.sample_rate_hz);
        let most = match (self.plate.width_mode(1).strip, DriveCurve::of(&self.plate)) {
            (Some(_), _) => CLAMPED_ERROR_MAX,
            (None, Some(_)) => CURVE_ERROR_MAX,
            (None, None) if fit::far_air_ends_hz(&self.plate).is_some() => CURVE_ERROR_MAX,
            (None, None) => ERROR_MAX,
        };
        let error = output.error();
        if error.is_nan() || error > most { Err(SenseError::Unfit { error, most }) } else { Ok(output) }
    }

    /// Delay of every output, seconds: half a sample, the mean time for which the DAC holds a code. Inputs that are
    /// sampled as each code leaves have no other delay.
    pub fn hold_delay_s(&self) -> f64 {
        0.5 / self.sample_rate_hz
    }

    /// The steady amplitude of an output of this plate per code of 1 at `frequency_hz`, as by [`SensedPlate::sensor`].
    pub fn steady(&self, output: &Output, frequency_hz: f64) -> Complex64 {
        output.steady(&self.advance, frequency_hz, self.sample_rate_hz)
    }

    /// The resonators at rest.
    pub fn at_rest(&self) -> Resonators {
        Resonators::new(&self.advance)
    }

    /// The band in which every output is that of the frequency domain, Hz.
    pub(crate) fn exact_hz(&self) -> (f64, f64) {
        self.fields.exact_hz()
    }

    /// The sample rate of the codes, Hz.
    pub const fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// The plate.
    pub fn plate(&self) -> &Plate {
        &self.plate
    }
}

#[cfg(test)]
mod tests;
