//! Calibration: a plate file from responses measured on the plate. PHYSICS.md, section 9, has the equations.
//!
//! ```text
//! files: own CSV, tables, .frd, universal -> measurement::foreign::File
//!        v
//! Measurement at two places -> pairs -> ratio: scan over wave speed and loss, then least squares -> acceptance
//!       nominal plate, Priors (Calipers) -^                                        |
//!                    Calibrated: plate file <- gain carried to the peak <----------+
//! Measurement at one place, or of the current -> joint (plate and source): scan, linear for each plate (source), then
//!                                             least squares ---^
//! felt edges -> touches: samples of all plates and drives that fit -> their mean
//! a calibrated plate and a Measurement at one place -> speed_trim: its wave speed now -> phases of a few tones -> later
//! ```
//!
//! `placement/` proposes the sensors' places, `measurement/` holds the data, `fit/` fits plates to them, `felt/` fits
//! plates to felt edges. Nothing here plays or records a tone: a [`Measurement`] comes from a device, a file or a
//! solver.

mod error;
mod felt;
mod fit;
mod measurement;
mod placement;

pub use error::CalibrateError;
pub use felt::touch::{Touch, TouchedDrive};
pub use felt::touches::{Touched, from_touches};
pub use fit::acceptance::check_places;
pub use fit::calipers::Calipers;
pub use fit::checked::from_checked_ratio;
pub use fit::comparison::Comparison;
pub use fit::departure::{Departure, departure};
pub use fit::one_sensor::{check_source, from_one_sensor};
pub use fit::parameter::Parameter;
pub use fit::response::prediction::predicted;
pub use fit::response::sensor_body::SensorMasses;
pub(crate) use fit::response::wave::seen;
pub use fit::result::Calibrated;
pub use fit::shunt::from_shunt;
pub use fit::source::drive_current::Transducer;
pub use fit::speed_trim::{SpeedTrim, Trimmed};
pub use fit::two_places::from_ratio;
pub use fit::unknowns::Priors;
pub use measurement::averaging::{WINDOWS_MAX, windows};
pub use measurement::band::band_hz;
pub use measurement::csv::CsvError;
pub use measurement::drive_check::{DriveCheck, DriveCircuit, DriveLoad, check_drive, drive_check_hz};
pub use measurement::foreign::{File, FileError, Foreign, ForeignPoint, ForeignRead, SNR, SNR_DB};
pub use measurement::sensor::{
    MeasuredPoint, Measurement, POINTS, SENSOR_MASS, SENSOR_WIDTH, SensorBody, SensorKind,
};
pub use placement::{CheckPlace, NearLimit, PairReach, PlaceWarning, Placing, SensorPlaces};
