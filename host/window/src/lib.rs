//! Slipline's window.
//!
//! ```text
//! view (what is shown) --Intent--> app --calls--> instrument --Request--> link --> device
//!   ^                               |  <--Output, Shown--
//!   +---------- Scene --------------+  <--results-- files, pictures
//! ```
//! The window of a system (its event loop, threads, dialogs, files, sound) is left out for a browser, where the crate
//! `slipline-page` is the shell.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `app.rs`: hands events on, carries out intents (`app/perform.rs`); keys (`app/input.rs`), the stage
//!   alone, for visitors or in a frame (`app/kiosk.rs`), the demonstration (`app/demonstration.rs`), the pace of pictures
//!   (`app/pace.rs`), a window that hangs (`app/event_loop.rs`), what a system lacks for a window (`app/no_display.rs`,
//!   `app/libraries.rs`)
//! - `intent.rs`, `scene.rs`: what views ask for, and what they show
//! - `view/`: the views. Colours, font sizes and distances: `view/theme.rs`; what views keep from frame to frame:
//!   `view/state.rs`
//! - `view/stage/`: plate, envelope, felt strip and lines. Tests: `host/window/tests/gui/stage.rs`
//! - `view/bars/`: top bar (states of the link: `view/bars/top_bar.rs`, what they offer: `view/bars/offers.rs`), menu
//!   and bottom row. Tests: `host/window/tests/gui/states.rs`
//! - `view/panels/`, `view/fields/`: the pages of the side panel, and their inputs
//! - `view/plots/`, `view/dialogs/`: plots; pages in front of the window, with the list of shortcuts
//! - `files.rs`, `sound.rs`, `settings.rs`: files, the sound card (`sound/output/`) and the stored settings
//! - `axis.rs`, `caption.rs`: the common x axis, and the captions of fields
//!
//! Tests: `host/window/tests/gui/` finds controls by their accessible names and compares pictures;
//! `host/window/benches/` measures the pace.

#![forbid(unsafe_code)]
// The crate is part of the browser build: clippy.toml lists what browsers do not support.
#![cfg_attr(not(test), warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used))]
// A new error, request or outcome must be handled wherever these are matched.
#![warn(clippy::wildcard_enum_match_arm)]

pub mod app;
pub mod axis;
pub mod caption;
pub mod files;
pub mod intent;
pub mod scene;
pub mod settings;
pub mod sound;
pub mod view;
