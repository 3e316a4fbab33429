//! A board on a desk proves itself: its clocks, supply, mute pin, converters, codes and link, by one procedure for every shell.
//!
//! ```text
//! SelftestRequest --Selftesting--> steps on the bench --> StepResult: verdict, readings with limits, sentence
//!                                  (the mute pin low)         |
//!                 limits: what is allowed --------------------+--> SelftestReport --> line, judged again
//! ```
//! - `request.rs`: the fitted wires, and the permitted steps
//! - `procedure.rs`: the order of the steps; `course.rs`: what they share
//! - `at_rest.rs`: clocks, supply, mute pin, link; `wire.rs`, `noise.rs`: by a wire from the DAC to the sensor's input;
//!   `drives.rs`: load, codes, trigger; `person.rs`: button, stop input, flash; `restarts.rs`: bootloader, faults on purpose;
//!   `amplifier.rs`: the amplifier, by a test of its own
//! - `quantities.rs`: every number with its unit; `limits.rs`: every limit, and what to look at beyond it; `report.rs`,
//!   `verdict.rs`: the results; `consistent.rs`: whether the parts of a report agree

mod amplifier;
mod at_rest;
mod consistent;
mod course;
mod drives;
mod limits;
mod noise;
mod person;
mod procedure;
mod quantities;
mod report;
mod request;
mod restarts;
mod verdict;
mod wire;

pub use limits::of as limits_of;
pub use limits::{LIMITS, Limit, is_step, required, step};
pub use procedure::Selftesting;
pub use quantities::{Quantity, of as quantities_of, quantity};
pub use report::{Reading, SelftestReport, StepResult};
pub use request::{NoSuchWire, SelftestRequest, Wire};
pub use verdict::Verdict;
