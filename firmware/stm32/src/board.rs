//! The board that the image is for. Each board has one file, chosen by a feature; every file defines the same names.
//!
//! | name | what it is |
//! |---|---|
//! | `NAME` | the name in the hello |
//! | `CORE_HZ`, `TIMER_HZ`, `TIMER_PERIOD` | the processor's and the sample timer's clocks in Hz; the timer's ticks per DAC code |
//! | `RAISED` | the clocks over those that embassy has recorded |
//! | `SampleTimer`, `SAMPLE_TIMER` | the timer that triggers the DAC once per code |
//! | `MuteTimer`, `MUTE_TIMER`, `MUTE_TIMER_HZ` | the timer of the mute pin, with a break input, and its clock in Hz |
//! | `MUTE_CHANNEL`, `MUTE_IS_COMPLEMENTARY` | its channel, from 0, and whether the pin is the complementary output |
//! | `MUTE_PIN`, `MUTE_FUNCTION` | the mute pin's port and number, and the alternate function that gives it to the timer |
//! | `TriggerTimer`, `TRIGGER_TIMER`, `TRIGGER_SOURCE` | the block timer of the trigger output and input, and which of its inputs the sample timer is |
//! | `TRIGGER_CHANNEL`, `TRIGGER_INPUT_CHANNEL`, `TRIGGER_FUNCTION` | the channels of output and input, from 0, and the alternate function that gives them their pins |
//! | `DAC_TRIGGER`, `DAC_WAY`, `DacDma` | the DAC's wiring inside the chip |
//! | `SENSE_CHANNELS`, `SENSE_TRIGGER`, `SENSE_WAY`, `SenseDma` | that of the inputs: the channels of ADC1 and ADC2, and ADC1's trigger |
//! | `route_dma(..)` (`dma-streams`) | chooses a stream's request, for `dma/streams.rs` |
//! | `FLASH_SLOTS`, `SLOT_BYTES`, `PROFILE_SLOTS` | the flash slots of the stored table; those of the actuator's profile, with their sizes |
//! | `BUTTON_PIN` | the pin of the user button |
//! | `STOP_INPUT_PIN`, `STOP_INPUT_FUNCTION` | the pin of the stop input, and the alternate function that makes it the mute timer's break |
//! | `WATCHDOG`, `WATCHDOG_PRESCALER`, `WATCHDOG_FASTEST_HZ` | the watchdog, its divider, and its oscillator at its fastest |
//! | `ERASURE_WATCHDOG_MS` | its nominal period around an erasure of the flash, in ms |
//! | `SYSTEM_MEMORY` | the ROM bootloader's vector table |
//! | `DMA_INTERRUPT`, `SUPPLY_INTERRUPT` and their handlers | interrupts of the DAC's DMA and the supply detector |
//! | `Link` | the link's peripheral and pins: `usb_link`'s type, or with `link-uart` its own, which opens a UART |
//! | `LINK_UART`, `RECEIVE_WAY`, `SEND_WAY` (`link-uart`) | that UART and its two ways of the DMA |
//! | `UART_INTERRUPT`, `READ_INTERRUPT`, `SEND_INTERRUPT` (`link-uart`) | the interrupts of that UART and of its two ways, and their handlers |
//! | `config()` | the clocks and the DMA interrupts' priority, for embassy |
//! | `tune_flash()`, `tune_dac()` | the settings of flash and DAC that embassy does not make |
//! | `admit_break_pin()` | lets the pin with the mute timer's break function through to its break, where there is a gate |
//! | `map_system_memory()` | maps the ROM bootloader's vectors to address 0, as a boot from ROM does |
//! | `stop_usb_clocks()` | switches off, before the reset into the ROM bootloader, what the ROM's USB could not start with |
//! | `take(..)` | sorts the peripherals by their use, and mutes the amplifier |
//! | `has_clock()` | whether the clock that times the samples runs; a board that waits for it at the start always has it |
//! | `guard_clock()`, `take_clock_failure()` | the clock security system: switches it on; whether it has found a failure |
//! | `set_debug_freezes()` | what stands still while a debugger has halted the core |
//! | `take_reset_flags()`, `chip()` | the reset's cause; the chip's device id and revision |
//! | `watch_ram()`, `ram_errors()` | latches the errors of the RAM from now on; which there were, where the chip corrects them |
//! | `BROWN_OUT_LEVEL` | the lowest level of the brown-out reset that guards the board, counted from the lowest threshold |
//! | `LINEAR_PER_MILLE` | the share of the DAC's half swing within which its output is linear |
//! | `REFERENCE_CALIBRATION` | where the chip keeps the code of its internal reference, and at which VREF+ in mV that was measured |
//! | `REFERENCE_ADC`, `REFERENCE_CHANNEL`, `start_reference()`, `tune_reference(..)`, `end_reference()` (`adc-fast`) | the ADC and the channel of the internal reference, and how they are set up |
//! | `start_supply_detector()` | switches the detector on, with the level at which it trips; where the chip can, connects it and the core's lock-up with the mute timer's break |

use cortex_m::peripheral::DWT;
use embassy_stm32::gpio::{Flex, Output, Pin, Pull, Speed};
use embassy_stm32::{Peri, peripherals};
use slipline_app::ports::INPUTS;

#[cfg(feature = "board-f4discovery")]
mod f4discovery;
#[cfg(feature = "board-f4discovery")]
pub(crate) use f4discovery::*;

#[cfg(feature = "board-nucleo-g474re")]
mod nucleo_g474re;
#[cfg(feature = "board-nucleo-g474re")]
pub(crate) use nucleo_g474re::*;

#[cfg(feature = "board-nucleo-h743zi2")]
#[expect(unsafe_code, reason = "listed in firmware/UNSAFE.md")]
mod nucleo_h743zi2;
#[cfg(feature = "board-nucleo-h743zi2")]
pub(crate) use nucleo_h743zi2::*;

pub(crate) const SAMPLE_RATE_HZ: u32 = 400_000;
// One code per timer period, exactly.
const _: () = assert!(SAMPLE_RATE_HZ * TIMER_PERIOD as u32 == TIMER_HZ);
// A slot holds the application's longest record.
const _: () = assert!(SLOT_BYTES >= slipline_app::store::SLOT_BYTES);
const _: () = assert!(PROFILE_SLOTS[0].1 >= slipline_app::store::SLOT_BYTES);
const _: () = assert!(PROFILE_SLOTS[1].1 >= slipline_app::store::SLOT_BYTES);

/// The peripherals, named by their use. Every STM32 with a DAC has its first channel on PA4.
pub(crate) struct Board {
    /// High switches the amplifier on. Low before the mute timer takes the pin over, and at first after that.
    pub(crate) unmute: MutedPin,
    pub(crate) mute_timer: Peri<'static, MuteTimer>,
    /// Rises when a program begins. Low before its timer takes the pin over, and at first after that.
    pub(crate) trigger: Flex<'static>,
    /// Its rise begins a program; pulled down once its timer takes the pin over.
    pub(crate) trigger_input: Flex<'static>,
    pub(crate) trigger_timer: Peri<'static, TriggerTimer>,
    pub(crate) lamp: Output<'static>,
    pub(crate) dac: Peri<'static, peripherals::DAC1>,
    pub(crate) sample_timer: Peri<'static, SampleTimer>,
    pub(crate) dac_stream: Peri<'static, DacDma>,
    pub(crate) dac_pin: Peri<'static, peripherals::PA4>,
    /// The ADCs of sensor and shunt, and the DMA that takes their codes.
    pub(crate) sensors:
        (Peri<'static, peripherals::ADC1>, Peri<'static, peripherals::ADC2>, Peri<'static, SenseDma>),
    /// The pins of sensor and shunt.
    pub(crate) sense_pins: [Flex<'static>; INPUTS],
    pub(crate) button: Flex<'static>,
    /// Untouched until a profile says whether a stop input is fitted.
    pub(crate) stop_input: Flex<'static>,
    pub(crate) flash: Peri<'static, peripherals::FLASH>,
    pub(crate) link: Link,
}

/// How often the mute pin is looked at while it is pulled up and nobody drives it, and how many times at most: for 5 ms.
const LOOK_US: u32 = 60;
const LOOKS: u32 = 84;
/// Instructions between two looks at the clock.
const STEP: u32 = 64;

/// The mute pin, which is driven low, and whether it has its resistor.
pub(crate) struct MutedPin {
    pub(crate) pin: Flex<'static>,
    pub(crate) has_resistor: bool,
}

impl MutedPin {
    /// Looks for the resistor and drives the pin low. The cycle counter runs.
    ///
    /// The chip's own pull-up has 25 kOhm at least (the data sheets' I/O characteristics: 25 to 55 kOhm on the G474, 30 to 50 kOhm
    /// on the others), so with 10 kOhm to ground the pin stays below 0.29 of the supply, a low level for certain (0.3 of it), and with
    /// the 4.7 kOhm of BOARDS.md below 0.16 of it.
    /// Without a resistor the pin is at the supply within some us and is seen by the first look. A capacitor alone holds it low
    /// for longer: 47 nF reach a level that is high for certain (0.7 of the supply) within 1.21 * 55 kOhm * 47 nF = 3.2 ms. So a pin
    /// that is low is watched for 5 ms, before anything is at the amplifier's input.
    fn take(pin: Peri<'static, impl Pin>) -> Self {
        let mut pin = Flex::new(pin);
        pin.set_as_input(Pull::Up);
        let has_resistor = (0..LOOKS).all(|_| {
            wait_us(LOOK_US);
            pin.is_low()
        });
        pin.set_low();
        pin.set_as_output(Speed::Low);
        Self { pin, has_resistor }
    }
}

/// Waits by the cycle counter. If the counter stands still, the wait takes a few times as long, but it ends.
fn wait_us(us: u32) {
    let (start, cycles) = (DWT::cycle_count(), us * (CORE_HZ / 1_000_000));
    // A Cortex-M7 does two of these a cycle.
    for _ in 0..4 * cycles / STEP {
        for _ in 0..STEP {
            cortex_m::asm::nop();
        }
        if DWT::cycle_count().wrapping_sub(start) >= cycles {
            break;
        }
    }
}

/// Drives a pin low.
fn low(pin: Peri<'static, impl Pin>) -> Flex<'static> {
    let mut pin = Flex::new(pin);
    pin.set_low();
    pin.set_as_output(Speed::Low);
    pin
}
