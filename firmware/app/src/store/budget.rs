//! How often the table's slots may be erased: flash wears, and a host that stores two tables in turn would wear it out in hours.

use slipline_protocol::limits::STORES;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::SampleIndex;

/// The stores that are left: a bucket of [`STORES`], to which each
/// [`STORE_PERIOD_MS`](slipline_protocol::limits::STORE_PERIOD_MS) adds one. A start fills it.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    left: u8,
    /// The index from which the next one is waited for.
    since: SampleIndex,
}

impl Budget {
    /// The full bucket.
    pub const FULL: Self = Self { left: STORES, since: 0 };

    /// The stores that are left now.
    pub fn left(&mut self, now: SampleIndex, timing: &Timing) -> u8 {
        let passed = now.saturating_sub(self.since).checked_div(timing.store_period).unwrap_or(0);
        let left = u64::from(self.left).saturating_add(passed).min(STORES.into());
        self.since = if left == u64::from(STORES) {
            now
        } else {
            self.since.saturating_add(passed.saturating_mul(timing.store_period))
        };
        self.left = u8::try_from(left).unwrap_or(STORES);
        self.left
    }

    /// Takes one.
    ///
    /// # Errors
    /// The seconds until there is one again, rounded up, if none is left.
    pub fn take(&mut self, now: SampleIndex, timing: &Timing) -> Result<(), u16> {
        if let Some(left) = self.left(now, timing).checked_sub(1) {
            self.left = left;
            return Ok(());
        }
        let waits = self.since.saturating_add(timing.store_period).saturating_sub(now);
        Err(u16::try_from(waits.div_ceil(u64::from(timing.sample_rate_hz).max(1))).unwrap_or(u16::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_stores_in_a_row_are_allowed_then_one_a_minute() {
        let timing = Timing::at(400_000);
        let minute = 60 * 400_000;
        let mut budget = Budget::FULL;
        for _ in 0..16 {
            assert_eq!(budget.take(5000, &timing), Ok(()));
        }
        assert_eq!(budget.take(5000, &timing), Err(60));
        assert_eq!(budget.take(4999 + minute, &timing), Err(1));
        assert_eq!(
            (budget.take(5000 + minute, &timing), budget.take(5000 + minute, &timing)),
            (Ok(()), Err(60))
        );
        assert_eq!(budget.left(5000 + 11 * minute, &timing), 10);
        assert_eq!(budget.left(u64::MAX, &timing), 16);
    }
}
