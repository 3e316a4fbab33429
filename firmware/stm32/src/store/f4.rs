//! The F4's flash. It has no error correction, so a read needs no guard; its data cache must be emptied.

use embassy_stm32::pac::FLASH;
use embassy_stm32::pac::flash::vals::Psize;

// FLASH_OPTCR (RM0090 3.9.9): its lock, its start, BOR_LEV, RDP from bit 8 on; all but the first two are option bits.
const OPTLOCK: u32 = 1 << 0;
const OPTSTRT: u32 = 1 << 1;
pub(super) const BROWN_OUT: u32 = 0b11 << 2;
const RDP: u32 = 8;
/// FLASH_SR: end of operation and all errors, cleared by writing 1 (RM0090 3.9.5).
const RESULTS: u32 = 0b1111_0011;
const ERRORS: u32 = RESULTS & !1;

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

/// The option bits of FLASH_OPTCR, which has them from the flash since the reset.
pub(super) fn options() -> u32 {
    FLASH.optcr().read().0 & !(OPTLOCK | OPTSTRT)
}

/// BOR_LEV counts down: 00 is level 3, 11 is off (RM0090 3.9.9).
pub(super) const fn level_of(options: u32) -> u8 {
    3 - ((options & BROWN_OUT) >> 2) as u8
}

pub(super) const fn bits_of(level: u8) -> u32 {
    (3 - level as u32) << 2
}

pub(super) const fn read_protection_of(options: u32) -> u8 {
    (options >> RDP) as u8
}

/// Writes the option bits (RM0090 3.6.5); returns whether the flash reports no error. It erases their sector first, and then writes all
/// of them.
pub(super) fn write_options(keys: [u32; 2], wanted: u32) -> bool {
    FLASH.sr().write(|w| w.0 = RESULTS);
    if FLASH.optcr().read().0 & OPTLOCK != 0 {
        for key in keys {
            FLASH.optkeyr().write_value(key);
        }
    }
    FLASH.optcr().write(|w| w.0 = wanted);
    FLASH.optcr().write(|w| w.0 = wanted | OPTSTRT);
    while FLASH.sr().read().bsy() {}
    let has_failed = FLASH.sr().read().0 & ERRORS != 0;
    FLASH.optcr().write(|w| w.0 = wanted | OPTLOCK);
    !has_failed
}

/// Nothing to do: the release of any reset loads FLASH_OPTCR from the flash (RM0090 3.9.9).
pub(super) const fn load_options(_: [u32; 2]) {}
