//! Options of a rig.

use super::coil::Coil;
use super::error::RigError;
use slipline_plate::Finger;
use slipline_plate::calibrate::{SensorBody, SensorKind};
use slipline_plate::check::LINEAR_SHARE;
use slipline_plate::quantity::OutOfRange;

/// The ranges of the options.
pub mod limits {
    use slipline_plate::quantity::Range;

    /// Sensor value at the end of the input's range, in the sensor's unit.
    pub const FULL_SCALE: Range = Range::new(1e-15, 1e12, "");
    /// Delay of a sensor and its amplifier.
    pub const SENSOR_DELAY: Range = Range::new(0.0, 1e-3, "s");
    /// RMS noise of an input, in codes.
    pub const NOISE: Range = Range::new(0.0, 100.0, "LSB");
    /// Bandwidth of the amplifier.
    pub const AMPLIFIER: Range = Range::new(1e3, 150e3, "Hz");
}

/// Place and properties of the sensor. The default is a healthy rig.
#[derive(Debug, Clone, PartialEq)]
pub struct RigOptions {
    /// The sensor's place on the centre line, metres from the driven end (0 to the plate's length).
    pub place_m: f64,
    /// The quantity to which the sensor's signal is proportional.
    pub sensor: SensorKind,
    /// Sensor value at the end of the input's range, in metres, m/s, m/s^2 or strain (1e-15 to 1e12). `None`
    /// leaves 12 dB of headroom above a tone of the table at level 1.
    pub full_scale: Option<f64>,
    /// Delay of the sensor and its amplifier, seconds (0 to 1 ms). The device does not know it.
    pub sensor_delay_s: f64,
    /// RMS noise of each input, in codes (0 to 100). Noise of half a code or more linearizes the averages of
    /// an input; without noise the steps of 12 bits remain.
    pub noise_lsb: f64,
    /// Seed of the noise: the same seed gives the same noise.
    pub seed: u64,
    /// A finger that rests on the plate.
    pub finger: Option<Finger>,
    /// What the sensor weighs; none while a finger rests on the plate.
    pub body: Option<SensorBody>,
    /// A coil that adds harmonics; `None` is a linear one.
    pub coil: Option<Coil>,
    /// Bandwidth of the amplifier, a low-pass of second order, Hz (1e3 to 150e3); `None` is one that passes every frequency, and no
    /// image of a tone.
    pub amplifier_hz: Option<f64>,
    /// Share of full scale within which the output of the device's DAC is linear, 0.1 to 1: it flattens what is louder.
    pub linear_share: f64,
}

impl Default for RigOptions {
    fn default() -> Self {
        Self {
            place_m: 0.0,
            sensor: SensorKind::Displacement,
            full_scale: None,
            sensor_delay_s: 0.0,
            noise_lsb: 0.7,
            seed: 1,
            finger: None,
            body: None,
            coil: None,
            amplifier_hz: None,
            linear_share: 1.0,
        }
    }
}

impl RigOptions {
    /// Refuses values that are out of range for any plate.
    pub(super) fn check(&self) -> Result<(), RigError> {
        if let Some(full_scale) = self.full_scale {
            OutOfRange::check("sensor full scale", full_scale, limits::FULL_SCALE)?;
        }
        OutOfRange::check("sensor delay", self.sensor_delay_s, limits::SENSOR_DELAY)?;
        OutOfRange::check("noise", self.noise_lsb, limits::NOISE)?;
        OutOfRange::check("linear share", self.linear_share, LINEAR_SHARE)?;
        if let Some(bandwidth_hz) = self.amplifier_hz {
            OutOfRange::check("bandwidth of the amplifier", bandwidth_hz, limits::AMPLIFIER)?;
        }
        if let Some(coil) = &self.coil {
            coil.check()?;
        }
        if let Some(body) = self.body {
            SensorBody::new(body.mass_kg, body.width_m)?;
            if self.finger.is_some() {
                return Err(RigError::FingerAndBody);
            }
        }
        Ok(())
    }
}
