//! The H7's flash: a double error ends in a bus fault (RM0433, DBECCERR).
//!
//! With FAULTMASK and CCR.BFHFNMIGN set, the processor ignores data bus faults (ARMv7-M B3.2.8): the read returns
//! anything, and DBECCERR in the flash's status shows the error.

use cortex_m::peripheral::SCB;
use embassy_stm32::pac::FLASH;

// FLASH_OPTCR, FLASH_OPTSR_CUR and FLASH_OPTSR_PRG (RM0433 4.9.7 to 4.9.9).
const OPTLOCK: u32 = 1 << 0;
const OPTSTART: u32 = 1 << 1;
pub(super) const BROWN_OUT: u32 = 0b11 << 2;
const RDP: u32 = 8;
const OPT_BUSY: u32 = 1 << 0;
const OPTCHANGEERR: u32 = 1 << 30;

/// CCR bit 8.
const BFHFNMIGN: u32 = 1 << 8;

pub(super) fn guard(read: impl FnOnce() -> bool) -> bool {
    let bank = FLASH.bank(1);
    bank.ccr().write(|w| w.set_clr_dbeccerr(true));
    // SAFETY: CCR is written in thread mode only; FAULTMASK masks every other handler until it is cleared again, for
    // the time of eight loads.
    let done = unsafe {
        (*SCB::PTR).ccr.modify(|ccr| ccr | BFHFNMIGN);
        core::arch::asm!("cpsid f", "dsb", "isb");
        let done = read();
        core::arch::asm!("dsb", "cpsie f", "isb");
        (*SCB::PTR).ccr.modify(|ccr| ccr & !BFHFNMIGN);
        done
    };
    let is_torn = bank.sr().read().dbeccerr();
    bank.ccr().write(|w| w.set_clr_dbeccerr(true));
    done && !is_torn
}

/// A corrected bit or a speculative read of a protected place sets a flag in FLASH_SR2, which only a write to
/// FLASH_CCR2 clears (RM0433). embassy-stm32 0.6 writes to FLASH_SR2 instead, and takes an old flag for an error of the
/// next erasure or write.
pub(super) fn forget_old_errors() {
    FLASH.bank(1).ccr().write(|w| {
        w.set_clr_eop(true);
        w.set_clr_wrperr(true);
        w.set_clr_pgserr(true);
        w.set_clr_strberr(true);
        w.set_clr_incerr(true);
        w.set_clr_operr(true);
        w.set_clr_rdperr(true);
        w.set_clr_rdserr(true);
        w.set_clr_sneccerr(true);
        w.set_clr_dbeccerr(true);
    });
}

/// Nothing to do: the data cache is off.
pub(super) const fn forget_cached() {}

/// What the NMI means to the flash: nothing.
pub(crate) fn on_nmi() -> Result<(), &'static str> {
    Err("unexpected NMI")
}

/// Nothing to do: an erasure has one speed.
pub(super) const fn widen_erasures() {}

/// FLASH_OPTSR_CUR, without its two flags.
pub(super) fn options() -> u32 {
    FLASH.optsr_cur().read().0 & !(OPT_BUSY | OPTCHANGEERR)
}

/// BOR_LEV counts up: 00 is off, 11 is level 3 (RM0433, FLASH_OPTSR_CUR).
pub(super) const fn level_of(options: u32) -> u8 {
    ((options & BROWN_OUT) >> 2) as u8
}

pub(super) const fn bits_of(level: u8) -> u32 {
    (level as u32) << 2
}

pub(super) const fn read_protection_of(options: u32) -> u8 {
    (options >> RDP) as u8
}

/// Writes the option bytes (RM0433 4.4.3); returns whether the flash reports no error. Option bytes outside FLASH_OPTSR_PRG are
/// written as their own registers hold them since the reset. An old error would refuse the start, so it is cleared first.
pub(super) fn write_options(keys: [u32; 2], wanted: u32) -> bool {
    FLASH.optccr().write(|w| w.0 = OPTCHANGEERR);
    if FLASH.optcr().read().0 & OPTLOCK != 0 {
        for key in keys {
            FLASH.optkeyr().write_value(key);
        }
    }
    // The bits that PRG lacks (PERSO_OK) stay as they are in it.
    FLASH.optsr_prg().modify(|w| w.0 = w.0 & !BROWN_OUT | wanted & BROWN_OUT);
    FLASH.optcr().modify(|w| w.0 |= OPTSTART);
    while FLASH.optsr_cur().read().0 & OPT_BUSY != 0 {}
    let has_failed = FLASH.optsr_cur().read().0 & OPTCHANGEERR != 0;
    FLASH.optcr().modify(|w| w.0 |= OPTLOCK);
    !has_failed
}

/// Nothing to do: FLASH_OPTSR_CUR has them at the end of the write (RM0433 4.4.3).
pub(super) const fn load_options(_: [u32; 2]) {}
