//! The board the image is for: one file each, chosen by a feature. Every file has the same names in it.
//!
//! | name | what it is |
//! |---|---|
//! | `NAME` | the name in the hello |
//! | `CORE_HZ`, `TIMER_HZ`, `TIMER_PERIOD` | the clock tree's results |
//! | `DAC_TRIGGER`, `DMA_STREAM`, `DacDma` | the DAC's wiring inside the chip |
//! | `route_dma(..)` (`dma-streams`) or `DMA_REQUEST` (`dma-channels`) | the DMA's request, as `dac/` has it |
//! | `FLASH_SLOTS`, `SLOT_BYTES` | where the settings are kept |
//! | `Watchdog`, `WATCHDOG_US` | the watchdog and its period |
//! | `SYSTEM_MEMORY` | the ROM bootloader's vector table |
//! | `DMA_INTERRUPT`, `SUPPLY_INTERRUPT` and their handlers | what the chip calls these interrupts |
//! | `Link` | the link's peripheral and its pins: `usb_link`'s, or with `link-uart` its own, which opens a UART |
//! | `UART_INTERRUPT` (`link-uart`) | that UART's |
//! | `config()` | clocks, as embassy takes them |
//! | `tune_flash()`, `tune_dac()` | what embassy does not set |
//! | `map_system_memory()` | the ROM bootloader's vectors where a boot from ROM has them |
//! | `take(..)` | the peripherals under their uses' names, with the amplifier muted |
//! | `mute_now()` | register writes alone, for the fault handlers |
//! | `take_reset_flags()`, `is_brown_out_guarded()` | the reset's cause; whether the brown-out level is set |
//! | `start_supply_detector()` | the level at which it trips |

use embassy_stm32::gpio::Output;
use embassy_stm32::{Peri, peripherals};

#[cfg(feature = "board-f4discovery")]
mod f4discovery;
#[cfg(feature = "board-f4discovery")]
pub(crate) use f4discovery::*;

#[cfg(feature = "board-nucleo-g474re")]
mod nucleo_g474re;
#[cfg(feature = "board-nucleo-g474re")]
pub(crate) use nucleo_g474re::*;

#[cfg(feature = "board-nucleo-h743zi2")]
mod nucleo_h743zi2;
#[cfg(feature = "board-nucleo-h743zi2")]
pub(crate) use nucleo_h743zi2::*;

pub(crate) const SAMPLE_RATE_HZ: u32 = 400_000;
// One code per timer period, exactly.
const _: () = assert!(SAMPLE_RATE_HZ * TIMER_PERIOD as u32 == TIMER_HZ);
// A record of the application's fits.
const _: () = assert!(SLOT_BYTES >= slipline_app::store::SLOT_BYTES);

/// The peripherals, by what they are for. Every STM32 with a DAC has its first channel on PA4.
pub(crate) struct Board {
    /// High: the amplifier may sound.
    pub(crate) unmute: Output<'static>,
    pub(crate) lamp: Output<'static>,
    pub(crate) dac: Peri<'static, peripherals::DAC1>,
    pub(crate) dac_timer: Peri<'static, peripherals::TIM6>,
    pub(crate) dac_stream: Peri<'static, DacDma>,
    pub(crate) dac_pin: Peri<'static, peripherals::PA4>,
    pub(crate) flash: Peri<'static, peripherals::FLASH>,
    pub(crate) watchdog: Peri<'static, Watchdog>,
    pub(crate) link: Link,
}
