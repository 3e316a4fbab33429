//! The simulated device: the device application itself on this computer.

mod device;
mod inputs;
pub mod loopback;
mod peripherals;
pub mod realtime;

pub use device::{Options, SentBlock, SimulatedDevice, WATCHDOG_MS};
pub use inputs::{SimulatedInputs, Wires};
pub use peripherals::{MemoryFlash, MuteFault};
pub use slipline_app::safety::thermal::Heat;

#[cfg(test)]
mod tests {
    mod fixed_script;
}
