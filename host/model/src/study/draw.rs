//! A counter-based generator: a random number by the number of the plate and the field, without a state.
//!
//! Philox4x64-10 by Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3" (SC 2011); NumPy has it as
//! `numpy.random.Philox`. Key: the seed and 0. Counter: the plate's number, the hash of the field's path, 0 and 0. So a field's
//! numbers do not depend on which other fields vary.

use std::f64::consts::TAU;

const ROUNDS: usize = 10;
const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
/// The golden ratio and the root of 3 less 1, as fractions of 2^64.
const KEY_STEPS: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];

/// The random numbers of one field of one plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Draw([u64; 2]);

impl Draw {
    /// The numbers of the field whose path has this [`path_hash`].
    pub(super) fn of(seed: u64, plate: u64, path_hash: u64) -> Self {
        let [first, second, ..] = philox([plate, path_hash, 0, 0], [seed, 0]);
        Self([first, second])
    }

    /// Uniform from -1 (included) to 1 (excluded), in steps of 2^-52.
    pub(super) fn uniform(self) -> f64 {
        2.0 * unit(self.0[0]) - 1.0
    }

    /// Standard normal, at most 8.6 from 0: the cosine of Box and Muller's transform.
    pub(super) fn normal(self) -> f64 {
        // 1 - u is above 0, so its logarithm is finite.
        (-2.0 * (1.0 - unit(self.0[0])).ln()).sqrt() * (TAU * unit(self.0[1])).cos()
    }
}

/// The upper 53 bits as a number from 0 (included) to 1 (excluded).
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (0.5_f64).powi(53)
}

/// FNV-1a, 64 bits, of the UTF-8 bytes of a field's path.
pub(super) fn path_hash(path: &str) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
    path.bytes().fold(0xCBF2_9CE4_8422_2325, step)
}

fn philox(mut counter: [u64; 4], mut key: [u64; 2]) -> [u64; 4] {
    let product = |a: u64, b: u64| {
        let whole = u128::from(a) * u128::from(b);
        ((whole >> 64) as u64, whole as u64)
    };
    for _ in 0..ROUNDS {
        let (high0, low0) = product(MULTIPLIERS[0], counter[0]);
        let (high1, low1) = product(MULTIPLIERS[1], counter[2]);
        counter = [high1 ^ counter[1] ^ key[0], low1, high0 ^ counter[3] ^ key[1], low0];
        key = [key[0].wrapping_add(KEY_STEPS[0]), key[1].wrapping_add(KEY_STEPS[1])];
    }
    counter
}

#[cfg(test)]
mod tests;
