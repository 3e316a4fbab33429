//! Thousands of random hosts, for `.ci/run statistics`.

use super::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn the_same_of_a_thousand_hosts_for_the_travel(
        max_sum_per_mille in 100u16..=1000,
        static_travel in 0.1..3.0,
        minor in 0u8..=3,
        acts in acts(),
    ) {
        //
        keeps_within_its_travel(max_sum_per_mille, static_travel, minor, &acts)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(9000))]

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn the_same_of_nine_thousand_hosts_for_all_else(
        profile in profiles(),
        lease_ms in prop::option::of(1000u32..4000),
        minor in 0u8..=3,
        heard in 0.1..0.9,
        acts in acts(),
    ) {
        //
        keeps_its_times_and_rises(profile, lease_ms, minor, heard, &acts)?;
    }
}
