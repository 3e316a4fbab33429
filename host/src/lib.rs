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
#[cfg(feature = "gui")]
pub mod colour_map;
#[cfg(feature = "gui")]
pub mod designer;
#[cfg(feature = "gui")]
pub mod diagnostics;
mod disk;
pub mod edit;
pub mod ending;
pub mod envelope_plot;
#[cfg(feature = "gui")]
pub mod export;
pub mod figures;
#[cfg(feature = "gui")]
pub mod files;
pub mod history;
pub use slipline_link as link;
#[cfg(feature = "gui")]
pub mod live;
pub mod model;
#[cfg(feature = "gui")]
pub mod picture;
#[cfg(feature = "gui")]
pub mod pilot;
#[cfg(feature = "gui")]
pub mod plate_fault;
pub mod quantity;
#[cfg(feature = "gui")]
pub mod scene;
#[cfg(feature = "gui")]
pub mod settings;
pub mod setup_file;
#[cfg(feature = "gui")]
pub mod sheet;
pub mod simulation;
#[cfg(feature = "gui")]
pub mod spectrum;
#[cfg(feature = "gui")]
pub mod surface;
#[cfg(feature = "gui")]
pub mod table_making;
#[cfg(feature = "gui")]
pub mod ticks;
#[cfg(feature = "gui")]
pub mod trial;
#[cfg(feature = "gui")]
pub mod validity;
#[cfg(feature = "gui")]
pub mod view;
#[cfg(feature = "gui")]
pub mod workshop;
