//! This computer's ports, and the thread that owns the open one.

mod handle;
mod opener;
#[cfg(all(unix, feature = "simulator"))]
mod second_program;
pub mod serial;
mod serial_ports;
#[cfg(all(unix, feature = "simulator"))]
mod server;
#[cfg(feature = "simulator")]
mod simulated;
#[cfg(unix)]
pub mod socket;
mod watch;
mod worker;

pub use handle::Handle;
pub use opener::{SystemOpener, system_clock};
pub use serial_ports::list_ports;
#[cfg(all(unix, feature = "simulator"))]
pub use server::{ServeError, Server};
pub use watch::{Wakes, Watch};
pub use worker::{Worker, stop_on_panic};
