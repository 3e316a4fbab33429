//! Locks a pin's configuration until the next reset: a wild write can no longer make it another kind of pin.

use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::gpio::regs::Lckr;

/// Locks pin `number` of a port: mode, alternate function, kind of output, speed and pull. Once for each port: a lock
/// keeps the others of its port as they are.
pub(crate) fn lock(port: Gpio, number: usize) {
    let mut pins = Lckr(0);
    pins.set_lck(number, true);
    let mut with_key = pins;
    with_key.set_lckk(true);
    // The sequence: key and pins, pins, key and pins, and a read (RM0090 8.4.8, RM0440 9.4.8, RM0433 11.4.8).
    for value in [with_key, pins, with_key] {
        port.lckr().write_value(value);
    }
    port.lckr().read();
    assert!(port.lckr().read().lckk(), "the pin is not locked");
}
