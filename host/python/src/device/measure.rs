//! Measurements with the device's own inputs.

use super::{Device, Loaded, lock, may_be_armed};
use crate::arguments::{count_in, in_range, optional};
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
use slipline_plate::quantity::{Range, must_be};
use std::error::Error;
use std::ffi::CString;

/// A measurement that is asked for.
pub(super) struct Wish {
    /// `None` for the current of the drive.
    pub(super) sensor: Option<Sensor>,
    pub(super) request: MeasureRequest,
}

/// The sensor of a call's arguments, with its mass and its width.
pub(super) fn asked_sensor(
    input: &str,
    place_m: Option<f64>,
    kind: &str,
    (mass_kg, width_m): (f64, f64),
) -> Result<Option<Sensor>, Failure> {
    let body = SensorBody::new(mass_kg, width_m).map_err(|error| Failure::of(&error))?;
    let kind = sensor_kind("kind", kind)?;
    match (input, place_m) {
        ("sensor", Some(place_m)) => Ok(Some(Sensor { place_m, kind, input: 0, body })),
        ("sensor", None) => Err(Failure::wrong_arguments("place_m of measure()", "the sensor's place")),
        ("current", _) => Ok(None),
        _ => Err(Failure::refused(must_be(format_args!("input = {input:?}"), "\"sensor\" or \"current\""))),
    }
}

/// The frequencies of a measurement and their level.
pub(super) fn frequencies(
    points: Option<i64>,
    low_hz: Option<f64>,
    high_hz: Option<f64>,
    level: Option<f64>,
) -> Result<Frequencies, Failure> {
    let points = points.map(|points| count_in("points", points, POINTS)).transpose()?;
    optional("level", level, LEVEL)?;
    Ok(Frequencies { low_hz, high_hz, points, level })
}

/// The drive circuit of a measurement: all values or none.
pub(super) fn circuit(
    amplifier_v: Option<f64>,
    coil_ohm: Option<f64>,
    piezo_f: Option<f64>,
    shunt_a: Option<f64>,
    bandwidths: Bandwidths,
) -> Result<Option<KnownDrive>, Failure> {
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

impl Wish {
    /// The sensor on this plate.
    fn sensor_on(&self, plate: &Plate) -> Result<Sensor, Failure> {
        let Some(sensor) = self.sensor else { return Ok(current_sensor()) };
        in_range("place_m", sensor.place_m, Range::new(0.0, plate.length_m(), "m"))?;
        Ok(sensor)
    }

    /// Moves the sensor of the simulated rig to its place.
    fn put_sensor(&self, rig: Option<&PreparedRig>, sensor: Sensor) -> Result<(), Failure> {
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
