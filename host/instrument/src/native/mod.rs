//! The instrument on this computer: a blocking client of a device, for sequential programs.

mod arming;
mod brown_out;
mod client;
mod error;
mod hold;
mod interruptible;
mod measurer;
mod procedures;
mod sender;
mod trimming;
mod wait;

pub use arming::ArmingConsent;
pub use client::{BlockingLink, Client, LEASE};
pub use error::{ClientError, StandingFaults};
pub use interruptible::InterruptibleLink;
pub use measurer::Measurer;
pub use sender::TimedDrive;
pub use trimming::{LaterAnswer, TRIM_S, TrimAnswer, TrimmedAnswer, Trimming};
