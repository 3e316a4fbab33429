//! The plate at one frequency: the amplitude over x, and its peak.

pub mod clamped;
mod coupled;
pub(crate) mod numerov;
pub(crate) mod peak;
pub(crate) mod respond;
pub(crate) mod sweep;

pub use coupled::{COUPLED_MODES_MAX, COUPLED_POINTS_MAX, CoupledResponse, respond_coupled};
pub use peak::Peak;
pub use respond::{
    Equation, POINTS_MAX, POINTS_MIN, RespondError, Response, respond, respond_batch, respond_range,
};
