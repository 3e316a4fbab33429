//! How the program enters the chip's ROM bootloader, and how it starts after it.
//!
//! It enters by a reset, because the ROM expects every register as after a reset. The ROM starts the program after a
//! reset, or by a jump (DFU's "leave") that resets nothing.

use core::cell::UnsafeCell;

use cortex_m::peripheral::{NVIC, SCB};

use crate::{board, crash};

/// Request to the start-up code: [`BOOTLOADER`] makes it enter the ROM bootloader, any other value has no effect.
struct Request(UnsafeCell<u32>);

// SAFETY: written at boot before any interrupt is enabled, and when interrupts have been switched off for good.
unsafe impl Sync for Request {}

#[unsafe(link_section = ".uninit.request")]
static REQUEST: Request = Request(UnsafeCell::new(0));
const BOOTLOADER: u32 = 0x510b_007d;

/// Asks for the ROM bootloader, and resets.
pub(crate) fn reset_into() -> ! {
    crash::silence();
    // The ROM finds it as the reset leaves it, so it goes off before that.
    board::stop_usb_clocks();
    // SAFETY: see `Request`.
    unsafe { REQUEST.0.get().write_volatile(BOOTLOADER) };
    SCB::sys_reset();
}

/// Runs first after a reset: jumps into the ROM bootloader if the last run asked for it.
pub(crate) fn enter_if_requested() {
    // SAFETY: see `Request`; no interrupt is enabled yet.
    let request = unsafe { REQUEST.0.get().read_volatile() };
    // SAFETY: as above. Cleared, so that the next reset starts the program.
    unsafe { REQUEST.0.get().write_volatile(0) };
    if request == BOOTLOADER {
        // The ROM's own interrupts (USB's, for DFU) must find the ROM's vectors: the jump alone leaves this program's
        // vectors in force.
        board::map_system_memory();
        // SAFETY: no interrupt is enabled, no peripheral is on, and the ROM's vector table, aligned as VTOR wants it,
        // begins with its stack pointer and its reset vector (AN2606).
        unsafe {
            (*SCB::PTR).vtor.write(board::SYSTEM_MEMORY);
            cortex_m::asm::bootload(board::SYSTEM_MEMORY as *const u32)
        }
    }
}

/// Brings the processor to the state after a reset, in case the ROM has started the program by a jump.
///
/// After a jump the ROM's interrupts may be enabled and pending, or all interrupts masked (AN3156, "Leave DFU mode",
/// notes). The ROM's vector table was in force, too, but cortex-m-rt's `set-vtor` has already set ours. The peripherals
/// are reset where they are set up. After a reset this function changes nothing.
pub(crate) fn undo_rom_state() {
    // SAFETY: nothing of this program waits for an interrupt yet; each driver enables its own.
    unsafe {
        for word in &(*NVIC::PTR).icer {
            word.write(u32::MAX);
        }
        cortex_m::interrupt::enable();
    }
}
