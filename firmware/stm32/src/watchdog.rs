//! The independent watchdog: short, except while the flash is erased.
//!
//! Its oscillator is its own and not exact. The short period is at least twice the supervisor's in the fastest case.
//! `Store::erase` makes it long, since the erasure of a sector stops the thread, on the F407 the whole processor; the
//! supervisor makes it short again when it feeds it next.
//!
//! embassy-stm32's driver has no way to change the period, so the registers are written here. Only the reload value
//! changes; the prescaler is the board's, such that both periods fit.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_stm32::pac::iwdg::vals::{Key, Pr};

use crate::board::{self, WATCHDOG};

/// The supervisor's period. It runs once per step of the lamp's pattern.
pub(crate) const SUPERVISION_MS: u32 = 100;
/// The oscillator's nominal frequency.
const NOMINAL_HZ: u32 = 32_000;
/// The nominal period.
const PERIOD_MS: u32 = 300;

// With the fastest oscillator that the board's data sheet allows, two of the supervisor's turns still fit.
const _: () = assert!(PERIOD_MS * NOMINAL_HZ / board::WATCHDOG_FASTEST_HZ >= 2 * SUPERVISION_MS);

/// The reload value of a nominal period.
const fn reload(milliseconds: u32) -> u16 {
    let counts = milliseconds * (NOMINAL_HZ / 1000) / board::WATCHDOG_PRESCALER;
    assert!(counts >= 1 && counts <= 0x1000, "the counter has twelve bits");
    (counts - 1) as u16
}

const SHORT: u16 = reload(PERIOD_MS);
const LONG: u16 = reload(board::ERASURE_WATCHDOG_MS);

/// Whether the long period is in force.
static IS_LONG: AtomicBool = AtomicBool::new(false);

/// Starts the watchdog with its short period. Nothing but a reset stops it.
pub(crate) fn start() {
    // Dividers 4 to 256 are numbered from 0.
    let divider = board::WATCHDOG_PRESCALER.trailing_zeros() - 2;
    WATCHDOG.kr().write(|w| w.set_key(Key::START));
    WATCHDOG.kr().write(|w| w.set_key(Key::ENABLE));
    WATCHDOG.pr().write(|w| w.set_pr(Pr::from_bits(divider as u8)));
    set_reload(SHORT);
}

/// Feeds it, and makes its period short again.
pub(crate) fn feed() {
    if IS_LONG.load(Relaxed) {
        IS_LONG.store(false, Relaxed);
        set_reload(SHORT);
    } else {
        WATCHDOG.kr().write(|w| w.set_key(Key::RESET));
    }
}

/// Makes its period long enough for an erasure and the writing after it, and feeds it. From the thread only.
pub(crate) fn lengthen() {
    IS_LONG.store(true, Relaxed);
    set_reload(LONG);
}

/// Changes the reload value and feeds. What was written before must have reached the oscillator's side, and what is
/// written now must reach it before the counter is loaded: some cycles of the oscillator (RM0090 21.4.4). Should that
/// never happen, the watchdog ends the wait.
fn set_reload(value: u16) {
    WATCHDOG.kr().write(|w| w.set_key(Key::ENABLE));
    while is_busy() {}
    WATCHDOG.rlr().write(|w| w.set_rl(value));
    while is_busy() {}
    WATCHDOG.kr().write(|w| w.set_key(Key::RESET));
}

fn is_busy() -> bool {
    let status = WATCHDOG.sr().read();
    status.pvu() || status.rvu()
}
