//! The definition of a plate: taper, model, driven end, actuator and span, as numbers or as the text of a plate file; their
//! ranges, and the laws of the width that follow from these numbers alone. Nothing here computes a response.

pub(crate) mod actuator;
pub(crate) mod air;
pub(crate) mod calibration;
pub(crate) mod clamped_strip;
pub(crate) mod drive;
pub(crate) mod error;
mod file;
pub(crate) mod film;
pub(crate) mod free_wave;
mod grading;
pub(crate) mod impedance;
pub mod limits;
pub(crate) mod model;
pub(crate) mod plate;
pub(crate) mod presets;
pub(crate) mod response_curve;
pub(crate) mod sample_rate;
pub(crate) mod source;
pub(crate) mod strip_table;
pub(crate) mod taper;
pub(crate) mod thickness;
pub(crate) mod travel;
mod turning;
pub(crate) mod turning_width;
mod wording;

pub use actuator::{Actuator, Resonator};
pub use air::{Air, AirMounting, BAFFLE, BARE_FRAME, Faces, Gas};
pub use calibration::Calibration;
pub use drive::DriveEnd;
pub use error::{Consequence, Origin, PlateError, PlateFileError};
pub use file::PLATE_FILE_BYTES_MAX;
pub use film::Film;
pub use impedance::Impedance;
pub use model::{Bending, Model};
pub use plate::{Plate, PlateSpec};
pub use presets::{Preset, preset, presets};
pub use response_curve::ResponseCurve;
pub use sample_rate::{SampleRateError, sample_rates};
pub use source::{EndSlope, LeadIn, Source};
pub use taper::Taper;
pub use thickness::Thickness;
pub use travel::Travel;
pub use turning_width::TurningWidth;
