//! The board the image is for: one file each, chosen by a feature. Every file has the same names in it.
//!
//! | name | what it is |
//! |---|---|
//! | `NAME` | the name in the hello |
//! | `CORE_HZ`, `TIMER_HZ`, `TIMER_PERIOD`, `SAMPLE_RATE_HZ` | the clock tree's results |
//! | `DAC_TRIGGER`, `DMA_STREAM`, request or `route_dma`, `DacDma` | the DAC's wiring inside the chip |
//! | `FLASH_SLOTS`, `SLOT_BYTES` | where the settings are kept |
//! | `WATCHDOG_US` | the watchdog's period |
//! | `SYSTEM_MEMORY` | the ROM bootloader's vector table |
//! | `config()` | clocks, as embassy takes them |
//! | `map_system_memory()` | the ROM bootloader's vectors where a boot from ROM has them |
//! | `Board::take(..)` | the peripherals under their uses' names, with the amplifier muted |
//! | `mute_now()` | register writes alone, for the fault handlers |
//! | `reset_cause()`, `is_brown_out_guarded()` | what the chip says of itself |

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

// One code per timer period, exactly.
const _: () = assert!(SAMPLE_RATE_HZ * TIMER_PERIOD as u32 == TIMER_HZ);
