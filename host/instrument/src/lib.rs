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

pub use instrument::{
    Asked, AskedContent, Attention, Awaited, Background, CalibrateIntent, CalibrateScene, DesignState, Desk,
    DeviceIntent, DragRecorder, Drive, HoldScene, Instrument, Jobs, Link, LiveScene, MeasureDraft,
    MeasureIntent, MeasureScene, Notice, Outbox, Output, Page, SAFE_MODE, Screen, Shown, TextureScene,
    Waiting,
};
