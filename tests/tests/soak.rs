//! a long day. The whole of it at full fidelity is a program of its own, for the night: see `src/bin/soak.rs`.

use slipline_tests::rig::RATE_HZ;
use slipline_tests::soak::{Soak, resident_bytes};

#[test]
fn two_minutes_at_full_fidelity_are_the_mirrors_code_for_code() {
    let tally = Soak::new(RATE_HZ, 57).run(120);
    assert!(tally.samples >= 120 * u64::from(RATE_HZ));
    assert!(tally.drives > 10 && tally.stops > 0, "{tally:?}");
}

/// At 2 kS/s, so that a day is few blocks: the times and the counters are those of a day, the codes are checked alike.
#[test]
fn a_day_with_a_restless_user_ends_as_it_began() {
    let mut soak = Soak::new(2000, 24);
    let morning = soak.run(3600);
    let before = resident_bytes();
    let evening = soak.run(23 * 3600);
    assert!(evening.samples >= 24 * 3600 * 2000);
    assert!((800..1000).contains(&evening.hottest_per_mille), "folded back, and never too hot: {evening:?}");
    assert!(evening.drives > 20 * morning.drives / 2 && evening.sessions > 10, "{evening:?}");
    if let (Some(before), Some(after)) = (before, resident_bytes()) {
        assert!(after < before + (8 << 20), "memory grows: {before} bytes, then {after}");
    }
}
