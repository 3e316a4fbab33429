//! Waves in tapered plates: turning points, amplitudes, drive tables, and the plate in time.
//!
//! ```text
//! plate file -> PlateSpec -> Plate -+-> turning point, edge, kappa          (turning)
//!                                   +-> respond: amplitude over x           (numerov, fourth order)
//!                                   +-> DriveTable: place -> step and gain  (inverse of DAC to peak)
//! DAC codes ------------------------+-> TimeLine -> Envelope                (oscillators, exact steps)
//! ```
//!
//! SI units throughout. x = 0 is the driven, wide end. Time goes as e^(-j omega t), so a wave into the plate is
//! e^(+j k x) and loss is K^2 -> K^2 (1 + j eta). The crate knows no protocol, no window and no device.

#![forbid(unsafe_code)]
pub mod airy;
mod analytic;
pub mod bessel;
pub mod check;
pub mod clamped;
mod coupled;
pub mod design;
mod drive;
mod drive_table;
mod envelope;
mod error;
mod galerkin;
mod kernel;
mod model;
pub mod numeral;
mod numerov;
mod oscillators;
pub mod paper;
mod peak;
mod plate;
mod plate_file;
mod presets;
mod progress;
pub mod range;
mod respond;
mod sample_rate;
pub mod sensation;
mod sensitivity;
mod sentence;
pub mod sheet;
mod suggestion;
mod sweep;
mod taper;
mod time_line;
mod turning;

pub use coupled::{COUPLED_MODES_MAX, COUPLED_POINTS_MAX, CoupledResponse, respond_coupled};
pub use drive::{Actuator, DriveEnd};
pub use drive_table::{DriveTable, KNOTS_MAX, Knot, Level, TableError};
pub use envelope::{Envelope, PredictedEnvelope, ToneDrive, predict_envelope};
pub use error::{Consequence, Origin, PlateError, PlateFileError};
pub use model::{Bending, Model};
pub use num_complex::Complex64;
pub use peak::Peak;
pub use plate::{BAND_RATIO_MAX, Plate, PlateSpec, WAVELENGTHS_MAX};
pub use plate_file::PLATE_FILE_BYTES_MAX;
pub use presets::{Preset, preset, presets};
pub use progress::{Progress, Stopped};
pub use respond::{
    Equation, POINTS_MAX, POINTS_MIN, RespondError, Response, respond, respond_batch, respond_range,
};
pub use sample_rate::{SampleRateError, sample_rates};
pub use sensitivity::{
    Sensitivity, sensitivity, sensitivity_per_percent, sensitivity_per_percent_of,
    sensitivity_per_percent_watched, table_sensitivity,
};
pub use sentence::Notation;
pub use sheet::{Sheet, SheetError, SheetGrid};
pub use suggestion::nearest;
pub use taper::Taper;
pub use time_line::{LINE_POINTS, LineError, TimeLine, WIDTH_MODE_MAX};
