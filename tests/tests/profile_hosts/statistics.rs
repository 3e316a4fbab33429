//! Thousands of random hosts, for `.ci/run statistics`.

use super::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    #[ignore = "statistics: .ci/run statistics"]
    fn a_thousand_hosts_keep_the_actuator_within_its_travel(
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
    fn nine_thousand_hosts_keep_to_amplitude_rise_time_lease_and_hand(
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
