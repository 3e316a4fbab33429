//! From samples to the codes of a 12-bit DAC.
//!
//! ```text
//! code = clamp(floor(sample 2047 / 2^27 + 1/2) + 2048, 0, 4095)
//! ```
//! Full scale is 2047 codes, not 2048, so that a tone of full amplitude touches neither end and clips nowhere.

use super::BLOCK;
use super::kernel::{Kernel, Native, Portable};

/// The DAC's rest level.
pub const MID_SCALE: u16 = 2048;
/// The DAC's highest code.
pub const MAX_CODE: u16 = 4095;

/// Codes per sample unit with 32 fractional bits: `2047 / 2^27 * 2^32`.
pub(super) const CODES_PER_UNIT: i32 = 2047 << 5;
/// Half a code, in units of 2^-32.
pub(super) const ROUND: u32 = 1 << 31;

/// The codes of a block; returns how many samples had to be clamped.
pub fn codes(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> u32 {
    codes_by::<Native>(samples, codes)
}

/// As [`codes`], by the portable kernel on every machine: what the assembly is compared with.
pub fn codes_portably(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> u32 {
    codes_by::<Portable>(samples, codes)
}

fn codes_by<K: Kernel>(samples: &[i32; BLOCK], codes: &mut [u16; BLOCK]) -> u32 {
    if K::codes(samples, codes) {
        // Seldom, so it may cost another pass.
        samples.iter().map(|sample| u32::from(one_code(*sample, ROUND).1)).sum()
    } else {
        0
    }
}

/// The sum of the squares of a block's distances from mid-scale: at most `128 * 2048^2`, 29 bits.
#[must_use]
pub fn energy(codes: &[u16; BLOCK]) -> u32 {
    Native::energy(codes)
}

/// As [`energy`], by the portable kernel on every machine: what the assembly is compared with.
#[must_use]
pub fn energy_portably(codes: &[u16; BLOCK]) -> u32 {
    Portable::energy(codes)
}

/// As [`codes`], with a rectangular dither of one code drawn from `dither`: the codes' error no longer follows the
/// signal, at the price of 3 dB of noise.
pub fn dithered_codes(samples: &[i32; BLOCK], dither: &mut Dither, codes: &mut [u16; BLOCK]) -> u32 {
    let mut clipped = 0;
    for (sample, code) in samples.iter().zip(codes) {
        let (value, clamped) = one_code(*sample, dither.draw());
        *code = value;
        clipped += u32::from(clamped);
    }
    clipped
}

/// The rounding constant of one sample is `round / 2^32` of a code.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped into the range of a code"
)]
pub(super) fn one_code(sample: i32, round: u32) -> (u16, bool) {
    let code =
        ((i64::from(sample) * i64::from(CODES_PER_UNIT) + i64::from(round)) >> 32) + i64::from(MID_SCALE);
    let clamped = code.clamp(0, i64::from(MAX_CODE));
    (clamped as u16, clamped != code)
}

/// A source of rectangular dither: a 32-bit xorshift, the same sequence on every machine.
#[derive(Clone, Debug)]
pub struct Dither(u32);

impl Dither {
    /// Starts the sequence at `seed`; zero, which xorshift cannot leave, stands for 1.
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
