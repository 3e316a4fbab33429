//! The G4's flash: a double error sets FLASH_ECCR.ECCD and raises the NMI (RM0440 3.3.2).
//!
//! While `guard` reads a word, the NMI's handler notes the error and returns. At any other time the program ends: then
//! the torn word is one of its own.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use embassy_stm32::pac::FLASH;

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
