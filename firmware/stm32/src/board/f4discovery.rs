//! STM32F4DISCOVERY: STM32F407VG, USB on the micro-AB socket.
//!
//! Sections and tables are those of RM0090 Rev 21 and of the data sheet DS8626 Rev 12.

use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals, interrupt, peripherals};

use super::Board;
use crate::reset::ResetFlags;
use crate::{dac, priority, supply};

pub(crate) use crate::usb_link::Usb as Link;

pub(crate) const NAME: &str = "STM32F4DISCOVERY";

// Clocks (RM0090 7.2, DS8626 tables 14 and 36). The board's crystal has 8 MHz.
//   VCO in = 8 / 4 = 2 MHz (PLLM = 4; 2 MHz is the recommended value), VCO = 2 * 168 = 336 MHz (PLLN = 168),
//   SYSCLK = 336 / 2 = 168 MHz (PLLP = 2), USB = 336 / 7 = 48 MHz exactly (PLLQ = 7).
//   AHB = 168 MHz, APB1 = 168 / 4 = 42 MHz (its limit), APB2 = 168 / 2 = 84 MHz (its limit).
//   TIM6 is on APB1; since APB1 is divided, its timers run at twice APB1 = 84 MHz.
//   84 MHz / 210 = 400 kHz.
pub(crate) const CORE_HZ: u32 = 168_000_000;
pub(crate) const TIMER_HZ: u32 = 84_000_000;
pub(crate) const TIMER_PERIOD: u16 = 210;

/// DAC_CR.TSEL1: 000 is TIM6 TRGO (RM0090 chapter 14).
pub(crate) const DAC_TRIGGER: u8 = 0b000;
/// DAC1 is served by DMA1 stream 5 only (RM0090 table 43), whose flags are in HISR.
pub(crate) const DMA_STREAM: usize = 5;
pub(crate) type DacDma = peripherals::DMA1_CH5;
pub(crate) type Watchdog = peripherals::IWDG;

/// CHSEL = 7 selects DAC1 for stream 5 (RM0090 table 43).
pub(crate) fn route_dma(w: &mut pac::dma::regs::Cr) {
    w.set_chsel(7);
}

/// Sectors 1 and 2, as offsets from 0x0800_0000; the program leaves them out (memory/f407vg.x).
pub(crate) const FLASH_SLOTS: [u32; 2] = [0x4000, 0x8000];
pub(crate) const SLOT_BYTES: usize = 16 * 1024;

/// Nominal; the watchdog's oscillator runs at 17 to 47 kHz for 32 (DS8626 table 35), so 2.7 s to 7.5 s. The longest
/// stall is a 16 KiB sector's erasure and the writing of 8.5 KiB after it. embassy-stm32 0.6 erases with FLASH_CR.PSIZE
/// as its last write has left it, 00, 8 bits at a time: 800 ms at most (DS8626 table 40; 500 ms at 32 bits). The words
/// are written at 32 bits, 2176 of at most 100 us. 1.02 s in all, less than half of the shortest period.
pub(crate) const WATCHDOG_US: u32 = 4_000_000;

/// System memory (RM0090 table 5; AN2606: PA11/PA12 for DFU).
pub(crate) const SYSTEM_MEMORY: u32 = 0x1fff_0000;

#[interrupt]
fn DMA1_STREAM5() {
    dac::on_dma();
}

#[interrupt]
fn PVD() {
    supply::on_dip();
}

pub(crate) const DMA_INTERRUPT: interrupt::Interrupt = interrupt::DMA1_STREAM5;
pub(crate) const SUPPLY_INTERRUPT: interrupt::Interrupt = interrupt::PVD;

pub(crate) fn config() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz(8_000_000), mode: HseMode::Oscillator });
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll = Some(Pll {
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL168,
        divp: Some(PllPDiv::DIV2),
        divq: Some(PllQDiv::DIV7),
        divr: None,
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config.dma_interrupt_priority = priority::DAC;
    config
}

/// embassy-stm32 sets the five wait states that 168 MHz needs and switches the flash's caches off with the same
/// write. On, they bring the core close to zero wait states (RM0090 3.5.2). Revision A has a faulty prefetch
/// (errata sheet ES0182; DBGMCU REV_ID 0x1000), so it stays off there.
pub(crate) fn tune_flash() {
    let is_revision_a = pac::DBGMCU.idcode().read().rev_id() == 0x1000;
    pac::FLASH.acr().modify(|w| {
        w.set_icen(true);
        w.set_dcen(true);
        w.set_prften(!is_revision_a);
    });
}

/// Nothing to do: this DAC has one speed.
pub(crate) fn tune_dac() {}

/// SYSCFG_MEMRMP.MEM_MODE = 01: system memory at address 0, as it is when BOOT0 chooses it (RM0090 9.2.1).
pub(crate) fn map_system_memory() {
    pac::RCC.apb2enr().modify(|w| w.set_syscfgen(true));
    pac::SYSCFG.memrm().modify(|w| w.set_mem_mode(0b01));
}

pub(crate) fn take(p: Peripherals) -> Board {
    // PA4 is also the word select of the board's audio codec: low on PD4 keeps that chip in reset and its pin out of the
    // way. Forgotten, because an `Output` that is dropped lets go of its pin.
    core::mem::forget(Output::new(p.PD4, Level::Low, Speed::Low));
    Board {
        // PB1 is free on this board's headers. The wiring has a resistor to ground on it (BOARDS.md).
        unmute: Output::new(p.PB1, Level::Low, Speed::Low),
        // LD4, green.
        lamp: Output::new(p.PD12, Level::Low, Speed::Low),
        dac: p.DAC1,
        dac_timer: p.TIM6,
        dac_stream: p.DMA1_CH5,
        dac_pin: p.PA4,
        flash: p.FLASH,
        watchdog: p.IWDG,
        link: Link { core: p.USB_OTG_FS, dp: p.PA12, dm: p.PA11 },
    }
}

/// PB1 low. BSRR's upper half resets (RM0090 8.4.7).
pub(crate) fn mute_now() {
    pac::GPIOB.bsrr().write(|w| w.set_br(1, true));
}

/// RCC_CSR (RM0090 7.3.21): every reset sets PINRSTF too, and power-on sets BORRSTF with PORRSTF. Clears the flags.
pub(crate) fn take_reset_flags() -> ResetFlags {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    ResetFlags {
        watchdog: flags.wdgrstf() || flags.wwdgrstf(),
        software: flags.sftrstf(),
        power_on: flags.porrstf(),
        brown_out: flags.borrstf(),
        pin: flags.padrstf(),
    }
}

/// FLASH_OPTCR.BOR_LEV (RM0090 3.9.9): 00 is level 3, reset below 2.83 V until 2.92 V (2.97 V at most: a board may
/// never get there), 01 is level 2, 2.50 V and 2.59 V (DS8626 table 19). Either will do; chips leave the factory with
/// 11, off.
pub(crate) fn is_brown_out_guarded() -> bool {
    pac::FLASH.optcr().read().bor_lev() <= 0b01
}

/// PWR_CR.PLS = 100: the supply detector trips at 2.66 V, until 2.76 V (DS8626 table 19). This board feeds
/// its chip with 2.9 to 3.0 V, too near to the next levels: 101 ends at 2.93 V, 110 at 3.03 V, and a detector that has
/// tripped when it is switched on resets the program for ever.
pub(crate) fn start_supply_detector() {
    pac::PWR.cr1().modify(|w| {
        w.set_pls(0b100);
        w.set_pvde(true);
    });
}
