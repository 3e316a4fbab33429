//! Slipline in a browser.
//!
//! ```text
//! page's thread:  window + instrument, draws    --requests-->  device worker: link, simulated device, boards by USB
//!                 RemoteLink                    <--updates---                 keep-alive, watch over the page
//!                      |  --jobs-->  job workers: one for quick work, one for long work
//!                      |  <-results-
//! ```
//! All of them run this WebAssembly, each with its own entry and memory: [`open_page`](page::open_page),
//! [`DeviceWorker`](device::DeviceWorker), [`JobWorker`](work::JobWorker). The scripts in `static/` start them and
//! pass their messages on. STOP goes from the script to the device worker directly, past everything here.
//!
//! Elsewhere than in a browser the crate is empty.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `page.rs`, `host.rs`, `files.rs`, `fonts.rs`, `clock.rs`: the window on a page, and the browser's parts. Tests:
//!   `tests/page/test_window.py`
//! - `device.rs`, `ports.rs`, `message.rs`, `remote_link.rs`: the device worker, and its messages. Tests:
//!   `tests/page/test_stop.py`
//! - `serial.rs`: boards by Web Serial, with `host/window/web/static/serial.js`. Tests: `tests/page/test_serial.py`
//! - `work.rs`: the job workers. Plates pass by number (`host/plate/src/exchange.rs`), the rig as prepared
//!   (`host/instrument/src/rig/prepared.rs`)
//! - `access.rs`: the accessible nodes, for screen readers (`host/window/web/static/mirror.js`) and tests. Tests:
//!   `tests/page/test_access.py`
//! - `script.rs`, `keep_alives.rs`: what the page's tests press and read, in a build with
//!   `PAGE_FEATURES=tests` alone. Tests: `tests/page/test_controls.py`
//!
//! New versions and the page without a network: `host/window/web/static/sw.js`, `host/window/web/static/updates.js`,
//! built by `.ci/page` and `.ci/page-assemble`. Tests: `tests/page/test_updates.py`.

#![cfg(target_arch = "wasm32")]
#![forbid(unsafe_code)]
#![warn(clippy::disallowed_methods, clippy::expect_used, clippy::unwrap_used)]
// A new error, request or outcome must be handled wherever these are matched.
#![warn(clippy::wildcard_enum_match_arm)]

mod access;
mod clock;
pub mod device;
mod files;
mod fonts;
mod host;
mod keep_alives;
mod message;
pub mod page;
mod ports;
mod remote_link;
pub mod serial;
pub mod work;

#[cfg(feature = "tests")]
#[path = "../../../instrument/tests/in_use/pluggable_port.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "it is a part of other programs of tests")]
mod pluggable_port;
#[cfg(feature = "tests")]
pub mod script;
#[cfg(feature = "tests")]
#[path = "../../../instrument/tests/in_use/session.rs"]
#[allow(dead_code, clippy::unwrap_used, reason = "it is a part of other programs of tests")]
mod session;
#[cfg(feature = "tests")]
#[path = "../../../instrument/tests/in_use/script.rs"]
#[allow(dead_code, reason = "it is a part of other programs of tests")]
mod user;
