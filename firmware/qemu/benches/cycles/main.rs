//! A benchmark of the bank and the conversion to codes, as the device uses them. A cycle model calls its functions by
//! their symbols; under QEMU it counts instructions.
//!
//! `bench_setup(tones)` chooses how many of the sixteen slots sound; then every call of `bench_steady()`,
//! `bench_retune()` or `bench_glide()` renders exactly one block of 128 codes:
//! - steady: nothing changes, the common case;
//! - retune: every tone has another frequency than in the block before, so every basis is rebuilt, as after a glide;
//! - glide: every tone changes its amplitude, and its frequency as fast as it may.
//!
//! `bench_lock_in_steady()` and `bench_lock_in_glide()` measure the same tones on one input, a block at a time, without
//! rendering anything.
//!
//! The image itself compares the assembly with the portable kernel and counts instructions:
//! ```text
//! qemu-system-arm -M mps2-an386 -nographic -semihosting -icount shift=0 -kernel slipline-bench
//! ```
//! It fails (exit code 1) if a single sample, code or lock-in sum differs. On the M4 an instruction takes 1.2 cycles of the bank and
//! 1.4 of the lock-ins (loads of several words, taken branches): steady 3.2, retune 6.5, glide 9.8, and the lock-ins 3.9 (steady)
//! and 4.9 (glide) cycles per tone and sample by a cycle model.
#![cfg_attr(target_arch = "arm", no_std, no_main)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]

#[cfg(target_arch = "arm")]
mod compare;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod device;

#[cfg(not(target_arch = "arm"))]
fn main() {
    println!("This is a benchmark for a Cortex-M4. Build it with --target thumbv7em-none-eabihf.");
}
