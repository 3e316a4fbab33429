//! The F4's flash: no error correction, so there is nothing to guard, and a data cache to empty.

use embassy_stm32::pac::FLASH;

pub(super) fn guard(read: impl FnOnce() -> bool) -> bool {
    read()
}

pub(super) const fn forget_old_errors() {}

/// The data cache still holds what it has read of a sector before its erasure (RM0090 Rev 21, 3.6.4), and
/// embassy-stm32 0.6 empties it on chips with two banks only. It is reset while it is off.
pub(super) fn forget_cached() {
    let access = FLASH.acr();
    access.modify(|w| w.set_dcen(false));
    access.modify(|w| w.set_dcrst(true));
    access.modify(|w| w.set_dcrst(false));
    access.modify(|w| w.set_dcen(true));
}
