//! The conditions of use that the checks depend on.

use super::error::{CheckError, on_plate};
use crate::definition::plate::Plate;
use crate::quantity::{OutOfRange, Range};

/// The conditions under which a plate is checked.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Conditions {
    /// The device's sample rate, Hz (see [`crate::sample_rates`]; 400 000 by default).
    pub sample_rate_hz: f64,
    /// Level of the tone, 0 to 1 of the turning-point table's full scale (1 by default).
    pub level: f64,
    /// Whether the drive is off the centre line, where it also excites the second width mode.
    pub off_centre: bool,
    /// Share of full scale within which the output of the device's DAC is linear, 0.1 to 1 (1 by default, as of a simulated device).
    pub linear_share: f64,
    /// Boundaries of the other tones played at the same time, metres (0.001 to 1 of the plate's length).
    pub other_boundaries_m: Vec<f64>,
}

/// Linear shares of a DAC's output.
pub const LINEAR_SHARE: Range = Range::new(0.1, 1.0, "");

impl Default for Conditions {
    fn default() -> Self {
        Self {
            sample_rate_hz: 400e3,
            level: 1.0,
            off_centre: false,
            linear_share: 1.0,
            other_boundaries_m: Vec::new(),
        }
    }
}

impl Conditions {
    pub(super) fn validate(&self, plate: &Plate) -> Result<(), CheckError> {
        OutOfRange::check("level", self.level, Range::new(0.0, 1.0, "")).map_err(CheckError::Level)?;
        OutOfRange::check("linear share", self.linear_share, LINEAR_SHARE).map_err(CheckError::Level)?;
        for &boundary_m in &self.other_boundaries_m {
            on_plate(plate, "other boundary", boundary_m)?;
        }
        Ok(())
    }
}
