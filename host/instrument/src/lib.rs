//! The instrument: a plate and a device in use, without a window. It sends the requests that need no user
//! action, runs measurements, sweeps, level holds and calibrations, and provides the inputs of the simulated
//! device. [`Instrument`] combines these; shells show it.
//!
//! ```text
//! setup --> autopilot --------------------+--> requests to the link
//! plate --> measure (steps, sweep) -------+         |
//!      \--> hold (levels of held tones) --+   <-- snapshots, outcomes
//! measured_file --> jobs (recorded, calibrate) --> calibration
//! jobs (rig) --> rig: the sensor, current and finger of a simulated plate
//! recording: a drag, for replay
//! requests: what the command line and Python ask for
//! ```
//! It owns no thread, clock or path, and builds for a browser. Shells (window, command line) translate their
//! own events into its calls and show its state.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `instrument/`: the plate and the device in use, in four rooms; `turn` in `instrument/mod.rs` shows the order in which they
//!   act. `instrument/desk/`: setup, history, comparison; `instrument/drive/`: link, requests, table, STOP
//!   (`instrument/drive/stop_presses.rs`); `instrument/lab/`: measurements, calibration, rig, level hold;
//!   `instrument/screen/`: prediction, playback, textures, the actual plate beside the predicting one.
//!   Edits and their sources: `instrument/edits.rs`; the plate before and after a calibration:
//!   `instrument/before_after.rs`, and lines that stay meanwhile: `instrument/held_lines.rs`; the tour: `instrument/tour.rs`;
//!   files of what is shown: `instrument/exports.rs`. Tests:
//!   `host/instrument/tests/in_use/`
//! - `autopilot.rs`: sends drives and tables without a user action. Tests: `host/window/tests/gui/states.rs`,
//!   `host/instrument/tests/in_use/starting.rs`
//! - `measure/`: measurements by steps or a sweep (`measure/sweep/`), and of the drive's harmonics (`measure/harmonics/`);
//!   the course of all procedures: `measure/procedure.rs`. Tests: `tests/tests/measuring.rs`, `tests/tests/sweep.rs`,
//!   `tests/tests/harmonics.rs`
//! - `measured_file.rs`, `calipers.rs`, `calibration.rs`: files of measurements, dimensions by calipers, the steps of a
//!   calibration
//! - `hold.rs`: how levels are held. Tests: `tests/tests/hold_rig.rs`, `host/instrument/tests/in_use/holding.rs`
//! - `rig/`, `bench.rs`: what a simulated device's inputs see; a rig that another worker computes: `bench/elsewhere.rs`
//! - `requests/`: what the command line and Python ask for, and the defaults. Tests:
//!   `tests/python/test_command_line.py`
//! - `native/`: a blocking client of a device, for programs. Tests: `host/tests/cli/`
//! - `jobs/`: work on measurements and devices that takes longer than a frame
//! - `selftest/`: a board's test of itself, by a wire or two. Tests:
//!   `host/instrument/tests/in_use/selftest.rs`, `host/instrument/tests/in_use/planted_faults.rs`
//! - `profile_file.rs`: the file of an actuator's profile. Tests: `tests/tests/profile.rs`
//! - `concern.rs`: what the lights of a check mean beside a device: notes, and what fails or harms. Tests:
//!   `host/instrument/tests/in_use/lights.rs`
//! - `changes.rs`, `device_info.rs`, `recording.rs`: differences between snapshots, a device's report, a recorded drag

#![forbid(unsafe_code)]
// The crate is part of the browser build: clippy.toml lists what browsers do not support.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]
// A new request, outcome or change must be handled wherever these are matched.
#![warn(clippy::wildcard_enum_match_arm)]

pub mod autopilot;
pub mod bench;
pub mod calibration;
pub mod calipers;
pub mod changes;
pub mod concern;
pub mod device_info;
pub mod hold;
mod instrument;
pub mod jobs;
pub mod measure;
pub mod measured_file;
#[cfg(feature = "native")]
#[cfg_attr(not(test), expect(clippy::disallowed_methods, reason = "this computer's threads"))]
pub mod native;
pub mod profile_file;
pub mod recording;
pub mod requests;
pub mod rig;
pub mod selftest;

pub use instrument::{
    Asked, AskedContent, AskedTable, Attention, Awaited, Background, CalibrateIntent, CalibrateScene,
    CalibrationSide, DesignState, Desk, DeviceIntent, DragRecorder, Drive, HoldScene, Instrument, Jobs, Link,
    LiveScene, MeasureDraft, MeasureIntent, MeasureScene, Notice, Outbox, Output, Page, Progress, SAFE_MODE,
    Screen, SelftestScene, Shown, SoFar, TextureScene, TourScene, TourStep, Waiting, fault_sentence,
};
