//! Measurements with the device's own inputs.

use super::{ANY, Device, Loaded, lock, may_be_armed};
use crate::error::Failure;
use crate::measurement::{Measurement, sensor_kind};
use crate::options::Options;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slipline_instrument::measure::circuit::{AMPLIFIER, COIL, PIEZO, SHUNT, TOLERANCE};
use slipline_instrument::measure::{KnownDrive, LEVEL, POINTS, Sensor, Wanted, current_sensor};
use slipline_instrument::native::Measurer;
use slipline_instrument::rig::PreparedRig;
use slipline_plate::calibrate::{DriveCircuit, DriveLoad, SensorKind};
use slipline_plate::quantity::{OutOfRange, Range, must_be};

/// A measurement that is asked for.
pub(super) struct Wish {
    /// `None` for the current of the drive.
    sensor: Option<(f64, SensorKind)>,
    from_hz: Option<f64>,
    to_hz: Option<f64>,
    points: Option<usize>,
    level: Option<f64>,
    is_sweep: bool,
    known: Option<KnownDrive>,
}

impl Wish {
    /// What the arguments of a call ask for.
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
        let wish = Self {
            sensor,
            from_hz: options.number("from_", ANY)?,
            to_hz: options.number("to", ANY)?,
            points: points.map(|points| points as usize),
            level: options.number("level", LEVEL)?,
            is_sweep: options.switch("sweep")?,
            known: known_drive(&mut options)?,
        };
        options.end()?;
        Ok(wish)
    }
}

/// The drive circuit of the options: all values or none.
fn known_drive(options: &mut Options<'_>) -> PyResult<Option<KnownDrive>> {
    let full_scale_v = options.number("amplifier", AMPLIFIER)?;
    let coil = options.number("coil", COIL)?.map(|resistance_ohm| DriveLoad::Coil { resistance_ohm });
    let piezo = options.number("piezo", PIEZO)?.map(|capacitance_f| DriveLoad::Piezo { capacitance_f });
    let full_scale_a = options.number("shunt", SHUNT)?;
    match (full_scale_v, coil.xor(piezo), full_scale_a) {
        (Some(full_scale_v), Some(load), Some(full_scale_a)) => {
            let circuit = DriveCircuit { full_scale_v, load, tolerance: TOLERANCE };
            Ok(Some(KnownDrive { circuit, full_scale_a }))
        }
        (None, None, None) if coil.is_none() => Ok(None),
        _ => {
            let given = "the drive circuit of measure()";
            Err(Failure::wrong_arguments(given, "amplifier, shunt, and one of coil and piezo").into())
        }
    }
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
            let of_plate = Wanted::of(&plate);
            let wanted = Wanted {
                low_hz: wish.from_hz.unwrap_or(of_plate.low_hz),
                high_hz: wish.to_hz.unwrap_or(of_plate.high_hz),
                points: wish.points.unwrap_or(of_plate.points),
                level: wish.level.unwrap_or(of_plate.level),
            };
            let measurer = Measurer::new(client, &plate, &on_device, &wanted, wish.is_sweep);
            let measurer = measurer.map_err(|error| Failure::of(&error))?;
            if let Some(rig) = rig.as_ref().filter(|_| wish.sensor.is_some()) {
                put_sensor(rig, sensor)?;
            }
            client.disarm()?;
            if let Some(known) = wish.known.or_else(|| rig.as_ref().map(PreparedRig::known_drive)) {
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
