//! Waves in tapered plates: turning points, amplitudes, drive tables, and the plate in time.
//!
//! ```text
//! plate file -> PlateSpec -> Plate -+-> turning point, edge, kappa          (turning)
//!                                   +-> respond: amplitude over x           (numerov, fourth order)
//!                                   +-> DriveTable: place -> step and gain  (inverse of DAC to peak)
//! DAC codes ------------------------+-> TimeDomainLine -> Envelope          (modal oscillators, exact steps)
//! ```
//!
//! SI units throughout. x = 0 is the driven, wide end. The time factor is e^(-j omega t), so a wave into the plate is
//! e^(+j k x), and loss is K^2 -> K^2 (1 + j eta). The crate contains no protocol, no window and no device.
//!
//! Rooms, from below:
//! - numbers: `quantity` as users type and read them, `special` functions, `text_table` and `exchange` their texts;
//! - the plate: `definition` from a text to a checked plate, `design` from a wish to a plate, `truth` a random one near a nominal;
//! - its waves: `frequency` along the middle line at one frequency, `plane` over the plate, `time` and `sheet` both in time;
//! - its use: `table` from a place to frequency and gain, `texture` several tones, `feeling` and `merit` what a finger has of it;
//! - against the real one: `calibrate` from measurements to a plate, `check` the limits of the model ("lights");
//! - `paper` and `physics`: the figures of the pages.

#![forbid(unsafe_code)]
// The crate is part of the browser build; clippy.toml lists the functions that a browser does not have.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]
pub mod calibrate;
pub mod check;
pub mod definition;
pub mod design;
pub mod exchange;
pub mod feeling;
pub mod frequency;
mod fused;
pub mod merit;
pub mod paper;
pub mod physics;
pub mod plane;
mod progress;
pub mod quantity;
pub mod sheet;
pub mod special;
pub mod static_text;
pub mod table;
pub mod text_table;
pub mod texture;
pub mod time;
pub mod truth;

pub use check::sensation;
pub use definition::{
    Actuator, Air, AirMounting, Bending, Calibration, Consequence, DriveEnd, EndSlope, Faces, Film, Gas,
    Impedance, LeadIn, Model, Origin, PLATE_FILE_BYTES_MAX, Plate, PlateError, PlateFile, PlateFileError,
    PlateSpec, Preset, Resonator, ResponseCurve, SampleRateError, Source, Taper, Thickness, Travel,
    TurningWidth, fields, limits, preset, presets, sample_rates,
};
pub use frequency::{
    CONTACT_M, Equation, Finger, POINTS_MAX, POINTS_MIN, Peak, PredictedEnvelope, RespondError, Responder,
    Response, ToneDrive, predict_envelope, reflection, resistance_reflection, respond, respond_batch,
    respond_range, respond_touched,
};
pub use num_complex::Complex64;
pub use progress::{Progress, Stopped};
pub use quantity::{Notation, nearest, number_format};
pub use sheet::{Sheet, SheetError, SheetGrid};
pub use special::airy;
pub use table::{
    Boundary, DriveTable, KNOTS_MAX, Knot, Level, NoBoundary, Sensitivity, TableError, TableTravel,
    boundaries, sensitivity_per_percent, table_sensitivity,
};
pub use time::{
    DriveCurveError, Envelope, LINE_POINTS, LineError, Output, Resonators, SenseError, SensedPlate,
    TimeDomainLine,
};

/// A text that is part of the program, such as the name of a field. Under this name serde does not borrow it.
pub type StaticText = &'static str;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
