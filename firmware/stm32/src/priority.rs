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
//! Critical sections mask all of them. The longest after the start, counted on the register-level board by a test
//! (`tests/board/test_speed.py`): masked for at most 269 cycles, 1.6 us at 168 MHz, in embassy's time driver when it sets
//! an alarm. The copy of a packet into the USB core's FIFO takes 182 cycles. The application's own longest is 134 cycles:
//! the mailbox copies a report or the renderer's orders, never a motion (see `slipline_app::mailbox`).
//!
//! What waits meanwhile has more time: the DMA's interrupt one block (320 us), and bytes on the UART lie in its receive
//! FIFO, which embassy switches on: eight bytes on the G474 (RM0440, 37.5.4), that is 8 x 10.9 us = 87 us.

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
