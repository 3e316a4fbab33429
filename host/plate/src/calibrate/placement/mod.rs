//! Places of the two sensors of a calibration, proposed from the nominal plate.
//!
//! ```text
//! near_limit: end of the near field -> plan: pairs of places beyond it -> information: accuracy of each pair
//! ```

mod information;
mod near_limit;
pub(crate) mod plan;

pub use near_limit::NearLimit;
pub use plan::{PairReach, PlaceWarning, Placing, SensorPlaces};
