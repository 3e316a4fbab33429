//! This computer's ports, and the thread that owns the open one.

mod handle;
mod opener;
#[cfg(unix)]
mod second_program;
pub mod serial;
mod serial_ports;
#[cfg(unix)]
mod server;
#[cfg(unix)]
pub mod socket;
mod watch;
mod worker;

pub use handle::Handle;
pub use opener::{SystemOpener, system_clock};
pub use serial_ports::list_ports;
#[cfg(unix)]
pub use server::{ServeError, Server};
pub use watch::{Wakes, Watch};
pub use worker::{Worker, stop_on_panic};
