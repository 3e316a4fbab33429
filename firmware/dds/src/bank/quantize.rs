//! From one sample to one code of a 12-bit DAC.
//!
//! ```text
//! code = clamp(floor(sample 2047 / 2^27 + 1/2) + 2048, 0, 4095)
//! ```
//! Full scale is 2047 codes, not 2048, so that a tone of full amplitude touches neither end and clips nowhere.

/// The code of silence: the middle of the DAC's range.
pub const MID_SCALE: u16 = 2048;
/// The DAC's highest code.
pub const MAX_CODE: u16 = 4095;

/// Codes per sample unit with 32 fractional bits: `2047 / 2^27 * 2^32`.
pub(super) const CODES_PER_UNIT: i32 = 2047 << 5;
/// Half a code, in units of 2^-32.
pub(super) const ROUND: u32 = 1 << 31;

/// The code of one sample, and whether it had to be clamped. `round / 2^32` of a code is added before rounding down.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped into the range of a code"
)]
pub(super) fn quantize(sample: i32, round: u32) -> (u16, bool) {
    let code =
        ((i64::from(sample) * i64::from(CODES_PER_UNIT) + i64::from(round)) >> 32) + i64::from(MID_SCALE);
    let clamped = code.clamp(0, i64::from(MAX_CODE));
    (clamped as u16, clamped != code)
}
