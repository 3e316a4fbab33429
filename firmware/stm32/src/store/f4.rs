//! The F4's flash. It has no error correction, so a read needs no guard; its data cache must be emptied.

use embassy_stm32::pac::FLASH;

pub(super) fn guard(read: impl FnOnce() -> bool) -> bool {
    read()
}

pub(super) const fn forget_old_errors() {}

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
