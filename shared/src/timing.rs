//! The protocol's time limits in samples, at a device's own rate: a device has no other clock, and a host that plans by the
//! same numbers is not refused.

use crate::command::TravelLimit;
use crate::limits;
use crate::units::SampleIndex;

/// The block length as a sample count.
const BLOCK_SAMPLES: u64 = limits::BLOCK as u64;

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
    #[inline]
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

    /// The shortest glide of a drive with a limit of its actuator's travel, in samples: [`GLIDE_PERIODS`](limits::GLIDE_PERIODS) of
    /// the resonance, at most the longest possible glide. The device refuses shorter glides; the host makes none.
    #[inline]
    #[must_use]
    pub fn shortest_glide(&self, limit: &TravelLimit) -> u32 {
        let samples = limits::GLIDE_PERIODS
            .saturating_mul(u64::from(self.sample_rate_hz))
            .saturating_mul(1_000_000)
            .div_ceil(limit.resonance_uhz.max(1));
        u32::try_from(samples).unwrap_or(u32::MAX).clamp(self.min_glide, self.max_glide)
    }

    /// Where the thermal limit came into force that stands at the last sample before `next`.
    #[inline]
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
    #[inline]
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
    // The value is compared before it is cut.
    if samples > u32::MAX as u64 { u32::MAX } else { samples as u32 }
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
}
