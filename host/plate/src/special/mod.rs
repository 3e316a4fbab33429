//! Special functions: Airy's Ai, Gauss quadrature, sinc.

pub mod airy;
pub(crate) mod gauss;
pub(crate) mod ramp;
pub(crate) mod sinc;
