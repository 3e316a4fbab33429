//! The board's user button: the stop on the desk, by program.
//!
//! The program reads the level at rest from the pin at the start, because the sources about it do not agree. ST's own
//! board support (STM32CubeG4, `BSP_PB_Init`) pulls PC13 of the NUCLEO-G474RE down and waits for a rising edge,
//! Zephyr's board file says active low; for the STM32F4DISCOVERY (PA0) and the NUCLEO-H743ZI (PC13) it says active
//! high. No pin has been measured. A button that is held at the start reads as pressed once it is released, and the
//! device cannot be armed until it is started again. The chip's own resistor pulls down, so a board without the button
//! reads as one that is not pressed.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_stm32::gpio::{Flex, Pull};
use embassy_stm32::pac::gpio::vals::Idr;
use slipline_app::ports::{Button, UserButton as State};

use crate::board;

/// Blocks from the start whose level counts as that at rest: 2.6 ms, or five time constants of the 4.7 kOhm and 100 nF that the Nucleo
/// boards have at their button.
const SETTLE_BLOCKS: u8 = 8;

/// Whether the pin is high while nobody presses.
static IS_HIGH_AT_REST: AtomicBool = AtomicBool::new(false);

/// The user button.
pub(crate) struct UserButton {
    settles: u8,
}

impl UserButton {
    /// Makes its pin an input.
    pub(crate) fn start(mut pin: Flex<'static>) -> Self {
        pin.set_as_input(Pull::Down);
        // A `Flex` that is dropped gives its pin up.
        core::mem::forget(pin);
        Self { settles: SETTLE_BLOCKS }
    }
}

impl Button for UserButton {
    fn is_pressed(&mut self) -> bool {
        if self.settles > 0 {
            self.settles -= 1;
            IS_HIGH_AT_REST.store(is_high(), Relaxed);
        }
        is_pressed()
    }
}

fn is_high() -> bool {
    let (port, number) = board::BUTTON_PIN;
    port.idr().read().idr(number) == Idr::HIGH
}

fn is_pressed() -> bool {
    is_high() != IS_HIGH_AT_REST.load(Relaxed)
}

/// Its state, for the host.
pub(crate) fn state() -> State {
    if is_pressed() { State::Pressed } else { State::Released }
}
