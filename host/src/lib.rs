//! Slipline's host side: the link to a device, the simulated device, the command line and the app.
//!
//! ```text
//! app, cli --Request--> link::worker == bytes ==> device (real, emulated or link::simulated)
//!    ^                       |
//!    +------ Snapshot <------+--> journal --> mirror (the same renderer) --> samples --> slipline_plate
//! ```
//! The app needs the feature `gui`; everything else builds without it.

pub mod chain;
pub mod cli;
pub mod envelope_plot;
pub mod figures;
pub mod link;
pub mod mirror;
pub mod quantity;
pub mod simulation;
pub mod table;
