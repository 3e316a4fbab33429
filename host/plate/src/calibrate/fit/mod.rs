//! Fits of a plate, and of its source, to measured responses; their acceptance, and the plate files with intervals that
//! follow. What a finger feels is in [`super::felt`].
//!
//! ```text
//! checked: two_places, twice
//! two_places -> ratio ------+-> search -> acceptance -> spread -> gain (gaussian_process) -> result
//! one_sensor -> joint_fit --+
//! shunt ------> joint_fit --+
//! speed_trim: one_sensor at first, then phases
//! ```

pub(crate) mod acceptance;
pub(crate) mod calipers;
pub(crate) mod checked;
pub(crate) mod comparison;
pub(crate) mod departure;
pub(crate) mod gain;
pub(crate) mod gaussian_process;
pub(crate) mod joint_fit;
pub(crate) mod least_squares;
pub(crate) mod linear_least_squares;
pub(crate) mod misfit;
pub(crate) mod missing_air;
pub(crate) mod one_sensor;
pub(crate) mod pairs;
pub(crate) mod parameter;
pub(crate) mod ratio;
pub(crate) mod response;
pub(crate) mod result;
pub(crate) mod search;
pub(crate) mod sensor_load;
pub(crate) mod shunt;
pub(crate) mod source;
pub(crate) mod speed_trim;
pub(crate) mod spread;
pub(crate) mod two_places;
pub(crate) mod unknowns;
