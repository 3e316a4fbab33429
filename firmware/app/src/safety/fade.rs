//! What the DAC plays where a block is missing: a straight line to mid-scale.
//!
//! The DAC's stream plays it by itself, since a renderer that is late cannot. It moves by [`FADE_STEP`] codes a sample, no
//! steeper than a full-scale tone of 124 Hz, and from full scale it takes 512 samples: 1.3 ms at 400 kS/s. It has no
//! length of its own: it goes on from block to block, each from the last code of the one before.

use slipline_dds::bank::code::MID_SCALE;

/// Codes by which the line moves in a sample, at most.
pub const FADE_STEP: u16 = 4;

/// The codes after `from`, without end: once at mid-scale they stay there.
pub fn fade(from: u16) -> impl Iterator<Item = u16> {
    let (distance, rises) = (from.abs_diff(MID_SCALE), from < MID_SCALE);
    (1..=distance / FADE_STEP)
        .map(move |n| {
            // At most `distance` away from `from`, towards mid-scale: it neither overflows nor passes it.
            let moved = n.wrapping_mul(FADE_STEP);
            if rises { from.wrapping_add(moved) } else { from.wrapping_sub(moved) }
        })
        .chain(core::iter::repeat(MID_SCALE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_dds::bank::BLOCK;

    #[test]
    fn every_fade_is_at_mid_scale_after_four_blocks_and_never_steps_by_more_than_its_slope() {
        for from in 0..=4095 {
            let codes: std::vec::Vec<u16> = fade(from).take(4 * BLOCK).collect();
            assert_eq!(codes[4 * BLOCK - 1], MID_SCALE);
            let mut last = from;
            for code in codes {
                assert!(code.abs_diff(last) <= FADE_STEP, "{last} {code}");
                assert!(code.abs_diff(MID_SCALE) <= last.abs_diff(MID_SCALE), "it never turns back");
                last = code;
            }
        }
    }

    #[test]
    fn a_fade_goes_on_from_block_to_block_as_if_it_were_one() {
        for from in [0, 1, 1033, 2047, 2048, 2050, 4095] {
            let whole: std::vec::Vec<u16> = fade(from).take(2 * BLOCK).collect();
            let second: std::vec::Vec<u16> = fade(whole[BLOCK - 1]).take(BLOCK).collect();
            assert_eq!(whole[BLOCK..], second);
        }
    }
}
