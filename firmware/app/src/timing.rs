//! The protocol's time limits in samples, at the device's own rate: the application has no other clock.

use slipline_protocol::limits;
use slipline_protocol::units::SampleIndex;

use crate::bank::BLOCK;

/// The block length as a sample count.
pub const BLOCK_SAMPLES: u64 = BLOCK as u64;

/// Mid-scale blocks between arming and the first drive, and between the end of a ramp and the mute.
///
/// A board holds up to two blocks between the renderer and the DAC's pin, the halves of a ring; the amplifier must not be
/// switched before they are out.
pub const SETTLE_BLOCKS: u64 = 4;

/// Blocks between two ticks of the thread side: 2.6 ms at 400 kS/s, well below the shortest of its time-outs.
pub const TICK_BLOCKS: u64 = 8;

/// Times in samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// The sample rate, in Hz.
    pub sample_rate_hz: u32,
    /// [`limits::DEAD_MAN_MS`].
    pub dead_man: u64,
    /// [`limits::DEAD_MAN_RAMP_MS`].
    pub dead_man_ramp: u32,
    /// [`limits::STOP_RAMP_MS`].
    pub stop_ramp: u32,
    /// [`limits::EMERGENCY_RAMP_MS`].
    pub emergency_ramp: u32,
    /// [`limits::MIN_GLIDE_MS`].
    pub min_glide: u32,
    /// [`limits::MAX_GLIDE_MS`].
    pub max_glide: u32,
    /// [`limits::MAX_APPLY_AHEAD_MS`].
    pub max_apply_ahead: u64,
    /// [`limits::STAGING_TIMEOUT_MS`].
    pub staging: u64,
    /// [`limits::TRANSMIT_TIMEOUT_MS`].
    pub transmit: u64,
    /// [`limits::BOOTLOADER_TOKEN_MS`].
    pub bootloader_token: u64,
    /// [`limits::DESK_STOP_MS`].
    pub desk_stop: u64,
    /// [`limits::HAND_MS`].
    pub hand: u64,
    /// [`limits::STORE_PERIOD_MS`].
    pub store_period: u64,
    /// [`limits::MAX_DRIVE_MS`].
    pub max_drive: u64,
    /// [`limits::FOLDBACK_PERIOD_MS`] in whole blocks, at least one.
    pub limit_period: u64,
    /// A table swap's glide while tones sound: four times the shortest.
    pub table_glide: u32,
}

impl Timing {
    /// The times at a sample rate in Hz.
    #[must_use]
    pub const fn at(sample_rate_hz: u32) -> Self {
        Self {
            sample_rate_hz,
            dead_man: samples(sample_rate_hz, limits::DEAD_MAN_MS),
            dead_man_ramp: short(sample_rate_hz, limits::DEAD_MAN_RAMP_MS),
            stop_ramp: short(sample_rate_hz, limits::STOP_RAMP_MS),
            emergency_ramp: short(sample_rate_hz, limits::EMERGENCY_RAMP_MS),
            min_glide: short(sample_rate_hz, limits::MIN_GLIDE_MS),
            max_glide: short(sample_rate_hz, limits::MAX_GLIDE_MS),
            max_apply_ahead: samples(sample_rate_hz, limits::MAX_APPLY_AHEAD_MS),
            staging: samples(sample_rate_hz, limits::STAGING_TIMEOUT_MS),
            transmit: samples(sample_rate_hz, limits::TRANSMIT_TIMEOUT_MS),
            bootloader_token: samples(sample_rate_hz, limits::BOOTLOADER_TOKEN_MS),
            desk_stop: samples(sample_rate_hz, limits::DESK_STOP_MS),
            hand: samples(sample_rate_hz, limits::HAND_MS),
            store_period: samples(sample_rate_hz, limits::STORE_PERIOD_MS),
            max_drive: samples(sample_rate_hz, limits::MAX_DRIVE_MS),
            limit_period: {
                let blocks = samples(sample_rate_hz, limits::FOLDBACK_PERIOD_MS) / BLOCK_SAMPLES;
                if blocks == 0 { BLOCK_SAMPLES } else { blocks.saturating_mul(BLOCK_SAMPLES) }
            },
            table_glide: short(sample_rate_hz, 4 * limits::MIN_GLIDE_MS),
        }
    }

    /// Where the thermal limit came into force that stands at the last sample before `next`.
    #[must_use]
    pub const fn limit_since(&self, next: SampleIndex) -> SampleIndex {
        let last = next.saturating_sub(1);
        // The period is never 0; were it, the limit would stand since that sample.
        match last.checked_rem(self.limit_period) {
            Some(past) => last.saturating_sub(past),
            None => last,
        }
    }

    /// A time in milliseconds as samples.
    #[must_use]
    pub const fn samples(&self, milliseconds: u32) -> u64 {
        samples(self.sample_rate_hz, milliseconds)
    }
}

const fn samples(sample_rate_hz: u32, milliseconds: u32) -> u64 {
    sample_rate_hz as u64 * milliseconds as u64 / 1000
}

/// The same for ramps, which are counted in 32 bits: 10 s fit up to 429 MS/s.
const fn short(sample_rate_hz: u32, milliseconds: u32) -> u32 {
    let samples = samples(sample_rate_hz, milliseconds);
    #[expect(clippy::cast_possible_truncation, reason = "the value has just been compared")]
    let low = samples as u32;
    if samples > u32::MAX as u64 { u32::MAX } else { low }
}

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
    fn times_follow_the_sample_rate() {
        let timing = Timing::at(400_000);
        assert_eq!(timing.dead_man, 400_000);
        assert_eq!((timing.dead_man_ramp, timing.stop_ramp, timing.emergency_ramp), (20_000, 12_000, 800));
        assert_eq!((timing.min_glide, timing.max_glide), (2_000, 4_000_000));
        assert_eq!(Timing::at(170_000_000 / 425).dead_man, 400_000);
    }

    #[test]
    fn an_index_is_rounded_up_to_a_block() {
        assert_eq!([0, 1, 127, 128, 129].map(block_at_or_after), [0, 128, 128, 128, 256]);
    }
}
