//! Protection of actuator and finger: limits, the fault latch, fades, and the record of a crash for the next start.
//!
//! `thermal` models the coil and reduces every amplitude; `foldback` is the report of it. `excursion` refuses a motion that
//! would pass the travel limit. `faults` is the latch, `supervisor` the watchdog's condition, `fade` what plays where a
//! block is missing. `crash` is the record of a panic, `boot` how the next run starts from it. What a command means and
//! when it is refused is the controller's; when the output is muted, the renderer's.

pub mod boot;
pub mod bounds;
pub mod crash;
pub mod excursion;
pub mod fade;
pub mod faults;
pub mod foldback;
pub mod supervisor;
pub mod thermal;
