//! Copies the renderer's most costly code and its tables into RAM, and the mailbox where it has a memory of its own.
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
    /// As these, of the mailbox.
    static _mailbox_load: u32;
    static mut _mailbox_start: u32;
    static _mailbox_end: u32;
}

/// Copies code, tables and mailbox. Call it before the mailbox is used and after embassy's `init`, which resets SYSCFG.
pub(crate) fn load() {
    // SYSCFG_MEMRMP.MEM_MODE = 11: SRAM1 at address 0 (RM0090 9.2.1). VTOR keeps the vectors in the flash.
    #[cfg(feature = "sram-at-zero")]
    pac::SYSCFG.memrm().modify(|w| w.set_mem_mode(0b11));
    let sections = [
        (&raw const _fast_load, &raw mut _fast_start, &raw const _fast_end),
        (&raw const _mailbox_load, &raw mut _mailbox_start, &raw const _mailbox_end),
    ];
    for (from, to, end) in sections {
        let bytes = end.addr().saturating_sub(to.addr());
        // SAFETY: the linker script gives the section this size, in the flash and in RAM, both aligned to eight bytes. They
        // do not overlap, and nothing reads, writes or runs the copy before this function returns.
        unsafe { core::ptr::copy_nonoverlapping(from, to, bytes / size_of::<u32>()) };
    }
    // The stores are complete before the first instruction is fetched from there (ARMv7-M A3.8.3).
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
