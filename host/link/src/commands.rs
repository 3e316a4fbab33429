//! The commands to one device: the order of sending ([`queue`]), the evaluation of replies ([`replies`], and
//! [`numbered`] for those to tasks), the upload of a table ([`upload`]).

mod holding;
mod listening;
mod numbered;
mod queue;
mod reading;
mod replies;
mod task;
mod upload;

pub(crate) use queue::{CommandQueue, Next};
