//! Copies the renderer's most costly code and its tables into RAM, and zeroes the states in a section of their own, which the
//! start-up code leaves alone.
//!
//! The flash needs wait states. Its accelerator hides them only while code runs straight on or fits into a small cache.
//! The kernels do not fit, and the tables are read at random. `memory/fast.x` lists what lies in RAM instead.
//!
//! This does not keep the renderer running while the flash is erased: most of its code is still in the flash.

#[cfg(feature = "sram-at-zero")]
use embassy_stm32::pac;

unsafe extern "C" {
    /// The first word of the copy in the flash.
    static _fast_load: u32;
    /// The first word in RAM.
    static mut _fast_start: u32;
    /// The word after the last one in RAM.
    static _fast_end: u32;
    /// The first word of the states that the start-up code does not know, and the word after the last one.
    static mut _states_start: u32;
    static _states_end: u32;
}

/// Copies code and tables, and zeroes the states. Call it before these are set up and after embassy's `init`, which resets SYSCFG.
pub(crate) fn load() {
    // SYSCFG_MEMRMP.MEM_MODE = 11: SRAM1 at address 0 (RM0090 9.2.1). VTOR keeps the vectors in the flash.
    #[cfg(feature = "sram-at-zero")]
    pac::SYSCFG.memrm().modify(|w| w.set_mem_mode(0b11));
    let words = |start: *mut u32, end: *const u32| end.addr().saturating_sub(start.addr()) / size_of::<u32>();
    let (from, to) = (&raw const _fast_load, &raw mut _fast_start);
    // SAFETY: the linker script gives the section this size, in the flash and in RAM, both aligned to eight bytes. They
    // do not overlap, and nothing reads, writes or runs the copy before this function returns.
    unsafe { core::ptr::copy_nonoverlapping(from, to, words(to, &raw const _fast_end)) };
    let states = &raw mut _states_start;
    // SAFETY: the linker script gives the section this size, aligned to eight bytes, and nothing has used it yet.
    unsafe { core::ptr::write_bytes(states, 0, words(states, &raw const _states_end)) };
    // The stores are complete before the first instruction is fetched from there (ARMv7-M A3.8.3).
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
