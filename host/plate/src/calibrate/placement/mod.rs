//! Places of the two sensors of a calibration, proposed from the nominal plate.
//!
//! ```text
//! near_limit: where one wave alone is left -> plan: pairs of places beyond it -> information: what each pair would reach
//! ```

mod information;
mod near_limit;
pub(crate) mod plan;

pub use near_limit::NearLimit;
pub use plan::{PairReach, PlaceWarning, Placing, SensorPlaces};
