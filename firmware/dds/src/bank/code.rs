//! From samples to the codes of a 12-bit DAC, a block at a time.

use super::block::BLOCK;
use super::kernel::{Converted, Kernel};
use super::native::Native;
use super::portable::Portable;
pub use super::quantize::{MAX_CODE, MID_SCALE};
use super::quantize::{ROUND, quantize};

/// Clamped samples and energy of a block of codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conversion {
    /// How many samples had to be clamped.
    pub clipped: u32,
    /// The sum of the squares of the codes' distances from mid-scale: at most `128 * 2048^2`, 29 bits.
    pub energy: u32,
}

/// Computes the codes of a block, 0..=[`MAX_CODE`].
pub fn codes(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> Conversion {
    codes_by::<Native>(samples, codes)
}

/// As [`codes`], by the portable kernel on every machine. Tests compare the assembly with it.
pub fn codes_portably(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> Conversion {
    codes_by::<Portable>(samples, codes)
}

fn codes_by<K: Kernel>(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> Conversion {
    let Converted { is_clamped, energy } = K::codes(samples, codes);
    // Clamping is rare, so counting may take a second pass.
    let clipped =
        if is_clamped { samples.iter().map(|sample| u32::from(quantize(*sample, ROUND).1)).sum() } else { 0 };
    Conversion { clipped, energy }
}

/// The code of one sample, 0..=[`MAX_CODE`].
#[inline]
#[must_use]
pub fn code_of(sample: i32) -> u16 {
    quantize(sample, ROUND).0
}
