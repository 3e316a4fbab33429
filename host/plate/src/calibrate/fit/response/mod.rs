//! Responses of a plate of given numbers: the wave at sensors and at the peak, and the response to a source. Nothing is
//! compared with a measurement here.

pub(crate) mod plate_response;
pub(crate) mod prediction;
pub(crate) mod wave;
