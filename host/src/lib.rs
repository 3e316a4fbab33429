//! Slipline's command line, called by its main function.
//!
//! ```text
//! main --> cli --> one module for each subcommand --> slipline_model, slipline_link, slipline_plate
//!     \--> slipline_window (with the feature `gui`)
//! ```
//! Rooms: `cli` one file for each subcommand, the arguments and outputs that several share beside them; `signals` the end by a
//! signal; `trace` the diagnostic output.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::expect_used, clippy::unwrap_used))]

pub mod cli;
pub mod signals;
pub mod trace;
