//! From samples to the codes of a 12-bit DAC, a block at a time.

use super::block::BLOCK;
use super::kernel::Kernel;
use super::native::Native;
use super::portable::Portable;
pub use super::quantize::{MAX_CODE, MID_SCALE};
use super::quantize::{ROUND, quantize};

/// Computes the codes of a block, 0..=[`MAX_CODE`]; returns how many samples had to be clamped.
pub fn codes(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> u32 {
    codes_by::<Native>(samples, codes)
}

/// As [`codes`], by the portable kernel on every machine. Tests compare the assembly with it.
pub fn codes_portably(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> u32 {
    codes_by::<Portable>(samples, codes)
}

fn codes_by<K: Kernel>(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> u32 {
    if K::codes(samples, codes) {
        // Clamping is rare, so counting may take a second pass.
        samples.iter().map(|sample| u32::from(quantize(*sample, ROUND).1)).sum()
    } else {
        0
    }
}

/// The code of one sample, 0..=[`MAX_CODE`].
#[must_use]
pub fn code_of(sample: i32) -> u16 {
    quantize(sample, ROUND).0
}

/// The sum of the squares of a block's distances from mid-scale: at most `128 * 2048^2`, 29 bits.
#[must_use]
pub fn energy(codes: &[u16; BLOCK]) -> u32 {
    Native::energy(codes)
}

/// As [`energy`], by the portable kernel on every machine. Tests compare the assembly with it.
#[must_use]
pub fn energy_portably(codes: &[u16; BLOCK]) -> u32 {
    Portable::energy(codes)
}

/// As [`codes`], with a rectangular dither of one code from `dither`: the codes' error does not follow the signal, but
/// the noise is 3 dB higher.
pub fn dithered_codes(samples: &[i32; BLOCK], dither: &mut Dither, codes: &mut [u16; BLOCK]) -> u32 {
    let mut clipped = 0;
    for (sample, code) in samples.iter().zip(codes) {
        let (value, clamped) = quantize(*sample, dither.draw());
        *code = value;
        clipped += u32::from(clamped);
    }
    clipped
}

/// A source of rectangular dither: a 32-bit xorshift, the same sequence on every machine.
#[derive(Clone, Debug)]
pub struct Dither(u32);

impl Dither {
    /// Starts the sequence at `seed`. Zero counts as 1, because xorshift cannot leave zero.
    #[must_use]
    pub const fn new(seed: u32) -> Self {
        Self(if seed == 0 { 1 } else { seed })
    }

    fn draw(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }
}
