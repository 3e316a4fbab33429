//! Special functions: Airy's Ai, and the modified Bessel function of imaginary order.

pub mod airy;
pub mod bessel;
