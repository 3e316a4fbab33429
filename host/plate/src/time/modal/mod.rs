//! The plate, its driven end and its actuator as a bank of independent complex oscillators.
//!
//! z' = -j p z + j u, field = sum of shape z + direct u. Signals are analytic: e^(-j omega t) with omega > 0 only. So
//! the hysteretic loss K^2 (1 + j eta), which has no real equation in the time domain, is exact in bending; for a
//! membrane it is exact at each resonance.

mod bank;
mod build;
mod coupling;

pub(super) use bank::{Input, ModalBank, QuasiStatic};
pub(super) use build::{build, fits};
