//! STM32F4DISCOVERY: STM32F407VG, USB on the micro-AB socket.
//!
//! Sections and tables are those of RM0090 Rev 21 and of the data sheet DS8626 Rev 12.

use embassy_stm32::gpio::{Flex, Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals, interrupt, peripherals};
use slipline_app::ports::INPUTS;

use super::{Board, MutedPin, low};
use crate::dma::{Purpose, Way};
use crate::reset::ResetFlags;
use crate::{dac, priority, supply};

pub(crate) use crate::usb_link::Usb as Link;

pub(crate) const NAME: &str = "STM32F4DISCOVERY";

// Clocks (RM0090 7.2, DS8626 tables 14 and 36). The board's crystal has 8 MHz.
//   VCO in = 8 / 4 = 2 MHz (PLLM = 4; 2 MHz is the recommended value), VCO = 2 * 168 = 336 MHz (PLLN = 168),
//   SYSCLK = 336 / 2 = 168 MHz (PLLP = 2), USB = 336 / 7 = 48 MHz exactly (PLLQ = 7).
//   AHB = 168 MHz, APB1 = 168 / 4 = 42 MHz (its limit), APB2 = 168 / 2 = 84 MHz (its limit).
//   TIM8, the sample timer, is on APB2; since APB2 is divided, its timers run at twice APB2 = 168 MHz.
//   168 MHz / 420 = 400 kHz.
pub(crate) const CORE_HZ: u32 = 168_000_000;
pub(crate) const TIMER_HZ: u32 = 168_000_000;
pub(crate) const TIMER_PERIOD: u16 = 420;
/// embassy's record of the clocks is the chip's.
pub(crate) const RAISED: u32 = 1;

// The sample timer is TIM8. Its trigger output reaches the DAC (RM0090 table 76) and, unlike TIM6's, the ADCs
// (ADC_CR2.EXTSEL, below): the inputs are sampled with the codes.
pub(crate) type SampleTimer = peripherals::TIM8;
pub(crate) const SAMPLE_TIMER: pac::timer::TimAdv = pac::TIM8;

// The mute pin is PB1: TIM1's channel 3, complementary output (alternate function 1, DS8626 table 9). TIM1 is on APB2;
// since APB2 is divided, its timers run at twice APB2 = 168 MHz.
pub(crate) type MuteTimer = peripherals::TIM1;
pub(crate) const MUTE_TIMER: pac::timer::TimAdv = pac::TIM1;
pub(crate) const MUTE_TIMER_HZ: u32 = 168_000_000;
pub(crate) const MUTE_CHANNEL: usize = 2;
pub(crate) const MUTE_IS_COMPLEMENTARY: bool = true;
pub(crate) const MUTE_FUNCTION: u8 = 1;
// The user button B1 is PA0 (UM1472).
pub(crate) const BUTTON_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOA, 0);
pub(crate) const MUTE_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOB, 1);
// The stop input is PE15: TIM1's break input (alternate function 1, DS8626 table 9).
pub(crate) const STOP_INPUT_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOE, 15);
pub(crate) const STOP_INPUT_FUNCTION: u8 = 1;

// The trigger output is PB8: TIM4's channel 3 (alternate function 2, DS8626 table 9). TIM4's internal trigger 3 is TIM8
// (RM0090 18.4.3).
pub(crate) type TriggerTimer = peripherals::TIM4;
pub(crate) const TRIGGER_TIMER: pac::timer::TimGp16 = pac::TIM4;
pub(crate) const TRIGGER_SOURCE: pac::timer::vals::Ts = pac::timer::vals::Ts::ITR3;
pub(crate) const TRIGGER_CHANNEL: usize = 2;
pub(crate) const TRIGGER_FUNCTION: u8 = 2;
// The trigger input is PB7: TIM4's channel 2 (alternate function 2 as well, DS8626 table 9).
pub(crate) const TRIGGER_INPUT_CHANNEL: usize = 1;

/// DAC_CR.TSEL1: 001 is TIM8 TRGO (RM0090 table 76).
pub(crate) const DAC_TRIGGER: u8 = 0b001;
/// DAC1 is served by DMA1 stream 5 only, as its channel 7 (RM0090 table 43).
pub(crate) const DAC_WAY: Way = Way { controller: pac::DMA1, number: 5, request: 7, purpose: Purpose::Feed };
pub(crate) type DacDma = peripherals::DMA1_CH5;

// The inputs are PA1 (sensor, ADC1's channel 1) and PA2 (shunt, ADC2's channel 2), free on this board's headers.
pub(crate) const SENSE_CHANNELS: [u8; INPUTS] = [1, 2];
/// ADC_CR2.EXTSEL: 1110 is TIM8 TRGO (RM0090 13.13.3).
pub(crate) const SENSE_TRIGGER: u8 = 0b1110;
/// ADC1 is served by DMA2 stream 0, as its channel 0 (RM0090 table 44). DMA1 does not reach APB2.
pub(crate) const SENSE_WAY: Way =
    Way { controller: pac::DMA2, number: 0, request: 0, purpose: Purpose::Collect };
pub(crate) type SenseDma = peripherals::DMA2_CH0;

/// The channel of a stream is chosen in its CHSEL.
pub(crate) fn route_dma(way: &Way, w: &mut pac::dma::regs::Cr) {
    w.set_chsel(way.request);
}

/// Sectors 1 and 2, as offsets from 0x0800_0000; the program leaves them out (memory/f407vg.x).
pub(crate) const FLASH_SLOTS: [u32; 2] = [0x4000, 0x8000];
pub(crate) const SLOT_BYTES: usize = 16 * 1024;
/// Sectors 3 and 7, of 16 and 128 KiB: the program ends below sector 7 (memory/f407vg.x).
pub(crate) const PROFILE_SLOTS: [(u32, usize); 2] = [(0xc000, 16 * 1024), (0x6_0000, 128 * 1024)];

pub(crate) const WATCHDOG: pac::iwdg::Iwdg = pac::IWDG;
/// One count is 1 ms at the nominal 32 kHz.
pub(crate) const WATCHDOG_PRESCALER: u32 = 32;
/// The watchdog's oscillator runs at 17 to 47 kHz (DS8626 table 35).
pub(crate) const WATCHDOG_FASTEST_HZ: u32 = 47_000;
/// The nominal period around an erasure: 2.7 s to 7.5 s. Of a table the longest stall is the erasure of a 16 KiB sector, 500 ms at most at
/// 32 bits (DS8626 table 40; `store/f4.rs`), and the writing of 8.5 KiB after it, 2176 words of at most 100 us each: together 0.72 s. Of a
/// profile it is the erasure of a 128 KiB sector, 2 s at most, and 32 words: within the shortest period.
pub(crate) const ERASURE_WATCHDOG_MS: u32 = 4_000;

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

/// embassy-stm32 sets the five wait states that 168 MHz needs, and the same write switches the flash's caches off. With
/// the caches the core runs almost as with zero wait states (RM0090 3.5.2). The prefetch of revision A is faulty
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

/// Nothing to do: this timer has no gate at its break input (RM0090 17.3.12).
pub(crate) fn admit_break_pin() {}

/// SYSCFG_MEMRMP.MEM_MODE = 01: system memory at address 0, as it is when BOOT0 chooses it (RM0090 9.2.1).
pub(crate) fn map_system_memory() {
    pac::RCC.apb2enr().modify(|w| w.set_syscfgen(true));
    pac::SYSCFG.memrm().modify(|w| w.set_mem_mode(0b01));
}

/// Nothing to do: the ROM starts its USB whatever this program has left on.
pub(crate) fn stop_usb_clocks() {}

pub(crate) fn take(p: Peripherals) -> Board {
    // PA4 is also the word select of the board's audio codec. PD4 low keeps that chip in reset, so it does not disturb
    // the pin. `forget`, because an `Output` that is dropped makes its pin an input again.
    core::mem::forget(Output::new(p.PD4, Level::Low, Speed::Low));
    // The switch that would feed the USB socket from the board, for a device in it (UM1472: PC0, active low; so ChibiOS has
    // it for this board). Here a host feeds it.
    core::mem::forget(Output::new(p.PC0, Level::High, Speed::Low));
    Board {
        // PB1 is free on this board's headers. The wiring has a resistor to ground on it (BOARDS.md).
        unmute: MutedPin::take(p.PB1),
        mute_timer: p.TIM1,
        // PB8 is free on this board's headers.
        trigger: low(p.PB8),
        trigger_input: Flex::new(p.PB7),
        trigger_timer: p.TIM4,
        // LD4, green.
        lamp: Output::new(p.PD12, Level::Low, Speed::Low),
        dac: p.DAC1,
        sample_timer: p.TIM8,
        dac_stream: p.DMA1_CH5,
        dac_pin: p.PA4,
        sensors: (p.ADC1, p.ADC2, p.DMA2_CH0),
        sense_pins: [Flex::new(p.PA1), Flex::new(p.PA2)],
        button: Flex::new(p.PA0),
        stop_input: Flex::new(p.PE15),
        flash: p.FLASH,
        link: Link { core: p.USB_OTG_FS, dp: p.PA12, dm: p.PA11 },
    }
}

/// The start waits for the crystal.
pub(crate) const fn has_clock() -> bool {
    true
}

/// RCC_CR.CSSON: if the crystal stops, the internal oscillator takes over, the mute timer gets a break, and the NMI comes
/// (RM0090 7.2.7).
pub(crate) fn guard_clock() {
    pac::RCC.cr().modify(|w| w.set_csson(true));
}

/// Whether the NMI came because the crystal has stopped. Clears the flag, which would raise the NMI again.
pub(crate) fn take_clock_failure() -> bool {
    let has_failed = pac::RCC.cir().read().cssf();
    pac::RCC.cir().modify(|w| w.set_cssc(true));
    has_failed
}

/// A debugger that halts the core stops the sample timer, but not the mute timer, which so runs out (RM0090 38.16.4 and
/// 38.16.5). These registers keep what a debugger has written through a reset, so both bits are written.
pub(crate) fn set_debug_freezes() {
    pac::DBGMCU.apb2fzr().modify(|w| {
        w.set_tim8(true);
        w.set_tim1(false);
    });
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

/// Level 3 resets below 2.83 V until 2.92 V (2.97 V at most, which this board's supply may never reach); level 2 has 2.50 V and 2.59 V
/// (DS8626 table 19). Both are accepted. Chips leave the factory with level 0, off.
pub(crate) const BROWN_OUT_LEVEL: u8 = 2;

/// The chip's device id and its revision (DBGMCU_IDCODE, RM0090 38.6.1).
pub(crate) fn chip() -> (u16, u16) {
    let identity = pac::DBGMCU.idcode().read();
    (identity.dev_id(), identity.rev_id())
}

/// The F407's RAM has no error correction.
pub(crate) fn watch_ram() {}

pub(crate) fn ram_errors() -> Option<u8> {
    None
}

/// The buffered DAC is linear from 0.2 V to VDDA - 0.2 V (DS8626, DAC characteristics): 1.3 V of the half swing of 1.5 V.
pub(crate) const LINEAR_PER_MILLE: u16 = 870;
/// VREFINT_CAL, and the VDDA at which the factory measured it, in mV (DS8626, internal reference voltage calibration values).
pub(crate) const REFERENCE_CALIBRATION: (usize, u32) = (0x1fff_7a2a, 3300);

/// PWR_CR.PLS = 100: the supply detector trips at 2.66 V and releases at 2.76 V (DS8626 table 19). This board feeds its
/// chip with 2.9 to 3.0 V, too near to the next levels: 101 releases at 2.93 V, 110 at 3.03 V. A detector that has
/// already tripped when it is switched on would reset the program again and again.
pub(crate) fn start_supply_detector() {
    pac::PWR.cr1().modify(|w| {
        w.set_pls(0b100);
        w.set_pvde(true);
    });
}
