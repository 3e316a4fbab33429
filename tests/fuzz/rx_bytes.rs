//! `cargo fuzz run --fuzz-dir tests --features fuzzing --sanitizer none rx_bytes`
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| slipline_tests::fuzz::rx_bytes(data));
