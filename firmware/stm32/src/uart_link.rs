//! The link over a UART, which the board's ST-LINK shows to the host as a serial port.
//!
//! 921600 baud, 8 data bits, no parity, one stop bit: the fastest rate that every ST-LINK firmware accepts. The frames
//! have their own CRC, so a byte lost by noise or by a full buffer costs at most two frames.

use embassy_executor::Spawner;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::usart::{BufferedUart, BufferedUartRx, BufferedUartTx, Config, Error};
use embedded_io_async::{ErrorType, Write};
use static_cell::StaticCell;

use crate::{board, priority};

const BAUD: u32 = 921_600;
/// 256 bytes come in 2.8 ms at full rate: the thread side may be this late.
const RECEIVE_BYTES: usize = 256;
/// Received bytes that wake the thread side: 87 us of the line's time. Without this it would sleep until half of the receive
/// buffer is full, and a stop would wait until the command before it is decoded.
const EAGER_BYTES: usize = 8;
/// One complete frame, so that a reply is handed over at once.
const TRANSMIT_BYTES: usize = 256;

/// Bytes from the host.
pub(crate) type FromHost = BufferedUartRx<'static>;
/// Bytes to the host.
///
/// embassy-stm32 0.6 starts the transmitter only if its buffer was empty when a write began. If the UART's interrupt sends the
/// last byte and stops between that look and the end of the copy, the reply lies there until the host sends something. So the
/// interrupt is asked for once more after each write: it does nothing where there is nothing to send.
pub(crate) struct ToHost(BufferedUartTx<'static>);

impl ErrorType for ToHost {
    type Error = Error;
}

impl Write for ToHost {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Error> {
        let written = Write::write(&mut self.0, bytes).await;
        // In the same poll: there is nothing to wait for in between.
        board::UART_INTERRUPT.pend();
        written
    }

    async fn flush(&mut self) -> Result<(), Error> {
        Write::flush(&mut self.0).await
    }
}

/// Sets up the line.
pub(crate) fn start(_: Spawner, uart: board::Link) -> (FromHost, ToHost) {
    static RECEIVE: StaticCell<[u8; RECEIVE_BYTES]> = StaticCell::new();
    static TRANSMIT: StaticCell<[u8; TRANSMIT_BYTES]> = StaticCell::new();
    let mut config = Config::default();
    config.baudrate = BAUD;
    config.eager_reads = Some(EAGER_BYTES);
    let opened: BufferedUart<'static> =
        uart.open(TRANSMIT.init([0; TRANSMIT_BYTES]), RECEIVE.init([0; RECEIVE_BYTES]), config);
    board::UART_INTERRUPT.set_priority(priority::UART);
    let (transmit, receive) = opened.split();
    (receive, ToHost(transmit))
}
