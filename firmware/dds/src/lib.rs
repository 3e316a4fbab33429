//! Sixteen sine tones and the lock-ins that measure the answer to each, in integers: the same bits on every processor.
//!
//! ```text
//! steps and amplitudes -> bank -> samples -> bank::code -> codes of a DAC of 12 bits
//!                          |
//!                          +--> lock_in::History --+
//! codes of an ADC of 12 bits ----------------------+--> lock_in -> in-phase and quadrature sums of each tone
//! ```
//! # Rooms
//!
//! - `bank/`: the oscillators, a block of 128 samples at a time. Tests: `tests/board/test_speed.py`
//! - `lock_in/`, `lock_in/cortex_m4/`: the measurement at any number of inputs. Tests: `tests/board/test_lock_in.py`
//!
//! The pages of both modules have their equations, word lengths and error bounds. Each has two kernels: portable Rust
//! defines the result, and the assembly of a Cortex-M4 equals it bit for bit.
//!
//! The crate has no clock, allocates nothing and depends on nothing. Frequencies are steps of a 64-bit phase, times are sample
//! indices. The README beside the manifest is a complete example.
#![no_std]
#![expect(
    clippy::new_without_default,
    reason = "what is large belongs into a static, which needs a const constructor"
)]
#![cfg_attr(
    not(test),
    deny(
        clippy::float_arithmetic,
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::cast_possible_truncation
    )
)]

#[cfg(test)]
extern crate std;

pub mod bank;
pub mod lock_in;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
