//! The F4's flash. It has no error correction, so a read needs no guard; its data cache must be emptied.

use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::vals::Psize;

pub(super) fn guard(read: impl FnOnce() -> bool) -> bool {
    read()
}

pub(super) const fn forget_old_errors() {}

/// Erasures go 32 bits at a time, as the board's supply of 2.7 V or more allows (RM0090 3.6.2, DS8626 table 40): a sector of 128 KiB
/// then takes 2 s at most, where 8 bits at a time take 4 s. embassy-stm32 0.6 erases with FLASH_CR.PSIZE as it finds it, and unlocks
/// the register only if that is locked.
pub(super) fn widen_erasures() {
    if FLASH.cr().read().lock() {
        FLASH.keyr().write_value(0x4567_0123);
        FLASH.keyr().write_value(0xcdef_89ab);
    }
    FLASH.cr().modify(|w| w.set_psize(Psize::PSIZE32));
}

/// After an erasure the data cache still holds what it read of the sector before (RM0090 Rev 21, 3.6.4), and
/// embassy-stm32 0.6 empties it only on chips with two banks. The cache can be reset only while it is off.
pub(super) fn forget_cached() {
    let access = FLASH.acr();
    access.modify(|w| w.set_dcen(false));
    access.modify(|w| w.set_dcrst(true));
    access.modify(|w| w.set_dcrst(false));
    access.modify(|w| w.set_dcen(true));
}

/// What the NMI means to the flash: nothing.
pub(crate) fn on_nmi() -> Result<(), &'static str> {
    Err("unexpected NMI")
}
