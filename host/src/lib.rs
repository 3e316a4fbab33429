//! Slipline's command line, called by its main function.
//!
//! ```text
//! main --> cli --> one module for each subcommand --> slipline_model, slipline_link, slipline_plate
//!     \--> slipline_window (with the feature `gui`)
//! ```
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `cli/`: one file for each subcommand, its arguments included. Tests: `host/tests/cli/`
//! - `cli/page/`: how `slipline page` serves the page. Tests: `host/tests/cli/page.rs`
//! - `cli/selftest/`: the date of a self-test's report, and a report read again. Tests: `host/tests/cli/selftest.rs`
//! - `signals.rs`: how a signal ends the program. Tests: `host/tests/cli/signals.rs`
//! - `trace.rs`: `RUST_LOG`. Tests: `host/tests/cli/trace.rs`

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::expect_used, clippy::unwrap_used))]
// A new error, request or outcome must be handled wherever these are matched.
#![warn(clippy::wildcard_enum_match_arm)]

pub mod cli;
pub mod signals;
pub mod trace;
