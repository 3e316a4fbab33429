//! Slipline's host side: the link to a device, the simulated device, the command line and the app.
//!
//! ```text
//! app, cli --Request--> link::worker == bytes ==> device (real, emulated or link::simulated)
//!    ^                       |
//!    +------ Snapshot <------+--> journal --> mirror (the same renderer) --> samples --> slipline_plate
//! ```
//! The app needs the feature `gui`; everything else builds without it.

#[cfg(feature = "gui")]
pub mod app;
#[cfg(feature = "gui")]
pub mod caption;
pub mod cli;
pub mod ending;
#[cfg(feature = "gui")]
pub mod files;
#[cfg(feature = "gui")]
pub mod plate_fault;
#[cfg(feature = "gui")]
pub mod scene;
#[cfg(feature = "gui")]
pub mod settings;
#[cfg(feature = "gui")]
pub mod view;
