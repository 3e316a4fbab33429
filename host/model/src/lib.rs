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
//! It builds for a browser. The feature `native` adds files, which browsers do not support; `figures` the pictures of exports, and
//! `painted`, on by default, these as pixels.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `setup/`: what a user sets up, edits and undoes (`setup/undo.rs`), its file (`setup/file/`), its form in a page's
//!   address (`setup/fragment.rs`)
//! - `field/`: the drawn fields in space and time, also through a simulated device (`field/simulation/`); both places
//!   of a tone (`field/tone_places.rs`), the tone with a felt edge (`field/edge_reach/`). Tests:
//!   `tests/tests/boundary.rs`
//! - `texture/`: a user's texture, its files, and a setup as a chord (`texture/chord.rs`). Tests:
//!   `tests/tests/texture.rs`
//! - `study/`: many plates: specification, random numbers, what is computed for each. Tests: `host/tests/cli/study.rs`
//! - `answer/`: the fields of `--json`, which Python has as attributes. Tests: `host/tests/cli/`,
//!   `tests/python/test_command_line.py`
//! - `response/`: a measured response for display. Tests: `host/window/tests/gui/measure.rs`
//! - `waveform/`, `sounding.rs`, `real_fft.rs`: the latest codes and their spectrum, the present drive, and the transform of real
//!   values
//! - `companions.rs`: tones whose companions cancel the drive's harmonics. Tests: `tests/tests/harmonics.rs`
//! - `sound/`, `wav.rs`: sound for a loudspeaker, and recordings (WAV, FLAC, ALAC, AIFF)
//! - `content.rs`: recognizes a file by its bytes
//! - `jobs/`: work on plates that takes longer than a frame; which result is shown (`jobs/latest_result.rs`)
//! - `export/`: exports, and figures (`export/figures/`)
//! - `colour_map.rs`: the colour maps of displacement and amplitude. Tests: `host/window/tests/gui/snapshots/`
//! - `fonts.rs`, `scenes.rs`: fonts, and scenes to start from
//! - `named_plate.rs`, `refused_value.rs`, `atomic_file.rs`: plates by name or file, values of refusals, files on disk

#![forbid(unsafe_code)]
// The crate is part of the browser build: clippy.toml lists what browsers do not support.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]
// A new error, request or outcome must be handled wherever these are matched.
#![warn(clippy::wildcard_enum_match_arm)]

pub mod answer;
#[cfg(feature = "native")]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "the files of this computer"))]
pub mod atomic_file;
pub mod colour_map;
pub mod companions;
pub mod content;
pub mod export;
pub mod field;
#[cfg(feature = "figures")]
pub mod fonts;
pub mod jobs;
#[cfg(feature = "native")]
pub mod named_plate;
pub mod real_fft;
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
