//! The user's setup and its results, without a window and a device: the setup and its edits, the fields on
//! the plate, the waveform, jobs on plates, and exports. The use of a device is the crate
//! `slipline-instrument`.
//!
//! ```text
//! setup (edits, undo, file) --> jobs (table, lights, design)
//!                          \--> field (steady, time domain, sheet)  \
//! specification --> study (many plates around one) --> CSV, statistics
//! link's journal --> waveform (codes, spectrum) ---------------------+--> export (CSV, WAV, figures, report)
//! ```
//! Rooms: `setup`, `texture`, `scenes` and `named_plate` what a user chooses; `field`, `waveform`, `sound` and `response` what there
//! is to see and hear; `jobs` and `study` work that takes long; `answer` and `export` results for programs and as files.
//!
//! It builds for a browser. The feature `native` adds files, which browsers do not support; `figures` the pictures of exports, and
//! `painted`, on by default, these as pixels.

#![forbid(unsafe_code)]
// The crate is part of the browser build: clippy.toml lists what browsers do not support.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]

pub mod answer;
#[cfg(feature = "native")]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "the files of this computer"))]
pub mod atomic_file;
pub mod colour_map;
pub mod export;
pub mod field;
#[cfg(feature = "figures")]
pub mod fonts;
pub mod jobs;
#[cfg(feature = "native")]
pub mod named_plate;
pub mod refused_value;
pub mod response;
pub mod scenes;
pub mod setup;
pub mod sound;
pub mod sounding;
pub mod study;
pub mod texture;
pub mod wav;
pub mod waveform;
