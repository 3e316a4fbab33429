//! Measurements with the device's own inputs.

use super::{Device, Loaded, lock, may_be_armed};
use crate::arguments::{count_in, optional};
use crate::error::Failure;
use crate::measurement::{Measurement, sensor_kind};
use crate::plate::Plate as PyPlate;
use crate::result::kind::Harmonics;
use crate::result::{Answer, fields};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use slipline_instrument::measure::circuit::{AMPLIFIER, COIL, PIEZO, SHUNT};
use slipline_instrument::measure::{
    BANDWIDTH, Bandwidths, HARMONIC_POINTS, KnownDrive, LEVEL, POINTS, Sensor, Warning, current_sensor,
};
use slipline_instrument::native::{ArmingConsent, Client, InterruptibleLink, Measurer};
use slipline_instrument::requests::{
    Frequencies, HarmonicsAnswer, IncompleteCircuit, MeasureRequest, circuit_of,
};
use slipline_instrument::rig::PreparedRig;
use slipline_plate::Plate;
use slipline_plate::calibrate::{SensorBody, SensorKind};
use slipline_plate::quantity::{OutOfRange, Range, must_be};
use std::error::Error;
use std::ffi::CString;

/// The frequencies of a measurement and their level, as they are given.
pub(super) struct Band {
    pub(super) points: Option<i64>,
    pub(super) low_hz: Option<f64>,
    pub(super) high_hz: Option<f64>,
    pub(super) level: Option<f64>,
    pub(super) sweep: bool,
}

/// The drive circuit of a measurement, as it is given: all values or none.
pub(super) struct Circuit {
    pub(super) amplifier_v: Option<f64>,
    pub(super) coil_ohm: Option<f64>,
    pub(super) piezo_f: Option<f64>,
    pub(super) shunt_a: Option<f64>,
    pub(super) bandwidths: Bandwidths,
}

/// A measurement that is asked for.
pub(super) struct Wish {
    /// `None` for the current of the drive.
    sensor: Option<(f64, SensorKind, Option<SensorBody>)>,
    pub(super) request: MeasureRequest,
}

impl Wish {
    /// The request of a call's arguments.
    pub(super) fn new(
        (place_m, kind, body): (Option<f64>, &str, Option<SensorBody>),
        input: &str,
        band: Band,
        circuit: Circuit,
    ) -> Result<Self, Failure> {
        let kind = sensor_kind("kind", kind)?;
        let sensor = match (input, place_m) {
            ("sensor", Some(place_m)) => Some((place_m, kind, body)),
            ("sensor", None) => {
                return Err(Failure::wrong_arguments("place_m of measure()", "the sensor's place"));
            }
            ("current", _) => None,
            _ => {
                let given = format_args!("input = {input:?}");
                return Err(Failure::refused(must_be(given, "\"sensor\" or \"current\"")));
            }
        };
        let frequencies = band.frequencies()?;
        let request = MeasureRequest { frequencies, is_sweep: band.sweep, known: circuit.known()? };
        Ok(Self { sensor, request })
    }

    /// The sensor on this plate.
    pub(super) fn sensor_on(&self, plate: &Plate) -> Result<Sensor, Failure> {
        let Some((place_m, kind, body)) = self.sensor else { return Ok(current_sensor()) };
        let on_plate = Range::new(0.0, plate.length_m(), "m");
        OutOfRange::check("place_m", place_m, on_plate).map_err(|it| Failure::out_of_range(&it))?;
        Ok(Sensor { place_m, kind, input: 0, body })
    }

    /// Moves the sensor of the simulated rig to its place.
    pub(super) fn put_sensor(&self, rig: Option<&PreparedRig>, sensor: Sensor) -> Result<(), Failure> {
        let Some(rig) = rig.filter(|_| self.sensor.is_some()) else { return Ok(()) };
        if sensor.kind != SensorKind::Displacement {
            let text = "the sensor of the simulated device measures displacement: leave out kind";
            return Err(Failure::refused(text));
        }
        if sensor.body.is_some() {
            let text = "the sensor of the simulated device does not weigh: leave out sensor_mass_kg";
            return Err(Failure::refused(text));
        }
        rig.hand().put_sensor(sensor.place_m).map_err(|error| Failure::of(&error))
    }
}

impl Band {
    /// The frequencies and their level.
    pub(super) fn frequencies(&self) -> Result<Frequencies, Failure> {
        let Self { points, low_hz, high_hz, level, .. } = *self;
        let points = points.map(|points| count_in("points", points, POINTS)).transpose()?;
        optional("level", level, LEVEL)?;
        Ok(Frequencies { low_hz, high_hz, points, level })
    }
}

impl Circuit {
    /// None: the drive is not checked.
    pub(super) const UNKNOWN: Self = Self {
        amplifier_v: None,
        coil_ohm: None,
        piezo_f: None,
        shunt_a: None,
        bandwidths: Bandwidths { amplifier_hz: None, filter_hz: None },
    };

    fn known(self) -> Result<Option<KnownDrive>, Failure> {
        let Self { amplifier_v, coil_ohm, piezo_f, shunt_a, bandwidths } = self;
        optional("amplifier_bandwidth_hz", bandwidths.amplifier_hz, BANDWIDTH)?;
        optional("filter_bandwidth_hz", bandwidths.filter_hz, BANDWIDTH)?;
        optional("amplifier_v", amplifier_v, AMPLIFIER)?;
        optional("coil_ohm", coil_ohm, COIL)?;
        optional("piezo_f", piezo_f, PIEZO)?;
        optional("shunt_a", shunt_a, SHUNT)?;
        circuit_of(amplifier_v, coil_ohm, piezo_f, shunt_a, bandwidths).map_err(|IncompleteCircuit| {
            let given = "the drive circuit of measure()";
            Failure::wrong_arguments(given, "amplifier_v, shunt_a, and one of coil_ohm and piezo_f")
        })
    }
}

/// Why a band is refused, by the names of the arguments.
pub(super) fn of_band(error: &(dyn Error + 'static)) -> Failure {
    Failure::of(error).named("from", "low_hz").named("to", "high_hz").named("time", "duration_s")
}

/// A wish on a device: its sensor stands in its place, and what measures it is planned.
pub(super) struct Ready<'a> {
    pub(super) sensor: Sensor,
    pub(super) measurer: Measurer<'a, InterruptibleLink>,
}

impl Wish {
    /// Plans the measurement of the plate in use, by a device that may be armed with this consent and is disarmed, and puts the sensor
    /// in its place.
    pub(super) fn ready<'a>(
        &self,
        client: &'a Client<InterruptibleLink>,
        Loaded { plate, on_device, .. }: &Loaded,
        (consent, rig): (ArmingConsent, Option<&PreparedRig>),
    ) -> Result<Ready<'a>, Failure> {
        let sensor = self.sensor_on(plate)?;
        may_be_armed(client, consent)?;
        client.disarm()?;
        let measurer = Measurer::new(client, plate, on_device, &self.request);
        let measurer = measurer.map_err(|error| of_band(&error))?;
        self.put_sensor(rig, sensor)?;
        Ok(Ready { sensor, measurer })
    }

    /// Checks that a drive whose circuit is known is on.
    fn check_drive(
        &self,
        client: &Client<InterruptibleLink>,
        Loaded { plate, on_device, .. }: &Loaded,
        rig: Option<&PreparedRig>,
    ) -> Result<(), Failure> {
        if let Some(known) = self.request.known_with(rig) {
            client.check_drive(plate, on_device, known, |_| ())?;
        }
        Ok(())
    }
}

impl Device {
    /// Measures the plate in use.
    pub(super) fn measure_plate(&self, py: Python<'_>, wish: Wish) -> PyResult<Measurement> {
        let loaded = self.loaded()?;
        let (consent, rig) = (lock(&self.state).consent, self.rig.clone());
        let measured = self.call(py, move |client| {
            let Ready { sensor, measurer } = wish.ready(client, &loaded, (consent, rig.as_ref()))?;
            wish.check_drive(client, &loaded, rig.as_ref())?;
            Ok(measurer.measure(sensor, |_| ())?)
        })?;
        let of_images = |it: &&Warning| matches!(it, Warning::UnknownImages | Warning::Images { .. });
        for warning in measured.warnings.iter().filter(of_images) {
            let text = CString::new(warning.sentence()).unwrap_or_default();
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
        }
        Ok(measured.measurement.into())
    }

    /// Measures the harmonics of the drive at this number of fundamentals.
    pub(super) fn measure_harmonics_of(
        &self,
        py: Python<'_>,
        wish: Wish,
        points: i64,
        level: f64,
    ) -> PyResult<Answer<Harmonics>> {
        let points = count_in("points", points, HARMONIC_POINTS)?;
        let loaded = self.loaded()?;
        let (consent, rig) = (lock(&self.state).consent, self.rig.clone());
        let (found, plate) = self.call(py, move |client| {
            let Loaded { plate, on_device, .. } = &loaded;
            let sensor = wish.sensor_on(plate)?;
            may_be_armed(client, consent)?;
            client.disarm()?;
            let measuring = client.measuring_harmonics(plate, on_device, (points, level), sensor);
            let measuring = measuring.map_err(|error| Failure::of(&error))?;
            wish.put_sensor(rig.as_ref(), sensor)?;
            wish.check_drive(client, &loaded, rig.as_ref())?;
            let found = client.run(measuring, |_| ())?;
            let measured = found.on(plate).map_err(|error| Failure::of(&error))?;
            Ok((fields(&HarmonicsAnswer::of(&measured, &sensor, &found)), measured))
        })?;
        Answer::of(py, found)?.with(py, "plate", Py::new(py, PyPlate::from(plate))?)
    }
}
