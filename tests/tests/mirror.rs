//! The mirror and the device, code by code, under random commands.

use proptest::prelude::*;
use slipline_tests::random_actions::{actions, play};
use slipline_tests::rig::Table;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn mirror_and_device_send_the_same_codes_whatever_the_user_does(
        actions in actions(0.45),
        block_waits in prop::bool::weighted(0.7),
    ) {
        // R-32 too: nothing clips.
        let tables = [
            Table::usual(),
            Table::line(33, 25_000.0, 90_000.0, |u| 0.3 + 0.6 * (1.0 - u)),
            Table::line(1025, 500.0, 4_000.0, |u| 0.2 + 0.7 * u * u),
        ];
        play(&actions, &tables, block_waits)?;
    }

    #[test]
    fn no_code_jumps_whatever_the_user_does(actions in actions(200.0 / 400e3), block_waits in prop::bool::weighted(0.7)) {
        // At 200 Hz the sine itself moves by at most 2 pi 200 / 400 000 of full scale a sample, 6.44 codes, and
        // its slope by 0.021; the steepest ramp, 2 ms of a raised cosine, by (pi / 2) / 800, 4.02 codes, and its slope
        // by 0.016. A code is the sample rounded: one code more for a difference, two for a difference of differences.
        let tables = [
            Table::line(257, 200.0, 20.0, |u| 0.5 + 0.5 * u),
            Table::line(33, 50.0, 150.0, |u| 0.3 + 0.7 * (1.0 - u)),
            Table::line(1025, 10.0, 200.0, |u| 0.2 + 0.7 * u * u),
        ];
        let codes = play(&actions, &tables, block_waits)?;
        let steps: Vec<i32> = codes.windows(2).map(|pair| i32::from(pair[1]) - i32::from(pair[0])).collect();
        let largest = steps.iter().map(|step| step.abs()).max().unwrap_or(0);
        prop_assert!(f64::from(largest) <= 6.44 + 4.02 + 1.0, "a step of {largest}");
        let bend = steps.windows(2).map(|pair| (pair[1] - pair[0]).abs()).max().unwrap_or(0);
        prop_assert!(bend <= 2, "a bend of {bend}");
    }
}
