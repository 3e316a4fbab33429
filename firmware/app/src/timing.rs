//! Times in blocks: the application has no clock but the sample index. The protocol's times in samples are
//! [`Timing`](slipline_protocol::timing::Timing)'s.

use slipline_dds::bank::BLOCK;
use slipline_protocol::limits;

// The protocol's block is the bank's.
const _: () = assert!(BLOCK == limits::BLOCK);

/// The block length as a sample count.
pub const BLOCK_SAMPLES: u64 = BLOCK as u64;

/// Mid-scale blocks between arming and the first drive, and between the end of a ramp and the mute.
///
/// A board holds up to two blocks between the renderer and the DAC's pin, the halves of a ring; the amplifier must not be
/// switched before they are out.
pub const SETTLE_BLOCKS: u64 = 4;

/// Blocks between two ticks of the thread side: 2.6 ms at 400 kS/s, well below the shortest of its time-outs.
pub const TICK_BLOCKS: u64 = 8;

/// The first block boundary at or after an index.
#[must_use]
pub const fn block_at_or_after(index: u64) -> u64 {
    match index % BLOCK_SAMPLES {
        0 => index,
        past => index.saturating_add(BLOCK_SAMPLES - past),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_is_rounded_up_to_a_block() {
        assert_eq!([0, 1, 127, 128, 129].map(block_at_or_after), [0, 128, 128, 128, 256]);
    }
}
