//! Slipline in a browser.
//!
//! ```text
//! page's thread:  window + instrument, draws    --requests-->  device worker: link, simulated device
//!                 RemoteLink                    <--updates---                 keep-alive, watch over the page
//!                      |  --jobs-->  job workers: one for quick work, one for long work
//!                      |  <-results-
//! ```
//! All of them run this WebAssembly, each with its own entry and memory: [`open_page`](page::open_page),
//! [`DeviceWorker`](device::DeviceWorker), [`JobWorker`](work::JobWorker). The scripts in `static/` start them and
//! pass their messages on. STOP goes from the script to the device worker directly, past everything here.
//!
//! Elsewhere than in a browser the crate is empty.

#![cfg(target_arch = "wasm32")]
#![forbid(unsafe_code)]
#![warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used)]

mod clock;
pub mod device;
mod files;
mod host;
mod keep_alives;
#[cfg(feature = "labels")]
mod labels;
mod message;
pub mod page;
mod remote_link;
pub mod work;
