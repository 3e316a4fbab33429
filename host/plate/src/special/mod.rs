//! Special functions: Airy's Ai, the modified Bessel function of imaginary order, Gauss quadrature, sinc.

pub mod airy;
pub mod bessel;
pub(crate) mod gauss;
pub(crate) mod sinc;
