//! The link over a UART, which the board's ST-LINK shows to the host as a serial port.
//!
//! ```text
//! host --line--> USART --DMA, circular--> ring (`received`) --FromHost--> link
//! host <--line-- USART <--DMA, once a write-- buffer <--ToHost-- link
//! ```
//! 921600 baud, 8 data bits, no parity, one stop bit: the fastest rate that every ST-LINK firmware accepts. The frames
//! have their own CRC, so a byte lost by noise or by a full ring costs at most two frames.
//!
//! **No byte takes an interrupt**, and none of the link's interrupts lies above the renderer's. They only wake the link: at the end of
//! a frame, whose last byte the USART compares with the delimiter; when the line rests; and when a reply has been handed over. A
//! reader that has found nothing enables the first two, so on a line without a pause one comes for each look that the link takes. A
//! byte is in memory some tens of cycles after its interrupt is raised; should that be later, the line's rest, the
//! next frame's end or the link's tick comes after it.
//!
//! **What is lost is counted.** Where bytes are missing the reader puts in [`DAMAGE`], which the link counts as a damaged frame: when the
//! ring was full, when the receiver had an overrun, and when a byte had no stop bit. By the manual the DMA leaves such a byte out
//! (CR3.DDRE = 0: USART_CR3 in RM0440 37.8; no chip was looked at); whether it comes or not makes no difference here. A byte with
//! noise would be left out, too, so a bit's middle sample alone decides (ONEBIT, which the manual recommends for lines without
//! noise; this one is some centimetres long): the frame's CRC finds what is wrong. The receiver's FIFO holds eight bytes for a DMA that is
//! late; OVRDIS would bypass it.

use core::convert::Infallible;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use core::task::Poll;

use embassy_executor::Spawner;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::usart::Config;
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io_async::{ErrorType, Read, Write};

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
        let end = RING.saturating_sub(RECEIVE_WAY.left().into());
        let after = RECEIVE_WAY.flags();
        // What the DMA has counted is in memory.
        cortex_m::asm::dmb();
        let both_flags = (flags.half || after.half) && (flags.whole || after.whole);
        let is_late = self.0.look(end, both_flags);
        if flags.failed {
            // It has stopped at an error of the bus.
            *self = Self::begin();
        }
        if has_failed() || is_late || flags.failed {
            *damage = DAMAGE;
            return DAMAGE.len();
        }
        let (first, count) = self.0.take(buffer.len());
        for (to, from) in buffer.iter_mut().zip(RECEIVED.iter().skip(first).take(count)) {
            *to = from.load(Ordering::Relaxed);
        }
        count
    }
}

/// Whether the receiver has lost a byte since the last look. An overrun that stands may keep it from going on.
fn has_failed() -> bool {
    let seen = UART.isr().read();
    let has_failed = seen.ore() || seen.fe();
    if has_failed {
        UART.icr().write(|w| {
            w.set_ore(seen.ore());
            w.set_fe(seen.fe());
        });
    }
    has_failed
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
            // What has happened before counts for nothing: the ring has been looked at.
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

/// The UART's interrupt: there is something to read.
pub(crate) fn on_uart() {
    listen(false);
    READER.wake();
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

/// Sets up the line.
pub(crate) fn start(_: Spawner, uart: board::Link) -> (FromHost, ToHost) {
    let mut config = Config::default();
    config.baudrate = BAUD;
    config.assume_noise_free = true;
    for interrupt in [board::UART_INTERRUPT, board::SEND_INTERRUPT] {
        interrupt.set_priority(priority::UART);
    }
    uart.open(config);
    let from_host = FromHost::begin();
    // The channel is on before the first request (RM0440 chapter 37, reception using DMA). CR2.ADD, with which received bytes
    // are compared, is 0 since the reset: the delimiter.
    UART.cr3().modify(|w| {
        w.set_dmar(true);
        w.set_dmat(true);
    });
    (from_host, ToHost)
}
