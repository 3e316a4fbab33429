//! Slipline's window.
//!
//! ```text
//! view (what is shown) --Intent--> app --calls--> instrument --Request--> link --> device
//!   ^                               |  <--Output, Shown--
//!   +---------- Scene --------------+  <--results-- files, pictures
//! ```
//! Rooms: `view` what is shown, by bars, stage, panels, plots and dialogs; `intent` and `scene` what passes between it and `app`,
//! which calls the instrument; `files`, `settings` and `sound` the window's own.
//!
//! The window of a system (its event loop, threads, dialogs, files, sound) is left out for a browser, where the crate
//! `slipline-page` is the shell.

#![forbid(unsafe_code)]
// The crate is part of the browser build: clippy.toml lists what browsers do not support.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]

pub mod app;
pub mod axis;
pub mod caption;
pub mod files;
pub mod intent;
pub mod scene;
pub mod settings;
pub mod sound;
pub mod view;
