//! Responses of a plate with given parameters: the wave at sensors and at the peak, and the response to a source.
//! Comparisons with measurements are in the parent folder.

pub(crate) mod plate_response;
pub(crate) mod prediction;
pub(crate) mod sensor_body;
pub(crate) mod wave;
