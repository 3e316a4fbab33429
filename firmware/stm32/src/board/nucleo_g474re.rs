//! NUCLEO-G474RE: STM32G474RE, the link through the ST-LINK's virtual serial port.
//!
//! Sections and tables are those of RM0440 Rev 9 and of the data sheet DS12288 Rev 6.

use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, BufferedUart};
use embassy_stm32::{Config, Peri, Peripherals, bind_interrupts, interrupt, peripherals};

use super::Board;
use crate::reset::ResetFlags;
use crate::{dac, priority, supply};

pub(crate) const NAME: &str = "NUCLEO-G474RE";

// Clocks (RM0440 7.2, DS12288 table 46). The board's crystal X3 has 24 MHz.
//   VCO in = 24 / 6 = 4 MHz (PLLM = 6; 2.66 to 16 MHz allowed), VCO = 4 * 85 = 340 MHz (PLLN = 85; at most 344 MHz),
//   SYSCLK = 340 / 2 = 170 MHz (PLLR = 2), which needs range 1 boost mode (RM0440 table 38).
//   RM0440 6.1.5 wants the AHB at half of it for 1 us after the switch; embassy-stm32 0.6 waits before the switch instead
//   and ends the half with the same write. Should a chip fail at the start, look here first.
//   AHB = APB1 = APB2 = 170 MHz. TIM6 is on APB1; APB1 is not divided, so its timers run at 170 MHz.
//   170 MHz / 425 = 400 kHz.
pub(crate) const CORE_HZ: u32 = 170_000_000;
pub(crate) const TIMER_HZ: u32 = 170_000_000;
pub(crate) const TIMER_PERIOD: u16 = 425;

/// DAC_CR.TSEL1 of DAC1: 0111 is TIM6 TRGO (RM0440 table 186, dac_chx_trg7).
pub(crate) const DAC_TRIGGER: u8 = 7;
/// DMA1 channel 1, which the registers count as 0.
pub(crate) const DMA_STREAM: usize = 0;
/// DMAMUX input 6 is DAC1's channel 1 (RM0440 table 93).
pub(crate) const DMA_REQUEST: u8 = 6;
pub(crate) type DacDma = peripherals::DMA1_CH1;
pub(crate) type Watchdog = peripherals::IWDG;

/// The last two times eight pages of 2 KiB in bank 2, as offsets from 0x0800_0000. With option bit DBANK = 0, which no chip
/// is delivered with, there is no bank 2: embassy-stm32 panics, and the program starts again and again, muted.
pub(crate) const FLASH_SLOTS: [u32; 2] = [0x7_8000, 0x7_c000];
pub(crate) const SLOT_BYTES: usize = 16 * 1024;

/// The watchdog's oscillator runs at 29.5 to 34 kHz for 32 (DS12288 table 45). Eight pages erase in 8 * 24.5 ms at most
/// (DS12288 table 47), and 8 KiB are written in 1024 * 0.1 ms: 0.3 s, far below half of this.
pub(crate) const WATCHDOG_US: u32 = 2_000_000;

/// System memory (AN2606, bootloader V13.x: USART, I2C, SPI, USB DFU on PA11/PA12).
pub(crate) const SYSTEM_MEMORY: u32 = 0x1fff_0000;

bind_interrupts!(struct Irqs {
    USART2 => usart::BufferedInterruptHandler<peripherals::USART2>;
});

#[interrupt]
fn DMA1_CHANNEL1() {
    dac::on_dma();
}

#[interrupt]
fn PVD_PVM() {
    supply::on_dip();
}

pub(crate) const SUPPLY_INTERRUPT: interrupt::Interrupt = interrupt::PVD_PVM;
pub(crate) const DMA_INTERRUPT: interrupt::Interrupt = interrupt::DMA1_CHANNEL1;
pub(crate) const UART_INTERRUPT: interrupt::Interrupt = interrupt::USART2;

pub(crate) fn config() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(Hse { freq: Hertz(24_000_000), mode: HseMode::Oscillator });
    config.rcc.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV6,
        mul: PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(PllRDiv::DIV2),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    config.rcc.boost = true;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV1;
    config.rcc.apb2_pre = APBPrescaler::DIV1;
    config.bdma_interrupt_priority = priority::DAC;
    config
}

/// Caches are on after reset (RM0440 3.7.1); the prefetch is not.
pub(crate) fn tune_flash() {
    pac::FLASH.acr().modify(|w| {
        w.set_icen(true);
        w.set_dcen(true);
        w.set_prften(true);
    });
}

/// DAC_MCR.HFSEL: the DAC's clock is the AHB at 170 MHz; above 160 MHz it wants 10 (RM0440 22.7.16), which can be written
/// only while both channels are off.
pub(crate) fn tune_dac() {
    pac::DAC1.mcr().modify(|w| w.set_hfsel(0b10));
}

/// SYSCFG_MEMRMP.MEM_MODE = 001: system memory at address 0, as it is when BOOT0 chooses it (RM0440 10.2.1).
pub(crate) fn map_system_memory() {
    pac::RCC.apb2enr().modify(|w| w.set_syscfgen(true));
    pac::SYSCFG.memrmp().modify(|w| w.set_mem_mode(0b001));
}

pub(crate) struct Link {
    uart: Peri<'static, peripherals::USART2>,
    receive: Peri<'static, peripherals::PA3>,
    transmit: Peri<'static, peripherals::PA2>,
}

pub(crate) fn take(p: Peripherals) -> Board {
    Board {
        // PB5, D4 on the Arduino header; not PB4 or PB6, which USB-C's dead-battery resistors pull after reset. The
        // wiring has a resistor to ground on it (BOARDS.md).
        unmute: Output::new(p.PB5, Level::Low, Speed::Low),
        // LD2, green.
        lamp: Output::new(p.PA5, Level::Low, Speed::Low),
        dac: p.DAC1,
        dac_timer: p.TIM6,
        dac_stream: p.DMA1_CH1,
        dac_pin: p.PA4,
        flash: p.FLASH,
        watchdog: p.IWDG,
        link: Link { uart: p.USART2, receive: p.PA3, transmit: p.PA2 },
    }
}

impl Link {
    /// USART2 on PA2 and PA3 (alternate function 7), which the board wires to the ST-LINK; UM2505 calls them LPUART1's
    /// (alternate function 12), but the pins carry either. Its clock is APB1:
    /// 170 MHz / 184 = 923913 baud, 0.25 % from 921600.
    pub(crate) fn open(
        self,
        transmit: &'static mut [u8],
        receive: &'static mut [u8],
        config: usart::Config,
    ) -> BufferedUart<'static> {
        match BufferedUart::new(self.uart, self.receive, self.transmit, transmit, receive, Irqs, config) {
            Ok(uart) => uart,
            Err(error) => panic!("USART2: {error:?}"),
        }
    }
}

/// PB5 low. BSRR's upper half resets (RM0440 9.4.7).
pub(crate) fn mute_now() {
    pac::GPIOB.bsrr().write(|w| w.set_br(5, true));
}

/// RCC_CSR (RM0440 7.4.28): every reset sets PINRSTF too. A power-on sets BORRSTF (there is no separate flag), so a
/// brown-out looks like one here; the supply detector tells it apart. Clears the flags.
pub(crate) fn take_reset_flags() -> ResetFlags {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    ResetFlags {
        watchdog: flags.iwdgrstf() || flags.wwdgrstf(),
        software: flags.sftrstf(),
        power_on: flags.borrstf(),
        brown_out: false,
        pin: flags.pinrstf(),
    }
}

/// FLASH_OPTR.BOR_LEV: 100 is level 4, reset below 2.8 V (RM0440 3.7.8); chips leave the factory with 000, 1.7 V.
pub(crate) fn is_brown_out_guarded() -> bool {
    pac::FLASH.optr().read().bor_lev() == 0b100
}

/// PWR_CR2.PLS = 110 (RM0440 6.4.2): the supply detector trips at 2.90 V (DS12288 table 19).
pub(crate) fn start_supply_detector() {
    pac::PWR.cr2().modify(|w| {
        w.set_pls(0b110);
        w.set_pvde(true);
    });
}
