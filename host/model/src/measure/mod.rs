//! Measuring a plate with the device's own inputs: which tones, how loud, for how long, and what the answers tell.
//!
//! ```text
//! Plate, Wanted --Plan--> combs --Measuring--> requests to the link
//!                                     ^--------- outcomes
//!                          Window of each comb --answers--> Measured (Measurement, headroom, warnings)
//! ```
//! [`Measuring`] knows no clock and no port: the command line, the app and the tests run the same steps.

mod answers;
mod error;
mod loudness;
mod measuring;
mod plan;
mod signal;

pub use answers::{Measured, Sensor, Warning};
pub use error::MeasureError;
pub use measuring::{Measuring, Step};
pub use plan::{Comb, LEVEL, POINTS, Plan, SETTLED, Wanted};
pub use signal::Signal;
