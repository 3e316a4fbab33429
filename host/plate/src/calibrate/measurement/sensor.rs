//! The measurement of a sensor at one place: complex responses at given frequencies, with their noise.

use crate::calibrate::error::CalibrateError;
use crate::definition::{limits, sample_rate};
use crate::frequency::Finger;
use crate::quantity::{Count, Counted, OutOfRange, Range, WrongCount};
use num_complex::Complex64;

/// Number of points of a measurement.
pub const POINTS: Count = Count::new(8, 10_000, Counted::Points);
/// Range of the standard deviation of a sensor's place, metres.
pub(crate) const PLACE_TOLERANCE: Range = Range::new(0.0, 0.01, "m");
/// Magnitude of a response, in any unit: its square must not overflow.
const MAGNITUDE: Range = Range::new(0.0, 1e30, "");
/// Range of the headroom of an input below its full scale.
const HEADROOM: Range = Range::new(-200.0, 400.0, "dB");
/// Range of the mass of a sensor.
pub const SENSOR_MASS: Range = Range::new(0.0, 0.1, "kg");
/// Range of the side of the square on which a sensor with a mass stands.
pub const SENSOR_WIDTH: Range = limits::CONTACT;
/// Range of the sample rate of a DAC.
const SAMPLE_RATE: Range = Range::new(1.0, 1e9, "Hz");

/// The quantity that a sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SensorKind {
    /// The deflection w: a laser triangulator, a capacitive or eddy-current probe.
    Displacement,
    /// Its velocity: a laser vibrometer, a magnet and a coil, the pressure close to the plate.
    Velocity,
    /// Its acceleration: an accelerometer.
    Acceleration,
    /// The strain of the surface along x, proportional to the curvature w'': a piezo patch or strain gauge on a plate in
    /// bending. Membranes and shear waves have none of first order.
    Strain,
}

impl SensorKind {
    /// All kinds, in the order of their words in a list.
    pub const ALL: [Self; 4] = [Self::Displacement, Self::Velocity, Self::Acceleration, Self::Strain];

    /// Its word on a command line and in a file.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Strain => "strain",
        }
    }

    /// The signal over deflection or curvature, with `rate` as the factor of a derivative in time.
    pub(crate) fn rise(self, rate: Complex64) -> Complex64 {
        match self {
            Self::Displacement | Self::Strain => Complex64::ONE,
            Self::Velocity => rate,
            Self::Acceleration => rate * rate,
        }
    }
}

/// The response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MeasuredPoint {
    /// Frequency, Hz; rising from point to point.
    pub frequency_hz: f64,
    /// The sensor's signal over the DAC's amplitude (1 = full scale): the signal is Re(response e^(-j omega t)) for a
    /// code of cos(omega t), so a lag has a positive argument. Its unit is the sensor's own unless
    /// [`Measurement::unit_per_response`] states it. An instrument that uses e^(+j omega t) gives the complex
    /// conjugate.
    pub response: Complex64,
    /// Standard deviation of the real part and of the imaginary part of `response`, in its unit; above 0.
    pub noise: f64,
    /// Headroom of the input below its full scale, dB; 0 or less is a clipped signal. `None` if unknown.
    pub headroom_db: Option<f64>,
}

/// Responses of a sensor at one place, over frequency.
///
/// ```
/// use slipline_plate::calibrate::{MeasuredPoint, Measurement, SensorKind};
/// use slipline_plate::Complex64;
///
/// let points = (0..60).map(|i| MeasuredPoint {
///     frequency_hz: 90.0 + 2.0 * f64::from(i),
///     response: Complex64::new(0.2, 0.1),
///     noise: 0.002,
///     headroom_db: Some(20.0),
/// });
/// let measurement = Measurement::at(0.03, SensorKind::Acceleration, points.collect());
/// assert!(measurement.check().is_ok());
/// assert!(Measurement { place_m: -1.0, ..measurement }.check().is_err());
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Measurement {
    /// The sensor's place on the centre line, metres from the driven end.
    pub place_m: f64,
    /// Standard deviation of that place from its mark, metres (0 to 0.01).
    pub place_tolerance_m: f64,
    /// The measured quantity.
    pub sensor: SensorKind,
    /// Metres, m/s, m/s^2 or strain per unit of `response`; `None` for an uncalibrated sensor.
    pub unit_per_response: Option<f64>,
    /// Mass of the sensor, kg (0 to 0.1): it moves with the plate and lessens the motion that it measures. 0 for what does
    /// not touch the plate, such as a laser.
    pub sensor_mass_kg: f64,
    /// Side of the square on which a sensor with a mass stands, metres (0.0005 to 0.1); 0 without a mass.
    pub sensor_width_m: f64,
    /// Sample rate of the DAC that played the tones, Hz: the responses include its zero-order hold. `None` for a
    /// source without a hold.
    pub sample_rate_hz: Option<f64>,
    /// The responses, in rising frequency; 8 to 10 000.
    pub points: Vec<MeasuredPoint>,
}

/// The body of a sensor that weighs.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SensorBody {
    /// Its mass, kg (above 0, at most 0.1).
    pub mass_kg: f64,
    /// Side of the square on which it stands, metres (0.0005 to 0.1).
    pub width_m: f64,
}

impl SensorBody {
    /// The body of this mass and width; `None` without a mass.
    ///
    /// # Errors
    /// [`OutOfRange`] names `sensor_mass_kg` or `sensor_width_m`, and its range.
    pub fn new(mass_kg: f64, width_m: f64) -> Result<Option<Self>, OutOfRange> {
        OutOfRange::check("sensor_mass_kg", mass_kg, SENSOR_MASS)?;
        let low = if mass_kg > 0.0 { SENSOR_WIDTH.low } else { 0.0 };
        OutOfRange::check("sensor_width_m", width_m, Range { low, ..SENSOR_WIDTH })?;
        Ok((mass_kg > 0.0).then_some(Self { mass_kg, width_m }))
    }

    /// The same at a place, as a finger without damping.
    #[must_use]
    pub const fn at(self, place_m: f64) -> Finger {
        let Self { mass_kg, width_m } = self;
        Finger { place_m, resistance_n_s_per_m: 0.0, mass_kg, contact_m: width_m }
    }
}

/// Standard deviation of a place marked with a ruler, metres.
pub(crate) const PLACE_TOLERANCE_M: f64 = 2e-4;

impl Measurement {
    /// The responses of an uncalibrated sensor at a place marked with a ruler, without a zero-order hold.
    #[must_use]
    pub const fn at(place_m: f64, sensor: SensorKind, points: Vec<MeasuredPoint>) -> Self {
        Self {
            place_m,
            place_tolerance_m: PLACE_TOLERANCE_M,
            sensor,
            unit_per_response: None,
            sensor_mass_kg: 0.0,
            sensor_width_m: 0.0,
            sample_rate_hz: None,
            points,
        }
    }

    /// The body of a sensor that weighs.
    #[must_use]
    pub fn body(&self) -> Option<SensorBody> {
        let (mass_kg, width_m) = (self.sensor_mass_kg, self.sensor_width_m);
        (mass_kg > 0.0).then_some(SensorBody { mass_kg, width_m })
    }

    /// The same by a sensor with this body, or by one that does not weigh.
    #[must_use]
    pub fn by(self, body: Option<SensorBody>) -> Self {
        let (sensor_mass_kg, sensor_width_m) = body.map_or((0.0, 0.0), |body| (body.mass_kg, body.width_m));
        Self { sensor_mass_kg, sensor_width_m, ..self }
    }

    /// The gain of the hold of the DAC that played the tones.
    pub(crate) fn hold_droop(&self, frequency_hz: f64) -> f64 {
        self.sample_rate_hz.map_or(1.0, |rate_hz| sample_rate::hold_droop(frequency_hz, rate_hz))
    }

    /// Refuses a number that is out of its range.
    ///
    /// # Errors
    /// The first field that is out of range, and the range.
    pub fn check(&self) -> Result<(), CalibrateError> {
        WrongCount::check("the measurement", self.points.len(), POINTS)?;
        OutOfRange::check("place_m", self.place_m, Range::new(0.0, limits::LENGTH.high, "m"))?;
        OutOfRange::check("place_tolerance_m", self.place_tolerance_m, PLACE_TOLERANCE)?;
        if let Some(unit) = self.unit_per_response {
            OutOfRange::check("unit_per_response", unit, Range::new(1e-30, 1e30, ""))?;
        }
        SensorBody::new(self.sensor_mass_kg, self.sensor_width_m)?;
        if let Some(rate_hz) = self.sample_rate_hz {
            OutOfRange::check("sample_rate_hz", rate_hz, SAMPLE_RATE)?;
        }
        let mut lowest_hz = limits::CURVE_FREQUENCY.low;
        for point in &self.points {
            let rising = Range { low: lowest_hz, ..limits::CURVE_FREQUENCY };
            OutOfRange::check("frequency_hz", point.frequency_hz, rising)?;
            // A relative step of 1e-6, as between the points of a plate file's curve.
            lowest_hz = point.frequency_hz * (1.0 + 1e-6);
            OutOfRange::check("response", point.response.norm(), MAGNITUDE)?;
            OutOfRange::check("noise", point.noise, Range { low: 1e-30, ..MAGNITUDE })?;
            if let Some(headroom_db) = point.headroom_db {
                OutOfRange::check("headroom_db", headroom_db, HEADROOM)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measurement() -> Measurement {
        let points = (0..12).map(|i| MeasuredPoint {
            frequency_hz: 100.0 + f64::from(i),
            response: Complex64::new(1.0, -2.0),
            noise: 0.01,
            headroom_db: None,
        });
        Measurement::at(0.03, SensorKind::Displacement, points.collect())
    }

    #[test]
    fn a_measurement_out_of_range_is_refused_by_the_name_of_its_field() {
        assert_eq!(measurement().check(), Ok(()));
        let refused = |change: fn(&mut Measurement)| {
            let mut measurement = measurement();
            change(&mut measurement);
            measurement.check().expect_err("out of range").to_string()
        };
        let point = |change: fn(&mut MeasuredPoint)| {
            let mut measurement = measurement();
            change(&mut measurement.points[5]);
            measurement.check().expect_err("out of range").to_string()
        };
        assert!(refused(|it| it.points.truncate(7)).starts_with("the measurement has 7 points"));
        assert!(refused(|it| it.place_m = f64::NAN).starts_with("place_m = NaN"));
        assert!(refused(|it| it.place_tolerance_m = 0.1).starts_with("place_tolerance_m = 0.1"));
        assert!(refused(|it| it.unit_per_response = Some(0.0)).starts_with("unit_per_response = 0"));
        assert!(refused(|it| it.sensor_mass_kg = -1e-3).starts_with("sensor_mass_kg = -0.001 kg"));
        let bodiless = refused(|it| it.sensor_mass_kg = 1e-3);
        assert!(bodiless.starts_with("sensor_width_m = 0 m: must be 0.0005 to 0.1 m"), "{bodiless}");
        assert!(refused(|it| it.sample_rate_hz = Some(-1.0)).starts_with("sample_rate_hz = -1"));
        assert!(point(|it| it.frequency_hz = 104.0).starts_with("frequency_hz = 104 Hz"));
        assert!(point(|it| it.response.im = f64::INFINITY).starts_with("response = "));
        assert!(point(|it| it.noise = 0.0).starts_with("noise = 0"));
        assert!(point(|it| it.headroom_db = Some(f64::NAN)).starts_with("headroom_db = NaN"));
    }
}
