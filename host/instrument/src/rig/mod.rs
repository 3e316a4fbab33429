//! The simulated rig at the inputs of a simulated device: amplifier, plate, a sensor on it, and the shunt in
//! the drive's current.
//!
//! ```text
//! DAC codes --> amplifier --> true plate as resonators --> sensor at a place --> gain, delay --+--> noise, 12 bits
//!                  |               (slipline_plate)                                            |
//!                  +--> motor: current through the shunt ---------------------------------------+
//! ```
//! The amplifier passes every frequency, or those below its bandwidth, with images of the tones in the current.
//! The coil is linear, or one whose force factor and suspension change with its displacement ([`Coil`]).
//! The plate may differ from the one that the host assumes: [`secret`] draws an unknown one. A [`RigHand`]
//! acts as a person at the rig: it moves the sensor or pulls a plug.

mod amplifier;
mod bench;
mod coil;
mod converter;
mod copy;
mod error;
mod fault;
mod hand;
mod motor;
mod options;
mod parts;
mod prepared;
mod sampler;
mod standing;

pub use coil::Coil;
pub use copy::{RigCopy, RigState};
pub use error::RigError;
pub use fault::RigFault;
pub use hand::RigHand;
pub use motor::{Motor, Transducer};
pub use options::{RigOptions, limits};
pub use prepared::PreparedRig;

use slipline_plate::truth::{Random, near};
use slipline_plate::{Plate, PlateError};
use std::num::ParseIntError;

/// The seed of `secret:SEED`, 1 for `secret` alone; `None` for a text that names a plate.
pub fn secret_seed(text: &str) -> Option<Result<u64, ParseIntError>> {
    match text.strip_prefix("secret")? {
        "" => Some(Ok(1)),
        rest => Some(rest.strip_prefix(':')?.parse()),
    }
}

/// A plate near the nominal one, drawn by [`near`]: its wave speed within 5 %, its loss 0.5 to 2.5 times as high. Equal seeds give
/// equal plates.
///
/// # Errors
/// [`PlateError`] if no plate near this one is within the limits of plates.
pub fn secret(nominal: &Plate, seed: u64) -> Result<Plate, PlateError> {
    let mut random = Random::new(seed);
    let mut drawn = near(nominal, &mut random);
    for _ in 0..TRIALS {
        if drawn.is_ok() {
            break;
        }
        // Near a limit not every draw is a valid plate.
        drawn = near(nominal, &mut random);
    }
    drawn
}

/// Largest number of draws.
const TRIALS: usize = 16;

#[cfg(test)]
mod tests;
