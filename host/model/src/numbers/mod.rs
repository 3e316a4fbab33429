//! Numbers with units as people type and read them.

pub mod quantity;
pub mod ticks;
