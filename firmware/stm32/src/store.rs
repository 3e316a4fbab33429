//! The flash slots of the stored table and of the actuator's profile; `options` has the chip's option bytes.
//!
//! The application writes only when the device is disarmed and the renderer has muted the amplifier. This file still
//! stops the DAC's triggers around every erasure and write: the F407 has one bank, so the processor stops until the
//! flash is ready again and serves no interrupt. The sample index stands still meanwhile, and nothing is counted as an
//! underrun.
//!
//! A word is torn when the power fails while it is written. A torn word reads as anything on the F407, which has no
//! error correction: the application's CRC finds it. On the G474 it raises an NMI and on the H743 a bus fault (RM0440
//! Rev 9, 3.3.2; RM0433, DBECCERR): `chip` (one file for each family's flash) catches both and returns an error.

#[cfg_attr(feature = "flash-f4", path = "store/f4.rs")]
#[cfg_attr(feature = "flash-g4", path = "store/g4.rs")]
#[cfg_attr(feature = "flash-h7", path = "store/h7.rs")]
#[cfg_attr(feature = "flash-h7", expect(unsafe_code, reason = "listed in firmware/UNSAFE.md"))]
mod chip;
mod options;

use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Flash};
use embassy_stm32::peripherals::FLASH;
use slipline_app::ports::{FLASH_WORD, FlashError, FlashPages, FlashSlot};

pub(crate) use self::chip::on_nmi;
pub(crate) use self::options::{
    brown_out, brown_out_level, is_brown_out_guarded, load_options, raise_brown_out_level,
};
use crate::{board, dac, watchdog};

/// Erasures of each sector or page that the data sheets promise over the whole range of temperature: the least in the
/// tables "Flash memory endurance and data retention" of DS8626 (F407), DS12288 (G474) and DS12110 (H743).
const ENDURANCE: u32 = 10_000;

/// The slots in the chip's flash.
pub(crate) struct Store(Flash<'static, Blocking>);

impl Store {
    pub(crate) fn new(flash: Peri<'static, FLASH>) -> Self {
        Self(Flash::new_blocking(flash))
    }

    /// Where a slot begins, as an offset from the start of the flash, and its bytes.
    const fn slot(slot: FlashSlot) -> (u32, usize) {
        let [a, b] = board::FLASH_SLOTS;
        let [profile_a, profile_b] = board::PROFILE_SLOTS;
        match slot {
            FlashSlot::A => (a, board::SLOT_BYTES),
            FlashSlot::B => (b, board::SLOT_BYTES),
            FlashSlot::ProfileA => profile_a,
            FlashSlot::ProfileB => profile_b,
        }
    }

    /// The offset from the start of the flash of `length` bytes at `offset` of a slot; an error if they do not fit into
    /// the slot.
    fn place(slot: FlashSlot, offset: usize, length: usize) -> Result<u32, FlashError> {
        let (base, bytes) = Self::slot(slot);
        let inside = offset.checked_add(length).is_some_and(|end| end <= bytes);
        if inside {
            u32::try_from(offset).map(|offset| base + offset).map_err(|_| FlashError)
        } else {
            Err(FlashError)
        }
    }
}

impl FlashPages for Store {
    fn slot_len(&self, slot: FlashSlot) -> usize {
        Self::slot(slot).1
    }

    fn endurance(&self) -> u32 {
        ENDURANCE
    }

    fn erase(&mut self, slot: FlashSlot) -> Result<(), FlashError> {
        let (from, bytes) = Self::slot(slot);
        let to = from + bytes as u32;
        chip::forget_old_errors();
        chip::widen_erasures();
        watchdog::lengthen();
        let erased = dac::paused(|| self.0.blocking_erase(from, to)).map_err(|_| FlashError);
        chip::forget_cached();
        erased
    }

    fn write(&mut self, slot: FlashSlot, offset: usize, word: &[u8; FLASH_WORD]) -> Result<(), FlashError> {
        let at = Self::place(slot, offset, FLASH_WORD)?;
        chip::forget_old_errors();
        dac::paused(|| self.0.blocking_write(at, word)).map_err(|_| FlashError)
    }

    fn read(
        &mut self,
        slot: FlashSlot,
        offset: usize,
        word: &mut [u8; FLASH_WORD],
    ) -> Result<(), FlashError> {
        let at = Self::place(slot, offset, FLASH_WORD)?;
        let is_whole = chip::guard(|| self.0.blocking_read(at, word).is_ok());
        if is_whole { Ok(()) } else { Err(FlashError) }
    }
}
