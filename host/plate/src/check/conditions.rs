//! What a plate is used with, as far as the checks ask.

use super::error::{CheckError, on_plate};
use crate::quantity::{OutOfRange, Range};
use crate::spec::plate::Plate;

/// What the plate is used with.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditions {
    /// The device's sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Level of the tone, 0 to 1 of the turning-point table's full scale.
    pub level: f64,
    /// Whether the drive sits beside the centre line, which lets the second width mode in.
    pub off_centre: bool,
    /// Boundaries of the other tones that sound at the same time, metres.
    pub other_boundaries_m: Vec<f64>,
}

impl Default for Conditions {
    fn default() -> Self {
        Self { sample_rate_hz: 400e3, level: 1.0, off_centre: false, other_boundaries_m: Vec::new() }
    }
}

impl Conditions {
    pub(super) fn validate(&self, plate: &Plate) -> Result<(), CheckError> {
        OutOfRange::check("level", self.level, Range::new(0.0, 1.0, "")).map_err(CheckError::Level)?;
        for &boundary_m in &self.other_boundaries_m {
            on_plate(plate, "other boundary", boundary_m)?;
        }
        Ok(())
    }
}
