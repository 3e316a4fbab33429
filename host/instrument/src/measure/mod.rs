//! Measurement of a plate with the device's own inputs: choice of tones, levels and times, and evaluation.
//!
//! ```text
//! Plate, Wanted --Plan------> combs --Measuring--> requests to the link
//!                                         ^--------- outcomes
//!                              Window of each comb --answers--> Measured (Measurement, headroom, warnings)
//! Plate, Wanted --SweepPlan-> one gliding tone --Sweeping--> Measured
//!                --PlayedSweep-> two of them ---Playing--> a recorder's WAV file --HeardSweep--> responses
//! Plate, circuit -----------> quiet comb --DriveChecking--> whether the drive is on --AfterCheck--> Measuring
//! Plate, level ---------------> combs of f, 2f, 3f --MeasuringHarmonics--> harmonics of the drive, for a plate file
//! Plate ---------------------> windows of codes --Verifying--> whether they are the mirror's
//! ```
//! Each is a [`Procedure`] without a clock and a port, so the command line, the app and the tests [`Run`] the
//! same steps.

mod after_check;
mod answers;
pub mod circuit;
mod codes;
mod dialogue;
mod drive_checking;
mod error;
mod harmonics;
mod images;
mod loudness;
mod mains;
mod measuring;
mod plan;
mod procedure;
mod prompt;
mod remaining;
mod setback;
mod signal;
mod sweep;
mod verifying;

pub use after_check::AfterCheck;
pub use answers::{Measured, Sensor, Warning};
pub use dialogue::Dialogue;
pub(crate) use drive_checking::CURRENT_INPUT;
pub use drive_checking::{CheckedDrive, DriveChecking, KnownDrive, current_sensor};
pub use error::MeasureError;
pub use harmonics::{HARMONIC_POINTS, HarmonicsPlan, MeasuredHarmonics, MeasuringHarmonics};
pub(crate) use images::images;
pub use images::{BANDWIDTH, Bandwidths};
pub use measuring::Measuring;
pub use plan::{Comb, LEVEL, POINTS, Plan, SETTLED, Wanted};
pub(crate) use procedure::{Evaluation, evaluated};
pub use procedure::{NextStep, Procedure, Run};
pub use prompt::Prompt;
pub(crate) use remaining::remaining_samples;
pub(crate) use setback::{ended_by, is_late};
pub use signal::Signal;
pub use sweep::{
    Chirp, HeardError, HeardSweep, PLAYED_BYTES_MAX, PlayedFileError, PlayedSweep, Playing, QUIETER, SWEEP_S,
    SweepPlan, Sweeping,
};
pub use verifying::{Verified, VerifiedWindow, Verifying, verify_windows_s};
