//! Validity lights: how far a plate and a boundary can be believed, felt and driven.
//!
//! ```text
//! Plate + Conditions -> Checker -> at(boundary) or over_span() -> Report { lights }
//!   shape.rs  edge slope, edge curvature, wavelengths, edge width, ghost boundaries
//!   wave.rs   loss, peak, thin plate
//!   drive.rs  actuator band, drive match, sensitivity
//!   sound.rs  sound level, beat
//! ```
//! Every limit is a named constant in [`thresholds`], with its reason.

mod checker;
mod conditions;
mod drive;
mod error;
mod grading;
mod prepared;
mod report;
pub mod sensation;
mod shape;
mod sound;
#[cfg(test)]
mod tests;
pub mod thresholds;
mod wave;

pub use checker::Checker;
pub use conditions::Conditions;
pub use drive::drive_ratio;
pub use error::CheckError;
pub use prepared::SPAN_PLACES;
pub use report::{Colour, Light, Report};
pub use shape::{edge_curvature, edge_slope, wavelengths};
pub use sound::{a_weighting_db, plane_wave_level_db};
pub use wave::loss_integral;
