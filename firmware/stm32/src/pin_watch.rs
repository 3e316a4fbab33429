//! The mute pin, watched by a program that fails on purpose, or by the handler of its fault: when it went low, for the next start.
//!
//! That lies in RAM that no start-up code clears. One store of a word is whole, wherever the reset comes. What it means the record of
//! `crash` says, which names the ordered fault.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use cortex_m::peripheral::DWT;
use slipline_app::ports::{FaultEnd, OrderedFault, PinLevel};

use crate::{board, mute};

/// The cycle counter at the fault's begin.
// SAFETY: any 32 bits are a count.
#[unsafe(link_section = ".uninit.fault_begun")]
static BEGUN: AtomicU32 = AtomicU32::new(0);

/// Cycles from there to the look that found the pin low, with [`IS_LOW`]; before it, to the last look.
// SAFETY: any 32 bits are a count.
#[unsafe(link_section = ".uninit.fault_seen")]
static SEEN: AtomicU32 = AtomicU32::new(0);
/// The watchdog resets the chip within 0.6 s, 240 million cycles.
const IS_LOW: u32 = 1 << 31;

/// Looks at a pin that was switched off a moment ago: an input register shows its pin some cycles late.
const LOOKS: u32 = 100;

/// The fault begins now.
pub(crate) fn begin() {
    SEEN.store(0, Relaxed);
    BEGUN.store(DWT::cycle_count(), Relaxed);
}

/// Looks at the pin once; whether it has been low.
pub(crate) fn look() -> bool {
    let seen = SEEN.load(Relaxed);
    if seen & IS_LOW == 0 {
        let cycles = DWT::cycle_count().wrapping_sub(BEGUN.load(Relaxed)) & !IS_LOW;
        let low = if mute::level() == PinLevel::Low { IS_LOW } else { 0 };
        SEEN.store(cycles | low, Relaxed);
        return low != 0;
    }
    true
}

/// Looks at the pin in a handler that has switched it off. Without an ordered fault nobody reads what it finds.
pub(crate) fn look_after_silence() {
    for _ in 0..LOOKS {
        if look() {
            break;
        }
    }
}

/// How this fault ended, which the last run was ordered to make.
pub(crate) fn end_of(fault: OrderedFault) -> FaultEnd {
    let seen = SEEN.load(Relaxed);
    FaultEnd {
        fault,
        muted_after_us: (seen & !IS_LOW) / (board::CORE_HZ / 1_000_000),
        by_reset: seen & IS_LOW == 0,
    }
}
