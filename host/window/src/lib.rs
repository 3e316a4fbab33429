//! Slipline's window.
//!
//! ```text
//! view (what is shown) --Intent--> app --calls--> instrument --Request--> link --> device
//!   ^                               |  <--Output, Shown--
//!   +---------- Scene --------------+  <--results-- files, pictures
//! ```

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::expect_used, clippy::unwrap_used))]

pub mod app;
pub mod axis;
pub mod caption;
pub mod files;
pub mod intent;
pub mod scene;
pub mod settings;
pub mod sound;
pub mod view;
