//! The instrument on this computer: a blocking client of a device, for programs that do one thing after the other.

mod client;
mod error;

pub use client::{BlockingLink, Client};
pub use error::ClientError;
