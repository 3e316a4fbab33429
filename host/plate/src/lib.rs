//! Waves in tapered plates.
#![forbid(unsafe_code)]
pub mod airy;
mod drive;
mod drive_table;
mod error;
mod model;
mod numerov;
mod peak;
mod plate;
mod plate_file;
mod presets;
mod respond;
mod sensitivity;
mod taper;
mod turning;

pub use drive::{Actuator, DriveEnd};
pub use drive_table::{DriveTable, FREQUENCY_TO_RATE_MAX, KNOTS_MAX, Knot, Level, TableError};
pub use error::{PlateError, PlateFileError};
pub use model::{Bending, Model};
pub use num_complex::Complex64;
pub use peak::Peak;
pub use plate::{FREQUENCY_RANGE_HZ, Plate, PlateSpec, WAVELENGTHS_MAX};
pub use plate_file::PLATE_FILE_BYTES_MAX;
pub use presets::{Preset, preset, presets};
pub use respond::{Equation, POINTS_MAX, POINTS_MIN, RespondError, Response, respond, respond_batch};
pub use sensitivity::{Sensitivity, sensitivity, sensitivity_per_percent, table_sensitivity};
pub use taper::{HALF_WIDTH_MAX_M, HALF_WIDTH_MIN_M, TAPER_POINTS_MAX, Taper};
