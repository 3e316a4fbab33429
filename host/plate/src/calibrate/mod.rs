//! Calibration: a plate file from what sensors on the plate measured.
//!
//! Nothing here plays or records a tone: a [`Measurement`] comes from a device, a file or a solver.

mod error;
mod measurement;

pub use error::CalibrateError;
pub use measurement::{MeasuredPoint, Measurement, PLACE_TOLERANCE, PLACE_TOLERANCE_M, POINTS, SensorKind};
