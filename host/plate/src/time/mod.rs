//! The plate in the time domain: its first width mode, driven by DAC codes at the device's sample rate.
//!
//! ```text
//! frequency domain -> fit (any field) -> modal (poles, residues) -> integration -> line -> envelope
//!                              DAC codes -> analytic_signal -> drive_filter (curves) -^
//! frequency domain -> fit -> sensed (one place, one value per code)
//! ```

mod analytic_signal;
mod band_plan;
mod drive_curve;
mod drive_filter;
mod envelope;
mod fit;
mod integration;
mod kernel;
mod line;
mod modal;
mod sensed;
mod toeplitz;

pub(crate) use analytic_signal::{AnalyticDrive, BSPLINE};
pub(crate) use band_plan::BandPlan;
pub(crate) use drive_curve::DriveCurve;
pub use drive_filter::DriveCurveError;
pub(crate) use drive_filter::DriveFilter;
pub use envelope::Envelope;
pub use line::{LINE_POINTS, LineError, TimeDomainLine};
pub use sensed::{Output, Resonators, SenseError, SensedPlate};
