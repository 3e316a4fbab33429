//! Slipline on an STM32: the application of `slipline-app` between a link and a DAC.
//!
//! ```text
//! host ==USB or UART==> link --+                                    +--> amplifier's mute pin
//!                              v                                    |
//!                   slipline_app::Link (thread) --Mailbox--> slipline_app::Renderer (interrupt) --> dac --> PA4
//!                              ^                                    |
//! flash slots <--store--> ----+            watchdog <--supervisor--+ both sides' counters
//! ```
//! This crate does not know the protocol's commands. `board` holds what differs between boards, `dac` owns timer, DAC
//! and DMA, `sense` the ADCs of the inputs, `priority` lists which interrupt has which priority, `guard` forbids the null address and what lies below the
//! stack, `crash` handles panics and faults, `bootloader` enters the chip's ROM and undoes what the ROM leaves.
//!
//! # Rooms
//!
//! Short paths are below `src/`. `Tests:` names those that do not lie beside the code.
//!
//! - `board.rs`: what differs between boards, one file each; its memory map: `firmware/stm32/memory/`.
//!   `firmware/BOARDS.md`, "Another STM32"
//! - `main.rs`, `device.rs`: the start, and the tasks
//! - `dac.rs`, `ring.rs`: codes to the DAC: timer, DMA and one interrupt. A second channel begins at its port in
//!   `firmware/app/src/ports.rs`
//! - `sense.rs`, `places.rs`: the ADCs of the inputs. Tests: `tests/board/test_inputs.py`
//! - `dma.rs`, `received.rs`: DMA to and from a register of a peripheral
//! - `uart_link.rs`, `usb_link.rs`, `usb_control.rs`: the links, their baud rate and the control pipe. Tests:
//!   `tests/board/test_serial.py`
//! - `mute.rs`, `button.rs`, `pin_lock.rs`: mute pin and its resistor, the user button and the stop input. Tests:
//!   `tests/board/test_desk_stop.py`
//! - `trigger.rs`: trigger output and input. Tests: `tests/board/test_trigger.py`, `tests/board/test_trigger_input.py`
//! - `store.rs`: flash slots of table and profile, and the option bytes' brown-out level. Tests: `tests/board/test_store.py`,
//!   `tests/board/test_brown_out.py`
//! - `priority.rs`: the interrupts' priorities
//! - `guard.rs`, `crash.rs`, `reset.rs`, `supply.rs`, `watchdog.rs`, `fault_trial.rs`, `pin_watch.rs`: what guards the program,
//!   what a crash leaves behind, and faults on purpose with the time to mute. Tests: `tests/board/test_faults.py`
//! - `bootloader.rs`, `lamp.rs`: the ROM bootloader, and the lamp's patterns
//! - `fast.rs`, `copy.rs`: code and tables in RAM, copies of memory. Tests: `tests/board/test_fast_code.py`,
//!   `tests/board/test_copy.py`
//!
//! Each place with `unsafe` has a row in `firmware/UNSAFE.md`.
#![cfg_attr(target_arch = "arm", no_std, no_main)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]

#[cfg(target_arch = "arm")]
mod board;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod bootloader;
#[cfg(target_arch = "arm")]
mod button;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "assembly; listed in firmware/UNSAFE.md")]
mod copy;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod crash;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod dac;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod device;
#[cfg(target_arch = "arm")]
mod dma;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod fast;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod fault_trial;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod guard;
#[cfg(any(target_arch = "arm", test))]
mod lamp;
#[cfg(target_arch = "arm")]
mod mute;
#[cfg(target_arch = "arm")]
mod pin_lock;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod pin_watch;
#[cfg(any(target_arch = "arm", test))]
mod places;
#[cfg(target_arch = "arm")]
mod priority;
#[cfg(any(all(target_arch = "arm", feature = "link-uart"), test))]
mod received;
#[cfg(any(target_arch = "arm", test))]
mod reset;
#[cfg(any(target_arch = "arm", test))]
mod ring;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod sense;
#[cfg(target_arch = "arm")]
mod store;
#[cfg(target_arch = "arm")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod supply;
#[cfg(target_arch = "arm")]
mod trigger;
#[cfg(all(target_arch = "arm", feature = "link-uart"))]
mod uart_link;
#[cfg(all(target_arch = "arm", feature = "link-usb"))]
mod usb_control;
#[cfg(all(target_arch = "arm", feature = "link-usb"))]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod usb_link;
#[cfg(target_arch = "arm")]
mod watchdog;

/// On the host there is nothing to run; `cargo test -p slipline-stm32` runs the tests of the hardware-free parts.
#[cfg(not(target_arch = "arm"))]
fn main() {
    println!(
        "This is firmware. Build it with\n  \
         cargo build --release -p slipline-stm32 --target thumbv7em-none-eabihf\n\
         for the STM32F4DISCOVERY; firmware/BOARDS.md lists the other boards and says how to flash them."
    );
}
