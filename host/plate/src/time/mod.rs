//! The plate in the time domain: one width mode, driven by DAC codes at the device's sample rate.
//!
//! ```text
//! galerkin -> modal (eigenfunctions of a thin plate) --+-> poles, residues -> integration -> line -> envelope
//! frequency domain -> fit (whatever the field is) -----+                                      ^
//!                                                      DAC codes -> analytic_signal ----------+
//! frequency domain -> fit -> sensed (one place, one value per code)
//! ```

mod analytic_signal;
mod envelope;
mod fit;
mod galerkin;
mod integration;
mod kernel;
mod line;
mod modal;
mod sensed;

pub use envelope::Envelope;
pub use line::{LINE_POINTS, LineError, TimeDomainLine, WIDTH_MODE_MAX};
pub use sensed::{Output, Resonators, SenseError, SensedPlate};
