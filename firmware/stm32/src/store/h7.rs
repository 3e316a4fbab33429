//! The H7's flash: a double error ends in a bus fault (RM0433, DBECCERR).
//!
//! With FAULTMASK and CCR.BFHFNMIGN set, the processor ignores data bus faults (ARMv7-M B3.2.8): the read returns
//! anything, and DBECCERR in the flash's status shows the error.

use cortex_m::peripheral::SCB;
use embassy_stm32::pac::FLASH;

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
