//! Calibration: a plate file from what sensors on the plate measured. PHYSICS.md, section 9, has the equations.
//!
//! ```text
//! files: own CSV, tables, .frd, universal -> File
//!        v
//! Measurement at two places -> pairs -> ratio: scan over wave speed and loss, then least squares -> refusal
//!       nominal plate, Priors (Calipers) -^                                        |
//!                    Calibrated: plate file <- gain carried to the peak <----------+
//! Measurement at one place, or of the current -> joint (plate and source): scan, linear for each plate (sensed, drawn),
//!                                             then least squares ---^
//! felt edges -> touches: samples of all plates and drives that fit (importance) -> their mean (meant)
//! a calibrated plate and a Measurement at one place -> trim: its wave speed now -> phases of a few tones -> later
//! ```
//!
//! Nothing here plays or records a tone: a [`Measurement`] comes from a device, a file or a solver.

mod band;
mod calibrated;
mod calipers;
mod comparison;
mod csv;
mod departure;
mod drawn;
mod drive_check;
mod driven;
mod envelope;
mod error;
mod felt_plate;
mod foreign;
mod gain;
mod importance;
mod joint;
mod least_squares;
mod linear;
mod meant;
mod measurement;
mod one_sensor;
mod pairs;
mod predicted;
mod ratio;
mod refusal;
mod sensed;
mod shunt;
mod source_file;
mod spread;
mod touch;
mod touches;
mod trim;
mod unknowns;
mod wave;

pub use band::band_hz;
pub use calibrated::{Calibrated, Parameter, from_ratio};
pub use calipers::Calipers;
pub use comparison::Comparison;
pub use csv::CsvError;
pub use departure::{Departure, departure};
pub use drawn::Transducer;
pub use drive_check::{DriveCheck, DriveCircuit, DriveLoad, check_drive, drive_check_hz};
pub use error::CalibrateError;
pub use foreign::{File, FileError, Foreign, SNR, SNR_DB};
pub use measurement::{MeasuredPoint, Measurement, PLACE_TOLERANCE, PLACE_TOLERANCE_M, POINTS, SensorKind};
pub use one_sensor::from_one_sensor;
pub use predicted::predicted;
pub use shunt::from_shunt;
pub use touch::{Touch, TouchedDrive};
pub use touches::{Touched, from_touches};
pub use trim::{SpeedTrim, Trimmed};
pub use unknowns::Priors;
pub(crate) use wave::seen;
