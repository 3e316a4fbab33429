//! How a rig is put together.

use super::error::RigError;
use slipline_plate::Finger;
use slipline_plate::calibrate::SensorKind;
use slipline_plate::quantity::OutOfRange;

/// The ranges of the options.
pub mod limits {
    use slipline_plate::quantity::Range;

    /// What the end of the input's range stands for, in the sensor's unit.
    pub const FULL_SCALE: Range = Range::new(1e-15, 1e12, "");
    /// How late a sensor and its amplifier are.
    pub const SENSOR_DELAY: Range = Range::new(0.0, 1e-3, "s");
    /// RMS of the noise at an input, in codes.
    pub const NOISE: Range = Range::new(0.0, 100.0, "LSB");
}

/// A rig: where the sensor stands and what it is. The default is a healthy one.
#[derive(Debug, Clone, PartialEq)]
pub struct RigOptions {
    /// The sensor's place on the centre line, metres from the driven end (0 to the plate's length).
    pub place_m: f64,
    /// What the sensor's signal is proportional to.
    pub sensor: SensorKind,
    /// What the end of the input's range stands for: metres, m/s, m/s^2 or strain (1e-15 to 1e12). `None` leaves 12 dB
    /// over what a tone of the table reaches at level 1.
    pub full_scale: Option<f64>,
    /// How late the sensor and its amplifier are, seconds (0 to 1 ms). The device does not know it.
    pub sensor_delay_s: f64,
    /// RMS of the noise at each input, in codes (0 to 100). Half a code or more makes an input as linear as its mean is
    /// long; without noise the steps of 12 bits stay.
    pub noise_lsb: f64,
    /// Seed of the noise: the same seed gives the same noise.
    pub seed: u64,
    /// A finger that rests on the plate.
    pub finger: Option<Finger>,
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
        }
    }
}

impl RigOptions {
    /// Refuses what is out of range on any plate.
    pub(super) fn check(&self) -> Result<(), RigError> {
        if let Some(full_scale) = self.full_scale {
            OutOfRange::check("sensor full scale", full_scale, limits::FULL_SCALE)?;
        }
        OutOfRange::check("sensor delay", self.sensor_delay_s, limits::SENSOR_DELAY)?;
        OutOfRange::check("noise", self.noise_lsb, limits::NOISE)?;
        Ok(())
    }
}
