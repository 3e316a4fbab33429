//! The G4's flash: a double error sets FLASH_ECCR.ECCD and raises the NMI (RM0440 3.3.2).
//!
//! Only while a word is read by `guard` is that forgiven: a torn word of the program itself ends in the fault handler.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use cortex_m_rt::exception;
use embassy_stm32::pac::FLASH;

static GUARDED: AtomicBool = AtomicBool::new(false);
static TORN: AtomicBool = AtomicBool::new(false);

pub(super) fn guard(read: impl FnOnce() -> bool) -> bool {
    // ECCD rises only while no other error stands (RM0440 3.7.7): a corrected one is forgotten first.
    FLASH.eccr().modify(|w| w.set_eccc(true));
    TORN.store(false, Relaxed);
    GUARDED.store(true, Relaxed);
    let done = read();
    cortex_m::asm::dsb();
    GUARDED.store(false, Relaxed);
    done && !TORN.load(Relaxed)
}

/// embassy clears them itself.
pub(super) const fn forget_old_errors() {}

#[exception]
unsafe fn NonMaskableInt() {
    let is_torn = FLASH.eccr().read().eccd();
    // ECCD is cleared by writing 1.
    FLASH.eccr().modify(|w| w.set_eccd(true));
    if is_torn && GUARDED.load(Relaxed) {
        TORN.store(true, Relaxed);
    } else {
        panic!("NMI: flash error {is_torn}");
    }
}

/// Nothing to do: embassy empties the data cache itself.
pub(super) const fn forget_cached() {}
