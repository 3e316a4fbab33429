//! Measurements with the device's own inputs.

use super::{ANY, Device, Loaded, lock, may_be_armed};
use crate::error::Failure;
use crate::measurement::{Measurement, sensor_kind};
use crate::options::Options;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slipline_instrument::measure::circuit::{AMPLIFIER, COIL, PIEZO, SHUNT};
use slipline_instrument::measure::{KnownDrive, LEVEL, POINTS, Sensor, current_sensor};
use slipline_instrument::native::Measurer;
use slipline_instrument::requests::{Frequencies, IncompleteCircuit, MeasureRequest, circuit_of};
use slipline_instrument::rig::PreparedRig;
use slipline_plate::calibrate::SensorKind;
use slipline_plate::quantity::{OutOfRange, Range, must_be};

/// A measurement that is asked for.
pub(super) struct Wish {
    /// `None` for the current of the drive.
    sensor: Option<(f64, SensorKind)>,
    request: MeasureRequest,
}

impl Wish {
    /// The request of a call's arguments.
    pub(super) fn new(
        place_m: Option<f64>,
        kind: &str,
        input: &str,
        as_cli: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut options = Options::new("measure", as_cli)?;
        let kind = sensor_kind(kind)?;
        let sensor = match (input, place_m) {
            ("sensor", Some(place_m)) => Some((place_m, kind)),
            ("sensor", None) => {
                return Err(Failure::wrong_arguments("place_m of measure()", "the sensor's place").into());
            }
            ("current", _) => None,
            _ => {
                let given = format_args!("input = {input:?}");
                return Err(Failure::refused(must_be(given, "\"sensor\" or \"current\"")).into());
            }
        };
        let points = options.number("points", POINTS)?;
        if let Some(points) = points.filter(|points| points.fract() != 0.0) {
            return Err(options.wrong("points", &format!("a whole number, not {points}")).into());
        }
        let frequencies = Frequencies {
            low_hz: options.number("from_", ANY)?,
            high_hz: options.number("to", ANY)?,
            points: points.map(|points| points as usize),
            level: options.number("level", LEVEL)?,
        };
        let is_sweep = options.switch("sweep")?;
        let request = MeasureRequest { frequencies, is_sweep, known: known_drive(&mut options)? };
        options.end()?;
        Ok(Self { sensor, request })
    }
}

/// The drive circuit of the options: all values or none.
fn known_drive(options: &mut Options<'_>) -> PyResult<Option<KnownDrive>> {
    let [amplifier, coil, piezo, shunt] =
        [("amplifier", AMPLIFIER), ("coil", COIL), ("piezo", PIEZO), ("shunt", SHUNT)]
            .map(|(name, range)| options.number(name, range));
    let known = circuit_of(amplifier?, coil?, piezo?, shunt?);
    Ok(known.map_err(|IncompleteCircuit| {
        let given = "the drive circuit of measure()";
        Failure::wrong_arguments(given, "amplifier, shunt, and one of coil and piezo")
    })?)
}

impl Device {
    /// Measures the plate in use.
    pub(super) fn measure_plate(&self, py: Python<'_>, wish: Wish) -> PyResult<Measurement> {
        let Loaded { plate, on_device, .. } = self.loaded()?;
        let consent = lock(&self.state).consent;
        let rig = self.rig.clone();
        let measured = self.call(py, move |client| {
            let sensor = match wish.sensor {
                None => current_sensor(),
                Some((place_m, kind)) => {
                    let on_plate = Range::new(0.0, plate.length_m(), "m");
                    OutOfRange::check("place_m", place_m, on_plate)
                        .map_err(|it| Failure::out_of_range(&it))?;
                    Sensor { place_m, kind, input: 0 }
                }
            };
            may_be_armed(client, consent)?;
            let measurer = Measurer::new(client, &plate, &on_device, &wish.request);
            let measurer = measurer.map_err(|error| Failure::of(&error))?;
            if let Some(rig) = rig.as_ref().filter(|_| wish.sensor.is_some()) {
                put_sensor(rig, sensor)?;
            }
            client.disarm()?;
            if let Some(known) = wish.request.known_with(rig.as_ref()) {
                client.check_drive(&plate, &on_device, known, |_| ())?;
            }
            Ok(measurer.measure(sensor, |_| ())?)
        })?;
        Ok(measured.measurement.into())
    }
}

/// Moves the sensor of the simulated rig to its place.
fn put_sensor(rig: &PreparedRig, sensor: Sensor) -> Result<(), Failure> {
    if sensor.kind != SensorKind::Displacement {
        let text = "the sensor of the simulated device measures displacement: leave out kind";
        return Err(Failure::refused(text));
    }
    rig.hand().put_sensor(sensor.place_m).map_err(|error| Failure::of(&error))
}
