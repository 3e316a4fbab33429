//! Constant parts of a running rig.

use super::amplifier::with_images;
use super::error::RigError;
use super::fault::RigFault;
use super::motor::Motor;
use super::sampler::Signals;
use super::standing::{Standing, Weighed};
use slipline_plate::calibrate::{SensorBody, SensorKind};
use slipline_plate::{Complex64, Output, SenseError, SensedPlate};
use std::fmt;
use std::sync::Arc;

/// The computed parts of a rig.
#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Parts {
    pub(super) plate: SensedPlate,
    pub(super) motor: Motor,
    /// The quantity that the sensor shows.
    pub(super) sensor: SensorKind,
    /// What a device samples.
    pub(super) signals: Arc<Signals>,
    /// The fraction of a sample of the sensor's delay, seconds.
    pub(super) late_s: f64,
    /// Bandwidth of the amplifier, Hz, unless it passes every frequency.
    pub(super) amplifier_hz: Option<f64>,
    /// Share of full scale within which the output of the DAC is linear.
    pub(super) linear_share: f64,
    /// What the sensor weighs.
    pub(super) body: Option<SensorBody>,
}

/// The current through the shunt of a motor on this plate.
pub(super) fn current_of(
    motor: &Motor,
    plate: &SensedPlate,
    amplifier_hz: Option<f64>,
) -> Result<Output, SenseError> {
    let actuator = plate.plate().spec().actuator.as_ref();
    let rate_hz = plate.sample_rate_hz();
    let with_images = |hz: f64| amplifier_hz.map_or(Complex64::ONE, |of| with_images(motor, of, hz, rate_hz));
    let amplifier =
        |hz: f64| actuator.map_or(Complex64::ONE, |actuator| actuator.response(hz)) * with_images(hz);
    plate.with_held_drive_point(motor.held(), |hz, velocity| motor.current_a(hz, amplifier(hz), velocity))
}

impl fmt::Debug for Parts {
    /// Shows the plate by its name; the other fields are some thousand numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("Parts");
        debug.field("plate", &self.plate.plate().name()).field("sensor", &self.sensor).finish_non_exhaustive()
    }
}

impl Parts {
    /// The sensor on a mark.
    pub(super) fn sensor_at(&self, place_m: f64, fault: Option<RigFault>) -> Result<Standing, RigError> {
        let length_m = self.plate.plate().length_m();
        let off_m = match fault {
            Some(RigFault::OffItsMark(off_m)) if (0.0..=length_m).contains(&place_m) => off_m,
            _ => 0.0,
        };
        let stands_m = if off_m == 0.0 { place_m } else { (place_m + off_m).clamp(0.0, length_m) };
        let Some(body) = self.body else {
            let sensor = Arc::new(self.plate.sensor(self.sensor, stands_m, self.late_s)?);
            return Ok(Standing { sensor, weighed: None });
        };
        let sensed = if self.signals.coil.is_some() { SensedPlate::with_harmonics } else { SensedPlate::new };
        let plate = sensed(self.plate.plate(), Some(&body.at(stands_m)), self.plate.sample_rate_hz())?;
        let sensor = Arc::new(plate.sensor(self.sensor, stands_m, self.late_s)?);
        let current = current_of(&self.motor, &plate, self.amplifier_hz)?;
        Ok(Standing { sensor, weighed: Some(Arc::new(Weighed { at_rest: plate.at_rest(), current })) })
    }
}
