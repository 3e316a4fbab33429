//! The supply detector: it mutes the amplifier when the supply dips, before the brown-out reset comes.
//!
//! There are two protections. The supply detector (PVD) trips at 2.66 to 2.90 V, as the board's own supply allows, and
//! its interrupt mutes at once: below this voltage the DAC's reference and the amplifier's logic are out of their
//! range. On the G474 and the H743 it also breaks the mute timer's output in hardware, as a core does that has locked up. The brown-out reset (BOR) holds the chip in reset while the supply is too low to run from flash. Its level is
//! an option byte, set once per board (BOARDS.md). If it is not set the lamp shows it, and the device reports it to the
//! host, which asks its user before it arms.

use crate::board;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::pac::EXTI;

/// The detector's output is this line of EXTI on all three chips; it rises when the supply falls.
const LINE: usize = 16;

/// Starts the detector and its interrupt.
pub(crate) fn watch() {
    board::start_supply_detector();
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    board::SUPPLY_INTERRUPT.set_priority(crate::priority::DAC);
    // SAFETY: the handler only writes registers; nothing it needs is set up later.
    unsafe { board::SUPPLY_INTERRUPT.enable() };
}

/// The detector's interrupt. The program cannot know how far the supply will fall, so it mutes and resets; the next
/// hello reports the cause, brown-out.
pub(crate) fn on_dip() {
    // Cleared by writing 1.
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    crate::crash::reset_for_brown_out();
}
