//! The commands to one device: what to send next ([`queue`]), what the replies mean ([`replies`], and [`numbered`] for
//! what the tasks send), a table's way onto the device ([`upload`]).

mod holding;
mod listening;
mod numbered;
mod queue;
mod reading;
mod replies;
mod task;
mod upload;

pub(crate) use queue::{CommandQueue, Next};
