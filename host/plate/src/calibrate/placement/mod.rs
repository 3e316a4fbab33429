//! Places of the two sensors of a calibration, proposed from the nominal plate.
//!
//! ```text
//! near_limit: end of the near field -> plan: pairs of places beyond it -> information: accuracy of each pair
//!                                         -> check: a third place that checks the best pair
//! ```

mod check;
mod information;
pub(crate) mod near_limit;
pub(crate) mod plan;
mod warning;

pub use check::CheckPlace;
pub use near_limit::NearLimit;
pub use plan::{PairReach, Placing, SensorPlaces};
pub use warning::PlaceWarning;
