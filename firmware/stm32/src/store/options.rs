//! The level of the brown-out reset, in the chip's option bytes.
//!
//! ```text
//! before ----> wanted = before, with other bits of BOR_LEV ----> one start ----> read back ----> a restart loads them
//! ```
//! Nothing but BOR_LEV changes: a byte of read protection that became 0xCC would lock the chip for ever. While the option bytes are
//! written the F407's processor stops, as in an erasure of its flash, so the watchdog's period is that of an erasure. What a power cut
//! inside the write leaves is in BOARDS.md.

use slipline_app::ports::{BrownOut, FlashError};

use super::chip;
use crate::{board, dac, watchdog};

/// The keys of FLASH_OPTKEYR, the same on all three chips (RM0090 3.6.5, RM0440 3.4.2, RM0433 FLASH_OPTKEYR).
const KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];

/// Whether the level is set as the board needs it.
pub(crate) fn is_brown_out_guarded() -> bool {
    brown_out_level() >= board::BROWN_OUT_LEVEL
}

/// The level that is set, counted from the lowest threshold.
pub(crate) fn brown_out_level() -> u8 {
    chip::level_of(chip::options())
}

/// That, and the register that it is in.
pub(crate) fn brown_out() -> BrownOut {
    let options = chip::options();
    BrownOut {
        level: chip::level_of(options),
        needed: board::BROWN_OUT_LEVEL,
        options,
        read_protection: chip::read_protection_of(options),
        restarts: false,
    }
}

/// Writes the level that the board needs.
pub(crate) fn raise_brown_out_level() -> Result<(), FlashError> {
    let wanted = chip::options() & !chip::BROWN_OUT | chip::bits_of(board::BROWN_OUT_LEVEL);
    watchdog::lengthen();
    let is_written = dac::paused(|| chip::write_options(KEYS, wanted));
    if is_written && chip::options() == wanted { Ok(()) } else { Err(FlashError) }
}

/// Loads the option bytes from the flash, where a reset alone does not: resets the chip then. Interrupts are off.
pub(crate) fn load_options() {
    chip::load_options(KEYS);
}
