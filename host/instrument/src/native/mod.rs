//! The instrument on this computer: a blocking client of a device, for sequential programs.

mod client;
mod error;

pub use client::{BlockingLink, Client, LEASE};
pub use error::ClientError;
