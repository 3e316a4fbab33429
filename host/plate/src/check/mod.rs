//! Validity lights: whether the model holds for a plate and a boundary, and whether the boundary can be felt and
//! driven.
//!
//! ```text
//! Plate + Conditions -> Checker -> at(boundary) or over_span() -> Report { lights }
//!   lights/shape.rs  edge slope, edge curvature, wavelengths, edge width, ghost boundaries
//!   lights/wave.rs   loss, peak
//!   lights/thickness.rs  thin plate
//!   lights/touch.rs  width, finger load
//!   lights/drive.rs  drive match
//!   lights/sensitivity.rs  sensitivity
//!   lights/actuator.rs  actuator band, excursion, DAC resolution
//!   lights/linear_output.rs  linear output, where the DAC's output is not linear up to full scale
//!   lights/sound.rs  sound level, beat
//!   lights/air.rs    air, with air_law.rs
//!   lights/felt_edge.rs  felt edge
//!   lights/distortion.rs  distortion, where the file states harmonics
//!   lights/drift.rs  drift, press
//!   lights/frame.rs  frame
//! ```
//! Every limit is a named constant in [`thresholds`], with its reason.

mod air_law;
mod checker;
mod conditions;
mod error;
mod grading;
mod interval;
mod levels;
mod lights;
mod over_interval;
mod prepared;
mod report;
pub mod sensation;
mod stretch;
#[cfg(test)]
mod tests;
pub mod thresholds;

pub use checker::Checker;
pub use conditions::{Conditions, LINEAR_SHARE};
pub use error::CheckError;
pub(crate) use lights::shape::wavelengths;
pub(crate) use lights::wave::loss_integral;
pub use report::{Colour, Light, Limit, Report};
pub use stretch::Stretch;
