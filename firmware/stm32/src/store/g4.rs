//! The G4's flash: a double error sets FLASH_ECCR.ECCD and raises the NMI (RM0440 3.3.2).
//!
//! While `guard` reads a word, the NMI's handler notes the error and returns. At any other time the program ends: then
//! the torn word is one of its own.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use embassy_stm32::pac::FLASH;

use crate::board;

// FLASH_CR (RM0440 3.7.5).
const OPTSTRT: u32 = 1 << 17;
const OBL_LAUNCH: u32 = 1 << 27;
const OPTLOCK: u32 = 1 << 30;
const LOCK: u32 = 1 << 31;
// FLASH_OPTR (RM0440 3.7.8): BOR_LEV; RDP is its lowest byte.
pub(super) const BROWN_OUT: u32 = 0b111 << 8;
/// FLASH_SR: end of operation and all errors, cleared by writing 1 (RM0440 3.7.4).
const RESULTS: u32 = 0xc3fb;
const ERRORS: u32 = RESULTS & !1;

static GUARDED: AtomicBool = AtomicBool::new(false);
static TORN: AtomicBool = AtomicBool::new(false);

pub(super) fn guard(read: impl FnOnce() -> bool) -> bool {
    // ECCD is set only while no other error is flagged (RM0440 3.7.7), so the flag of a corrected one is cleared first.
    FLASH.eccr().modify(|w| w.set_eccc(true));
    TORN.store(false, Relaxed);
    GUARDED.store(true, Relaxed);
    let done = read();
    cortex_m::asm::dsb();
    GUARDED.store(false, Relaxed);
    done && !TORN.load(Relaxed)
}

/// Nothing to do: embassy clears the error flags itself.
pub(super) const fn forget_old_errors() {}

/// Notes a torn word while one is read; an error if the NMI came at any other time.
pub(crate) fn on_nmi() -> Result<(), &'static str> {
    let is_torn = FLASH.eccr().read().eccd();
    // ECCD is cleared by writing 1.
    FLASH.eccr().modify(|w| w.set_eccd(true));
    if is_torn && GUARDED.load(Relaxed) {
        TORN.store(true, Relaxed);
        Ok(())
    } else if is_torn {
        Err("a torn word in the program's flash")
    } else {
        Err("unexpected NMI")
    }
}

/// Nothing to do: embassy empties the data cache itself.
pub(super) const fn forget_cached() {}

/// Nothing to do: an erasure has one speed.
pub(super) const fn widen_erasures() {}

/// FLASH_OPTR.
pub(super) fn options() -> u32 {
    FLASH.optr().read().0
}

/// BOR_LEV counts up: 000 is 1.7 V, 100 is level 4 (RM0440 3.7.8).
pub(super) const fn level_of(options: u32) -> u8 {
    ((options & BROWN_OUT) >> 8) as u8
}

pub(super) const fn bits_of(level: u8) -> u32 {
    (level as u32) << 8
}

pub(super) const fn read_protection_of(options: u32) -> u8 {
    options as u8
}

/// FLASH_CR's option bits are behind both locks. A key that is written to an open lock would close it until the next reset.
fn unlock(keys: [u32; 2]) {
    if FLASH.cr().read().0 & LOCK != 0 {
        FLASH.keyr().write_value(0x4567_0123);
        FLASH.keyr().write_value(0xcdef_89ab);
    }
    if FLASH.cr().read().0 & OPTLOCK != 0 {
        for key in keys {
            FLASH.optkeyr().write_value(key);
        }
    }
}

/// Writes the option bytes (RM0440 3.4.2); returns whether the flash reports no error. It erases all of them first, and then writes
/// them from its registers. They are loaded by OBL_LAUNCH or a power-on.
pub(super) fn write_options(keys: [u32; 2], wanted: u32) -> bool {
    while FLASH.sr().read().bsy() {}
    FLASH.sr().write(|w| w.0 = RESULTS);
    unlock(keys);
    FLASH.optr().write(|w| w.0 = wanted);
    FLASH.cr().modify(|w| w.0 |= OPTSTRT);
    while FLASH.sr().read().bsy() {}
    let has_failed = FLASH.sr().read().0 & ERRORS != 0;
    FLASH.cr().modify(|w| w.0 |= OPTLOCK | LOCK);
    !has_failed
}

/// Loads the option bytes, which resets the chip (RM0440 3.4.2, 7.1.2): a system reset alone does not load them. Should it not come within
/// 10 ms, the caller's reset does.
pub(super) fn load_options(keys: [u32; 2]) {
    unlock(keys);
    FLASH.cr().modify(|w| w.0 |= OBL_LAUNCH);
    cortex_m::asm::delay(board::CORE_HZ / 100);
}
