//! The simulated rig at the inputs of a simulated device: amplifier, plate, a sensor that somebody has put on it, and the
//! shunt in the drive's current.
//!
//! ```text
//! DAC codes --> amplifier --> true plate as resonators --> sensor at a place --> gain, delay --+--> noise, 12 bits
//!                  |               (slipline_plate)                                            |
//!                  +--> motor: current through the shunt ---------------------------------------+
//! ```
//! The plate need not be the one that the host knows: with [`secret`] nobody knows it. A [`RigHand`] does at the rig what a
//! person does: it moves the sensor, pulls a plug.

mod bench;
mod converter;
mod error;
mod fault;
mod hand;
mod motor;
mod options;
mod parts;
mod prepared;
mod sampler;

pub use error::RigError;
pub use fault::RigFault;
pub use hand::RigHand;
pub use motor::{Motor, Transducer};
pub use options::{RigOptions, limits};
pub use prepared::PreparedRig;

use slipline_plate::truth::{Random, near};
use slipline_plate::{Plate, PlateError};

/// A plate a few per cent off the nominal one, by [`near`]: the same for the same seed.
///
/// # Errors
/// [`PlateError`] if no plate near this one keeps the limits of plates.
pub fn secret(nominal: &Plate, seed: u64) -> Result<Plate, PlateError> {
    let mut random = Random::new(seed);
    let mut drawn = near(nominal, &mut random);
    for _ in 0..TRIALS {
        if drawn.is_ok() {
            break;
        }
        // Next to a limit only some draws are plates.
        drawn = near(nominal, &mut random);
    }
    drawn
}

/// Draws after which no further one is tried.
const TRIALS: usize = 16;

#[cfg(test)]
mod tests;
