//! The link over a UART, which the board's ST-LINK shows to the host as a serial port.
//!
//! ```text
//! host --line--> USART --DMA, circular--> ring (`received`) --FromHost--> link
//! host <--line-- USART <--DMA, once a write-- buffer <--ToHost-- link
//! ```
//! 921600 baud, 8 data bits, no parity, one stop bit: the fastest rate that every ST-LINK firmware accepts. The frames
//! have their own CRC, so a byte lost by noise or by a full ring costs at most two frames.
//!
//! **No byte takes an interrupt** but one that is damaged. The others only wake the link: at the end of
//! a frame, whose last byte the USART compares with the delimiter; when the line rests; and when a reply has been handed over. A
//! reader that has found nothing enables the first two, so on a line without a pause one comes for each look that the link takes. A
//! byte is in memory some tens of cycles after its interrupt is raised; should that be later, the line's rest, the
//! next frame's end or the link's tick comes after it.
//!
//! **What is lost is counted.** Where bytes are missing the reader puts in [`DAMAGE`], which the link counts as a damaged frame: when the
//! ring was full, when the receiver had an overrun, and when a byte had no stop bit. It stands behind the bytes that came before the
//! error, so what comes right behind one, a stop above all, is a frame of its own.
//!
//! By the manual the DMA leaves a byte without its stop bit out and takes the next (CR3.DDRE = 0: USART_CR3 in RM0440 37.8). Linux' driver
//! (stm32-usart.c) finds the request masked until the flag is cleared or the byte is read by the program. No chip was looked at, so
//! the error's interrupt does what suits all: no requests, the flags cleared, the byte read, requests again
//! (`tests/board/core/uart.py` has each as a model). It must be done before the next byte is whole, 10.8 us later, so it ranks above the
//! renderer, and leaves the waking to one below it. The FIFO is off, for which alone Linux describes the mask: a byte waits 10.8 us for the DMA, which takes it in less than 1 us
//! (five transfers of DMA1 at most come before). A byte with noise would be an error, too, so a bit's middle sample alone
//! decides (ONEBIT, which the manual recommends for lines without noise; this one is some centimetres long): the frame's CRC finds what is
//! wrong.

use core::convert::Infallible;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU16, Ordering};
use core::task::Poll;

use embassy_executor::Spawner;
use embassy_stm32::gpio::Pull;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::usart::Config;
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io_async::{ErrorType, Read, Write};
use slipline_app::ports::UsbFrame;

use crate::board::{self, LINK_UART as UART, RECEIVE_WAY, SEND_WAY};
use crate::priority;
use crate::received::{RING, Received};

const BAUD: u32 = 921_600;
/// One complete frame, so that a reply is handed over at once.
const REPLY: usize = 256;
/// Stands where bytes are missing: ends the frame that they belonged to, which no frame's first code could (COBS, in the protocol's
/// `frame`).
const DAMAGE: [u8; 2] = [0xff, 0];

// Half of the ring comes in 2.8 ms at full rate: the thread side may be this late. Atomics, because the DMA writes the one and
// reads the other.
static RECEIVED: [AtomicU8; RING] = [const { AtomicU8::new(0) }; RING];
static SENT: [AtomicU8; REPLY] = [const { AtomicU8::new(0) }; REPLY];
/// The place in the ring before which the receiver's last error came, until the reader reaches it.
static LOST_AT: AtomicU16 = AtomicU16::new(NOWHERE);
const NOWHERE: u16 = u16::MAX;
/// The DMA has yet to read all of a reply.
static IS_SENDING: AtomicBool = AtomicBool::new(false);
static READER: AtomicWaker = AtomicWaker::new();
static WRITER: AtomicWaker = AtomicWaker::new();

/// Bytes from the host.
pub(crate) struct FromHost(Received);

impl FromHost {
    /// Begins with an empty ring.
    fn begin() -> Self {
        RECEIVE_WAY.start(RECEIVED.as_ptr() as u32, UART.rdr().as_ptr() as u32, RING as u16);
        Self(Received::new())
    }

    /// Takes what has come; none into a buffer that has no room for [`DAMAGE`].
    fn take(&mut self, buffer: &mut [u8]) -> usize {
        let Some(damage) = buffer.first_chunk_mut() else { return 0 };
        let flags = RECEIVE_WAY.take_flags();
        let end = write_place();
        let after = RECEIVE_WAY.flags();
        // From here on the memory holds every byte that the DMA has counted.
        cortex_m::asm::dmb();
        let both_flags = (flags.half || after.half) && (flags.whole || after.whole);
        let is_late = self.0.look(end, both_flags);
        if flags.failed {
            // It has stopped at an error of the bus.
            *self = Self::begin();
        }
        if is_late || flags.failed {
            // The place of an error is now unknown.
            LOST_AT.store(NOWHERE, Ordering::Relaxed);
            *damage = DAMAGE;
            return DAMAGE.len();
        }
        // Read after the DMA's place: an error that comes later lies behind it.
        let lost_at = LOST_AT.load(Ordering::Relaxed);
        let until_lost = if lost_at == NOWHERE { RING } else { self.0.until(lost_at.into()) };
        if until_lost == 0 {
            // Another error's place stays.
            let _ = LOST_AT.compare_exchange(lost_at, NOWHERE, Ordering::Relaxed, Ordering::Relaxed);
            *damage = DAMAGE;
            return DAMAGE.len();
        }
        let (first, count) = self.0.take(buffer.len().min(until_lost));
        for (to, from) in buffer.iter_mut().zip(RECEIVED.iter().skip(first).take(count)) {
            *to = from.load(Ordering::Relaxed);
        }
        count
    }
}

/// Where the DMA writes next.
fn write_place() -> usize {
    RING.saturating_sub(RECEIVE_WAY.left().into()) % RING
}

impl ErrorType for FromHost {
    type Error = Infallible;
}

impl Read for FromHost {
    /// Waits for bytes. Dropping the future loses nothing.
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        poll_fn(|context| {
            let count = self.take(buffer);
            if count > 0 {
                return Poll::Ready(Ok(count));
            }
            READER.register(context.waker());
            // Earlier flags mean nothing: the ring has been read since.
            UART.icr().write(|w| {
                w.set_cmf(true);
                w.set_idle(true);
            });
            listen(true);
            // Once more, for bytes may have come between the two.
            match self.take(buffer) {
                0 => Poll::Pending,
                count => Poll::Ready(Ok(count)),
            }
        })
        .await
    }
}

/// Whether a frame's end and a line that rests raise the interrupt.
fn listen(does: bool) {
    UART.cr1().modify(|w| {
        w.set_cmie(does);
        w.set_idleie(does);
    });
}

/// The UART's interrupt: there is something to read, or a byte is damaged. Above the renderer, so as short as can be.
pub(crate) fn on_uart() {
    let seen = UART.isr().read();
    if seen.fe() || seen.ore() || seen.ne() || seen.pe() {
        skip_byte();
    }
    listen(false);
    board::READ_INTERRUPT.pend();
}

/// The receiving DMA's interrupt, which only `on_uart` raises.
pub(crate) fn on_received() {
    READER.wake();
}

/// Goes on behind a byte with an error, in the order of Linux' driver.
fn skip_byte() {
    UART.cr3().modify(|w| w.set_dmar(false));
    // All of them: one that stood would raise the interrupt without end.
    UART.icr().write(|w| {
        w.set_fe(true);
        w.set_ore(true);
        w.set_ne(true);
        w.set_pe(true);
    });
    UART.rdr().read();
    LOST_AT.store(write_place() as u16, Ordering::Relaxed);
    UART.cr3().modify(|w| w.set_dmar(true));
}

/// The sending DMA's interrupt: it has read all of a reply, or has stopped at an error, which ends the reply.
pub(crate) fn on_sent() {
    let flags = SEND_WAY.take_flags();
    if flags.whole || flags.failed {
        IS_SENDING.store(false, Ordering::Relaxed);
        WRITER.wake();
    }
}

/// Bytes to the host.
pub(crate) struct ToHost;

impl ErrorType for ToHost {
    type Error = Infallible;
}

impl Write for ToHost {
    /// Waits until the reply before is handed over, and hands this one over. Dropping the future before sends nothing.
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.flush().await?;
        let count = bytes.len().min(REPLY);
        for (to, from) in SENT.iter().zip(bytes) {
            to.store(*from, Ordering::Relaxed);
        }
        if count > 0 {
            IS_SENDING.store(true, Ordering::Relaxed);
            SEND_WAY.start(SENT.as_ptr() as u32, UART.tdr().as_ptr() as u32, count as u16);
        }
        Ok(count)
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        poll_fn(|context| {
            WRITER.register(context.waker());
            if IS_SENDING.load(Ordering::Relaxed) { Poll::Pending } else { Poll::Ready(Ok(())) }
        })
        .await
    }
}

/// There is no USB here.
pub(crate) const fn next_frame() -> Option<UsbFrame> {
    None
}

/// Sets up the line.
pub(crate) fn start(_: Spawner, uart: board::Link) -> (FromHost, ToHost) {
    let mut config = Config::default();
    config.baudrate = BAUD;
    config.assume_noise_free = true;
    // A line that nobody drives rests.
    config.rx_pull = Pull::Up;
    board::UART_INTERRUPT.set_priority(priority::UART);
    for interrupt in [board::READ_INTERRUPT, board::SEND_INTERRUPT] {
        interrupt.set_priority(priority::UART_WAKES);
    }
    uart.open(config);
    // Only while the USART is off can the FIFOs be switched off (RM0440, USART_CR1).
    UART.cr1().modify(|w| w.set_ue(false));
    UART.cr1().modify(|w| w.set_fifoen(false));
    UART.cr1().modify(|w| w.set_ue(true));
    let from_host = FromHost::begin();
    // The channel is on before the first request (RM0440 chapter 37, reception using DMA). CR2.ADD, with which received bytes
    // are compared, is 0 since the reset: the delimiter.
    UART.cr3().modify(|w| {
        w.set_dmar(true);
        w.set_dmat(true);
        w.set_eie(true);
    });
    (from_host, ToHost)
}
