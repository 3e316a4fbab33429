//! The interrupts' priorities.
//!
//! All three chips have 16 levels (`__NVIC_PRIO_BITS` = 4); a lower number is served first.
//!
//! | level | interrupt | longest run | reason |
//! |---|---|---|---|
//! | 1 | DAC's DMA stream, DAC underrun, supply dip | one line over a block, about 2 % of a block | the ring's deadline, and muting |
//! | 2 | UART (boards without USB) | under 1 us | a damaged byte is to be taken away before the next is whole, 10.8 us later |
//! | 3 | renderer (interrupt executor) | one block, under half the block's period | above everything that may take long |
//! | 4 | time driver | a few us | wakes thread tasks only |
//! | 5 | USB | one packet | may wait: the host gets NAK |
//! | 5 | the UART's two ways of the DMA (boards without USB) | a few us | wake the link only: the DMA moves the bytes |
//! | thread | session, USB control, supervisor, flash | unbounded | only the host and the watchdog wait for it |
//!
//! Critical sections mask all of them. A test measures the longest after the start on the register-level board
//! (`tests/board/test_speed.py`): at most 269 cycles, 1.6 us at 168 MHz, in embassy's time driver when it sets an
//! alarm. The copy of a packet into the USB core's FIFO takes 182 cycles. The application's own longest section takes
//! 134 cycles: the mailbox copies a report or the renderer's orders, never a motion (see `slipline_app::mailbox`).
//!
//! The masked interrupts can wait longer than that: the DMA's one block (320 us), and the mute pin falls by itself if it
//! waits for longer than 4 ms (`mute`).

use embassy_stm32::interrupt::Priority;

/// The DAC's DMA stream, its underrun, and the supply detector.
pub(crate) const DAC: Priority = Priority::P1;
/// The renderer's executor.
pub(crate) const RENDERER: Priority = Priority::P3;
/// embassy-time's timer.
pub(crate) const TIME: Priority = Priority::P4;
/// The USB core.
#[cfg(feature = "link-usb")]
pub(crate) const USB: Priority = Priority::P5;
/// The link's UART.
#[cfg(feature = "link-uart")]
pub(crate) const UART: Priority = Priority::P2;
/// What wakes the link: its two ways of the DMA.
#[cfg(feature = "link-uart")]
pub(crate) const UART_WAKES: Priority = Priority::P5;
