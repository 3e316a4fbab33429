//! Who may interrupt whom.
//!
//! All three chips have 16 levels (`__NVIC_PRIO_BITS` = 4); a lower number is served first.
//!
//! | level | who | longest stay | why here |
//! |---|---|---|---|
//! | 1 | DAC's DMA stream, DAC underrun, supply dip | one ramp of a block, about 1 % of a block | the ring's deadline, and muting |
//! | 2 | UART bytes (boards without USB) | one byte, under 2 us | 10.9 us per byte at 921600 baud; a rendered block may take longer |
//! | 3 | renderer (interrupt executor) | one block, under half the block's period | above everything that may take long |
//! | 4 | time driver | a few us | wakes thread tasks only |
//! | 5 | USB | one packet | may wait: the host gets NAK |
//! | thread | session, USB control, supervisor, flash | unbounded | nothing waits for it but the host and the watchdog |
//!
//! Critical sections mask all of them; in the code used here the longest are a few dozen instructions.

use embassy_stm32::interrupt::Priority;

/// The DAC's DMA stream, its underrun, and the supply's dip.
pub(crate) const DAC: Priority = Priority::P1;
/// The link's UART.
#[cfg(feature = "link-uart")]
pub(crate) const UART: Priority = Priority::P2;
/// The renderer's executor.
pub(crate) const RENDERER: Priority = Priority::P3;
/// embassy-time's timer.
pub(crate) const TIME: Priority = Priority::P4;
/// The USB core.
#[cfg(feature = "link-usb")]
pub(crate) const USB: Priority = Priority::P5;
