//! The soak test at the full sample rate, for a nightly run: `cargo run --release -p slipline-tests --bin soak [hours] [seed]`.
//!
//! 400 kS/s, 24 hours unless another number is given, every code compared with the mirror's, and what the inputs measure with
//! the codes. Prints a line for each hour; ends with an error if a code or a counter is wrong or if memory grows.

use slipline_tests::rig::RATE_HZ;
use slipline_tests::soak::{Soak, resident_bytes};

/// How much the memory may grow after the first hour: an allocator's slack.
const SLACK_BYTES: u64 = 4 << 20;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut number = |usual: u64| {
        arguments.next().map_or(usual, |text| text.parse().unwrap_or_else(|_| panic!("{text} is no number")))
    };
    let (hours, seed) = (number(24), number(1));
    let mut soak = Soak::new(RATE_HZ, seed);
    let mut after_first = None;
    for hour in 1..=hours {
        let tally = soak.run(3600);
        let resident = resident_bytes();
        println!("hour {hour}: {tally:?}, {} KiB resident", resident.unwrap_or(0) / 1024);
        if let (Some(first), Some(now)) = (*after_first.get_or_insert(resident), resident) {
            assert!(now <= first + SLACK_BYTES, "memory grows: {first} bytes, then {now}");
        }
    }
}
