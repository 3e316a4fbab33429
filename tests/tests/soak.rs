//! the soak test. At the full sample rate a whole day is a program for a nightly run: `src/bin/soak.rs`.

use slipline_tests::rig::RATE_HZ;
use slipline_tests::soak::{Soak, resident_bytes};

#[test]
fn two_minutes_at_the_full_sample_rate_match_the_mirror_code_for_code() {
    let tally = Soak::new(RATE_HZ, 57).run(120);
    assert!(tally.samples >= 120 * u64::from(RATE_HZ));
    assert!(tally.drives > 10 && tally.stops > 0, "{tally:?}");
    assert!(tally.measured > 10 && tally.phases > 0, "{tally:?}");
}

/// At 2 kS/s, so that a day has few blocks: times and counters are those of a day, and every code is compared.
#[test]
#[ignore = "a simulated day: .ci/run long_tests"]
fn a_day_of_random_use_ends_without_a_fault_or_a_lost_frame() {
    let mut soak = Soak::new(2000, 24);
    let first_hour = soak.run(3600);
    let before = resident_bytes();
    let day = soak.run(23 * 3600);
    assert!(day.samples >= 24 * 3600 * 2000);
    assert!((800..1000).contains(&day.hottest_per_mille), "folded back, and never too hot: {day:?}");
    assert!(day.measured > 1000 && day.phases > 5, "{day:?}");
    assert!(day.drives > 20 * first_hour.drives / 2 && day.sessions > 10, "{day:?}");
    if let (Some(before), Some(after)) = (before, resident_bytes()) {
        assert!(after < before + (8 << 20), "memory grows: {before} bytes, then {after}");
    }
}
