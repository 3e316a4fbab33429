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
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `definition/`: kind of wave, material and edge (`definition/model.rs`), taper (`definition/taper.rs`), presets,
//!   and the plate file: each field is one row in `definition/fields/`, which `definition/file/` reads and writes.
//!   `PLATES.md`. Tests: `host/plate/tests/plate_files/`
//! - `frequency/`: the steady amplitude: the equation (`frequency/numerov/`), the driven end (`frequency/driven_end/`),
//!   a finger (`frequency/finger/`). Tests: `host/plate/tests/exact.rs`, `host/plate/tests/drive_end.rs`,
//!   `host/plate/tests/finger.rs`
//! - `time/`: the plate in time by modes (`time/fit/`), and a sensor's samples (`time/sensed/`). Tests:
//!   `host/plate/tests/time_line.rs`
//! - `sheet/`, `plane/`: the plate in two dimensions, in time and at one frequency. Tests:
//!   `host/plate/tests/physics.rs`
//! - `table/`: the turning-point table, and its error on another plate. Tests: `host/plate/tests/even_level.rs`
//! - `texture/`: tones whose fields fit a wanted texture; phases with a small peak (`texture/crest.rs`), multiples of a
//!   base frequency (`texture/on_grid.rs`). Tests: `host/plate/tests/texture.rs`
//! - `calibrate/`: a plate file from measurements (`calibrate/measurement/`: `SensorKind`, files; `calibrate/fit/`: the
//!   fit, `calibrate/fit/response/`: what a sensor responds to; `calibrate/placement/`: where to put sensors) or from
//!   felt edges (`calibrate/felt/`). Tests: `host/plate/tests/calibration/`
//! - `check/`: validity lights: subjects in `check/lights/`, limits with their reasons in `check/thresholds.rs`
//! - `design/`: the designer and its cut files
//! - `feeling.rs`, `merit.rs`: what a finger feels, and figures of merit of a boundary. Tests:
//!   `host/plate/tests/merit.rs`
//! - `second_boundary.rs`, `intermodulation.rs`: the boundaries of a drive's harmonics, and the products of several tones.
//!   Tests: `host/plate/tests/harmonics.rs`
//! - `quantity/`: units; how numbers are read, printed and refused. Tests: `tests/tests/wording.rs`
//! - `paper/`, `physics/`: the figures of the paper and of `PHYSICS.md`. Tests: `host/plate/tests/paper.rs`,
//!   `host/plate/tests/physics_page.rs`
//! - `special/`, `fused.rs`: special functions, and products rounded once
//! - `text_table/`: tables of other programs: cells, the words and units of columns, numbers. Tests:
//!   `host/plate/tests/cases/`, `host/tests/cli/foreign.rs`
//! - `exchange.rs`, `static_text.rs`: plates and errors that pass between the workers of a page
//! - `progress.rs`, `truth.rs`, `order.rs`: progress of a long computation, random plates near a nominal one, and the order of
//!   short lists

#![forbid(unsafe_code)]
// The crate is part of the browser build; clippy.toml lists the functions that a browser does not have.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]
pub mod calibrate;
pub mod check;
mod definition;
pub mod design;
pub mod exchange;
pub mod feeling;
mod frequency;
mod fused;
pub mod intermodulation;
pub mod merit;
pub mod order;
pub mod paper;
pub mod physics;
pub mod plane;
mod progress;
pub mod quantity;
pub mod second_boundary;
mod sheet;
mod special;
pub mod static_text;
mod table;
pub mod text_table;
pub mod texture;
mod time;
pub mod truth;

pub use definition::{
    Actuator, Air, AirMounting, Bending, Calibration, Companion, Consequence, DriveEnd, EndSlope, Faces,
    Film, Frame, Gas, Harmonics, Impedance, LeadIn, Model, Origin, PLATE_FILE_BYTES_MAX, Plate, PlateError,
    PlateFile, PlateFileError, PlateSpec, Preset, Resonator, ResponseCurve, SampleRateError, Source, Taper,
    Thickness, Travel, TurningWidth, fields, limits, preset, presets, sample_rates,
};
pub use frequency::{
    Equation, Finger, POINTS_MAX, POINTS_MIN, Peak, PredictedEnvelope, RespondError, Responder, Response,
    ToneDrive, predict_envelope, reflection, resistance_reflection, respond, respond_batch, respond_range,
    respond_touched,
};
pub use num_complex::Complex64;
pub use progress::{Progress, Stopped};
pub use sheet::{Cost, DriveShape, EnvelopeScope, FdtdGrid, Sheet, SheetEnvelope, SheetError, SheetGrid};
pub use special::airy;
pub use table::{
    Boundary, DriveTable, KNOTS_MAX, Knot, Level, NoBoundary, Sensitivity, TableError, TableTravel,
    boundaries, sensitivity_per_percent, table_sensitivity,
};
pub use time::{
    DriveCurveError, Envelope, LINE_POINTS, LineError, Output, Resonators, SenseError, SensedPlate,
    TimeDomainLine,
};

/// A text that is part of the program, such as the name of a field. serde's derive would borrow a field of type `&str` from its
/// input; it does not recognise this alias as a reference.
pub type StaticText = &'static str;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
