//! Faults on purpose, by which a board shows that each of them mutes: the program fails, and watches the mute pin until the reset.

use slipline_app::ports::OrderedFault;

use crate::{board, crash, guard, pin_watch};

/// Cycles between two looks, at most: 5 us, far below each time of `firmware/SAFETY.md`.
const BETWEEN_LOOKS: u32 = board::CORE_HZ / 200_000;

/// Fails in this way.
#[inline(never)]
pub(crate) fn fail(fault: OrderedFault) -> ! {
    crash::order(fault);
    pin_watch::begin();
    match fault {
        OrderedFault::Hang => {}
        OrderedFault::MaskedInterrupts => cortex_m::interrupt::disable(),
        OrderedFault::StackOverflow => overflow(),
    }
    loop {
        pin_watch::look();
        cortex_m::asm::delay(BETWEEN_LOOKS);
    }
}

/// Lets the stack overflow: the next word would lie in the guard.
fn overflow() -> ! {
    // SAFETY: never returns. The guard refuses the store, and the hard fault's handler begins with a new stack.
    unsafe {
        core::arch::asm!(
            "msr msp, {bottom}",
            "push {{r0, r1, r2, r3}}",
            "udf #0",
            bottom = in(reg) guard::stack_bottom(),
            options(noreturn)
        )
    }
}
