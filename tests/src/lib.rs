//! Slipline's end-to-end tests: rigs and instruments.
//!
//! ```text
//! Rig   = Client -> [FaultyLink] -> SimulatedDevice -> captured codes -> measurements
//! ```
//! A rig is the production code with other edges; hardware, time and chance are arguments. Each file under `tests/`
//! holds the tests of one subject; where a test answers a row of the reliability table it names it (R-..).

pub mod bench;
pub mod built;
pub mod commands;
pub mod faulty_link;
pub mod fuzz;
pub mod measure;
pub mod qemu;
#[cfg(unix)]
pub mod relay;
pub mod rig;
pub mod soak;
pub mod storm;
pub mod talk;
pub mod world;
