//! The plate in time: one width mode, driven by DAC codes at the device's sample rate.

pub(crate) mod analytic;
pub(crate) mod envelope;
pub(crate) mod galerkin;
mod integration;
pub(crate) mod kernel;
mod line;
pub(crate) mod oscillators;

pub use envelope::{Envelope, PredictedEnvelope, ToneDrive, predict_envelope};
pub use line::{LINE_POINTS, LineError, TimeLine, WIDTH_MODE_MAX};
