//! The board's user button: the stop on the desk, by program.
//!
//! The button connects its pin with the supply, and a resistor on the board pulls the pin to ground: B1 of the STM32F4DISCOVERY (UM1472),
//! of the NUCLEO-G474RE (its board MB1367) and of the NUCLEO-H743ZI2 (MB1364). No pin has been measured: were a board's button the
//! other way round, the device would say that it is pressed and could not be armed. The chip's own resistor pulls down, too, so a
//! board without the button reads as one that is not pressed.

use embassy_stm32::gpio::{Flex, Pull};
use embassy_stm32::pac::gpio::vals::Idr;
use slipline_app::ports::{Button, UserButton as State};

use crate::board;

/// The user button.
pub(crate) struct UserButton;

impl UserButton {
    /// Makes its pin an input.
    pub(crate) fn start(mut pin: Flex<'static>) -> Self {
        pin.set_as_input(Pull::Down);
        // A `Flex` that is dropped gives its pin up.
        core::mem::forget(pin);
        Self
    }
}

impl Button for UserButton {
    fn is_pressed(&mut self) -> bool {
        is_pressed()
    }
}

fn is_pressed() -> bool {
    let (port, number) = board::BUTTON_PIN;
    port.idr().read().idr(number) == Idr::HIGH
}

/// Its state, for the host.
pub(crate) fn state() -> State {
    if is_pressed() { State::Pressed } else { State::Released }
}
