//! The two flash slots the application keeps its settings in.
//!
//! The application writes only when it is silent; this file still stops the DAC's triggers around every erasure and
//! write, because on the F407 (one bank) the processor stands still until the flash is ready again, and no interrupt
//! is served meanwhile. The sample index stands still with it, and nothing is counted as an underrun.
//!
//! A word that a power cut tore reads as anything on the F407, which has no error correction: the application's CRC
//! finds it. On the G474 it raises an NMI and on the H743 a bus fault (RM0440 Rev 9, 3.3.2; RM0433, DBECCERR): both are
//! caught here and become an error.

use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Flash};
use embassy_stm32::peripherals::FLASH;
use slipline_app::ports::{FLASH_WORD, FlashError, FlashPages, FlashSlot};

use crate::{board, dac};

/// The chip's flash, as far as the application sees it.
pub(crate) struct Store(Flash<'static, Blocking>);

impl Store {
    pub(crate) fn new(flash: Peri<'static, FLASH>) -> Self {
        Self(Flash::new_blocking(flash))
    }

    /// Offset of `length` bytes at `offset` of a slot from the start of the flash, if they lie inside it.
    fn place(slot: FlashSlot, offset: usize, length: usize) -> Result<u32, FlashError> {
        let inside = offset.checked_add(length).is_some_and(|end| end <= board::SLOT_BYTES);
        let [a, b] = board::FLASH_SLOTS;
        let base = match slot {
            FlashSlot::A => a,
            FlashSlot::B => b,
        };
        if inside {
            u32::try_from(offset).map(|offset| base + offset).map_err(|_| FlashError)
        } else {
            Err(FlashError)
        }
    }
}

impl FlashPages for Store {
    fn slot_len(&self) -> usize {
        board::SLOT_BYTES
    }

    fn erase(&mut self, slot: FlashSlot) -> Result<(), FlashError> {
        let from = Self::place(slot, 0, board::SLOT_BYTES)?;
        let to = from + board::SLOT_BYTES as u32;
        torn::forget_old_errors();
        let erased = dac::paused(|| self.0.blocking_erase(from, to)).map_err(|_| FlashError);
        #[cfg(feature = "board-f4discovery")]
        forget_cached();
        erased
    }

    fn write(&mut self, slot: FlashSlot, offset: usize, word: &[u8; FLASH_WORD]) -> Result<(), FlashError> {
        let at = Self::place(slot, offset, FLASH_WORD)?;
        torn::forget_old_errors();
        dac::paused(|| self.0.blocking_write(at, word)).map_err(|_| FlashError)
    }

    fn read(
        &mut self,
        slot: FlashSlot,
        offset: usize,
        word: &mut [u8; FLASH_WORD],
    ) -> Result<(), FlashError> {
        let at = Self::place(slot, offset, FLASH_WORD)?;
        let is_whole = torn::guard(|| self.0.blocking_read(at, word).is_ok());
        if is_whole { Ok(()) } else { Err(FlashError) }
    }
}

/// The F407's data cache still holds what it has read of a sector before its erasure (RM0090 Rev 21, 3.6.4), and
/// embassy-stm32 0.6 empties it on chips with two banks only. It is reset while it is off.
#[cfg(feature = "board-f4discovery")]
fn forget_cached() {
    let access = embassy_stm32::pac::FLASH.acr();
    access.modify(|w| w.set_dcen(false));
    access.modify(|w| w.set_dcrst(true));
    access.modify(|w| w.set_dcrst(false));
    access.modify(|w| w.set_dcen(true));
}

/// The F407's flash has no error correction: nothing to guard.
#[cfg(feature = "board-f4discovery")]
mod torn {
    pub(super) fn guard(read: impl FnOnce() -> bool) -> bool {
        read()
    }

    pub(super) const fn forget_old_errors() {}
}

/// A double error sets FLASH_ECCR.ECCD and raises the NMI (RM0440 3.3.2). Only then is ECCD cleared here, so a torn
/// word of the program itself, read outside this guard, ends in the fault handler.
#[cfg(feature = "board-nucleo-g474re")]
mod torn {
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
}

/// A double error ends in a bus fault (RM0433, DBECCERR). With FAULTMASK set and CCR.BFHFNMIGN, data bus faults are
/// ignored (ARMv7-M B3.2.8): the read returns anything and the flash's status says that it did.
#[cfg(feature = "board-nucleo-h743zi2")]
mod torn {
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

    /// A corrected bit or a speculative read of a protected place leaves a flag in FLASH_SR2 that stands until it is
    /// cleared in FLASH_CCR2 (RM0433), and embassy-stm32 0.6, which writes FLASH_SR2 instead, takes it
    /// for an error of the next erasure or write.
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
}
