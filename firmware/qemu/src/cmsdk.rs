//! The emulated board's UARTs and timer: those of Arm's CMSDK (DDI 0479C, chapter 4).
//!
//! Addresses and interrupt numbers of the mps2-an386 image are those of Arm's application note AN386.

/// A CMSDK APB UART.
#[derive(Clone, Copy)]
pub(crate) struct Uart(usize);

/// The link.
pub(crate) const UART0: Uart = Uart(0x4000_4000);
/// The DAC's codes.
pub(crate) const UART1: Uart = Uart(0x4000_5000);
/// Receive interrupt of [`UART0`].
pub(crate) const UART0_RECEIVE: i16 = 0;
/// Receive interrupt of [`UART1`].
pub(crate) const UART1_RECEIVE: i16 = 2;

const DATA: usize = 0x0;
const STATE: usize = 0x4;
const CONTROL: usize = 0x8;
const INTERRUPTS: usize = 0xc;
const BAUD_DIVISOR: usize = 0x10;

/// STATE: the transmit buffer holds a byte.
const TRANSMIT_FULL: u32 = 1 << 0;
/// STATE: the receive buffer holds a byte.
const RECEIVE_FULL: u32 = 1 << 1;
/// CONTROL: transmitter and receiver on.
const ENABLE: u32 = 0b11;
/// CONTROL: receive interrupt on.
const RECEIVE_INTERRUPT: u32 = 1 << 3;
/// INTERRUPTS: receive interrupt pending; writing 1 clears it.
const RECEIVE_PENDING: u32 = 1 << 1;
/// The smallest baud divisor that the hardware takes; the emulator sends each byte at once.
const FASTEST: u32 = 16;

fn read(address: usize) -> u32 {
    // SAFETY: the callers pass addresses of the board's registers, all of which may be read.
    unsafe { (address as *const u32).read_volatile() }
}

fn write(address: usize, value: u32) {
    // SAFETY: the callers pass addresses of the board's registers and values that those registers take.
    unsafe { (address as *mut u32).write_volatile(value) }
}

impl Uart {
    /// Switches the UART on, with its receive interrupt.
    pub(crate) fn start(self) {
        write(self.0 + BAUD_DIVISOR, FASTEST);
        self.listen(true);
    }

    /// Takes the received byte, if there is one. The emulator does not deliver the next byte before, so none is lost.
    pub(crate) fn receive(self) -> Option<u8> {
        if read(self.0 + STATE) & RECEIVE_FULL == 0 {
            return None;
        }
        let byte = read(self.0 + DATA);
        write(self.0 + INTERRUPTS, RECEIVE_PENDING);
        u8::try_from(byte & 0xff).ok()
    }

    /// Sends a byte, if there is room.
    pub(crate) fn try_send(self, byte: u8) -> bool {
        let room = read(self.0 + STATE) & TRANSMIT_FULL == 0;
        if room {
            write(self.0 + DATA, u32::from(byte));
        }
        room
    }

    /// Sends bytes; waits for room before each one, without a limit.
    pub(crate) fn send(self, bytes: &[u8]) {
        for &byte in bytes {
            while !self.try_send(byte) {}
        }
    }

    /// Switches the receive interrupt on or off.
    pub(crate) fn listen(self, on: bool) {
        write(self.0 + CONTROL, if on { ENABLE | RECEIVE_INTERRUPT } else { ENABLE });
    }
}

/// TIMER0's interrupt.
pub(crate) const TIMER0_INTERRUPT: i16 = 8;
const TIMER0: usize = 0x4000_0000;
const TIMER_CONTROL: usize = 0x0;
const TIMER_VALUE: usize = 0x4;
const TIMER_RELOAD: usize = 0x8;
const TIMER_INTERRUPT: usize = 0xc;
/// TIMER_CONTROL: count, and raise the interrupt at zero.
const COUNT: u32 = 1 << 0 | 1 << 3;

/// Starts TIMER0: an interrupt every `ticks` of the board's 25 MHz.
pub(crate) fn start_timer(ticks: u32) {
    write(TIMER0 + TIMER_VALUE, ticks - 1);
    write(TIMER0 + TIMER_RELOAD, ticks - 1);
    write(TIMER0 + TIMER_CONTROL, COUNT);
}

/// Clears TIMER0's interrupt.
pub(crate) fn clear_timer() {
    write(TIMER0 + TIMER_INTERRUPT, 1);
}
