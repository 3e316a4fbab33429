//! The Slipline device on an emulated Cortex-M4F: QEMU's machine mps2-an386.
//!
//! ```text
//! qemu-system-arm -M mps2-an386 -nographic -icount shift=0 -serial <link> -serial <codes> -kernel slipline-qemu
//! ```
//! It is the same application as on the boards, compiled for the same processor, with UART0 as its link and UART1 as
//! its DAC. Under `-icount` the sample index and the executed instructions do not depend on the host computer's speed.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `main.rs`, `device.rs`, `cmsdk.rs`: the application on the emulated machine. Tests: `tests/tests/qemu.rs`
//!
//! The program that counts cycles is a benchmark: `firmware/qemu/benches/cycles/`.
#![cfg_attr(target_arch = "arm", no_std, no_main)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]

#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod cmsdk;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod device;

/// On the host there is nothing to run.
#[cfg(not(target_arch = "arm"))]
fn main() {
    println!(
        "This is for an emulator. Build it with\n  \
         cargo build --release -p slipline-qemu --target thumbv7em-none-eabihf"
    );
}
