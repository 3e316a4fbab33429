//! Special functions: Airy's Ai, the modified Bessel function of imaginary order; and Gauss's rule.

pub mod airy;
pub mod bessel;
pub(crate) mod gauss;
