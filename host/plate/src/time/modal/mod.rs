//! The plate, its driven end and its actuator as a bank of independent complex oscillators.
//!
//! z' = -j p z + b u, field = sum of shape z + what follows the drive at once. The time convention is e^(-j omega t)
//! with omega > 0 only (an analytic signal), so hysteretic loss, which has no real time-domain form, is exact in
//! bending and exact at each resonance for a membrane.

mod bank;
mod build;
mod coupling;

pub(super) use bank::{Input, ModalBank};
pub(super) use build::build;
