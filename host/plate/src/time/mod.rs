//! The plate in the time domain: one width mode, driven by DAC codes at the device's sample rate.

mod analytic_signal;
mod envelope;
mod galerkin;
mod integration;
mod kernel;
mod line;
mod modal;

pub use envelope::Envelope;
pub use line::{LINE_POINTS, LineError, TimeDomainLine, WIDTH_MODE_MAX};
