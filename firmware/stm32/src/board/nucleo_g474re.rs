//! NUCLEO-G474RE: STM32G474RE, the link through the ST-LINK's virtual serial port.
//!
//! Sections and tables are those of RM0440 Rev 9 and of the data sheet DS12288 Rev 6.

use embassy_stm32::gpio::{Flex, Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::adc::Adc;
use embassy_stm32::pac::adc::vals::SampleTime;
use embassy_stm32::pac::adccommon::vals::{Ckmode, Dmacfg, Dual, Mdma};
use embassy_stm32::pac::flash::vals::Latency;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, Uart};
use embassy_stm32::{Config, Peri, Peripherals, interrupt, peripherals, rcc};
use slipline_app::ports::INPUTS;

use super::{Board, MutedPin, low};
use crate::dma::{Purpose, Way};
use crate::reset::ResetFlags;
use crate::{dac, priority, supply, uart_link};

pub(crate) const NAME: &str = "NUCLEO-G474RE";

// Clocks (RM0440 7.2, DS12288 table 46). The board's crystal X3 has 24 MHz.
//   VCO in = 24 / 6 = 4 MHz (PLLM = 6; 2.66 to 16 MHz allowed), VCO = 4 * 85 = 340 MHz (PLLN = 85; at most 344 MHz),
//   SYSCLK = 340 / 2 = 170 MHz (PLLR = 2), which needs range 1 boost mode (RM0440 table 38).
//   RM0440 6.1.5 wants the AHB at half of that for 1 us after the switch. The write by which embassy-stm32 0.6 switches sets the
//   AHB's prescaler, too; so embassy gets the half rate for good, and `raise` ends it.
//   AHB = APB1 = APB2 = 170 MHz. TIM4, the sample timer, is on APB1, which is not divided: 170 MHz.
//   170 MHz / 425 = 400 kHz.
pub(crate) const CORE_HZ: u32 = 170_000_000;
pub(crate) const TIMER_HZ: u32 = 170_000_000;
pub(crate) const TIMER_PERIOD: u16 = 425;
/// embassy's record of the clocks is that before [`raise`]: the half.
pub(crate) const RAISED: u32 = 2;

// The sample timer is TIM4; TIM8 has the mute pin. Its trigger output reaches the DAC, the ADCs (adc_ext_trg12 of ADC1 and
// ADC2, below), and other timers, which TIM6's does not.
pub(crate) type SampleTimer = peripherals::TIM4;
pub(crate) const SAMPLE_TIMER: pac::timer::TimGp16 = pac::TIM4;

// The mute pin is PB5: TIM8's channel 3, complementary output (alternate function 3, DS12288 table 13). TIM8 is on APB2,
// which is not divided: 170 MHz.
pub(crate) type MuteTimer = peripherals::TIM8;
pub(crate) const MUTE_TIMER: pac::timer::TimAdv = pac::TIM8;
pub(crate) const MUTE_TIMER_HZ: u32 = 170_000_000;
pub(crate) const MUTE_CHANNEL: usize = 2;
pub(crate) const MUTE_IS_COMPLEMENTARY: bool = true;
pub(crate) const MUTE_FUNCTION: u8 = 3;
// The user button B1 is PC13 (UM2505).
pub(crate) const BUTTON_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOC, 13);
pub(crate) const MUTE_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOB, 5);
// The stop input is PB7: TIM8's break input (alternate function 5, DS12288 table 13).
pub(crate) const STOP_INPUT_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOB, 7);
pub(crate) const STOP_INPUT_FUNCTION: u8 = 5;

// The trigger output is PC7: TIM3's channel 2 (alternate function 2, DS12288 table 13). TIM3's internal trigger 3 is TIM4
// (RM0440, interconnection of TIM2 to TIM5, tim_itr3).
pub(crate) type TriggerTimer = peripherals::TIM3;
pub(crate) const TRIGGER_TIMER: pac::timer::TimGp16 = pac::TIM3;
pub(crate) const TRIGGER_SOURCE: pac::timer::vals::Ts = pac::timer::vals::Ts::ITR3;
pub(crate) const TRIGGER_CHANNEL: usize = 1;
pub(crate) const TRIGGER_FUNCTION: u8 = 2;
// The trigger input is PA6: TIM3's channel 1 (alternate function 2 as well, DS12288 table 13).
pub(crate) const TRIGGER_INPUT_CHANNEL: usize = 0;

/// DAC_CR.TSEL1 of DAC1: 0101 is TIM4 TRGO (RM0440 table 186, dac_chx_trg5).
pub(crate) const DAC_TRIGGER: u8 = 5;
/// DMA1 channel 1, which the register arrays count as 0. DMAMUX input 6 is DAC1's channel 1 (RM0440 table 93).
pub(crate) const DAC_WAY: Way = Way { controller: pac::DMA1, number: 0, request: 6, purpose: Purpose::Feed };
pub(crate) type DacDma = peripherals::DMA1_CH1;

// The inputs are PA0 (A0 on the Arduino header; sensor, ADC1's channel 1) and PA1 (A1; shunt, ADC2's channel 2).
pub(crate) const SENSE_CHANNELS: [u8; INPUTS] = [1, 2];
/// ADC_CFGR.EXTSEL: 12 is TIM4 TRGO (RM0440, ADC1/2 external triggers, adc_ext_trg12).
pub(crate) const SENSE_TRIGGER: u8 = 12;
/// DMA1 channel 2. DMAMUX input 5 is ADC1 (RM0440 table 93).
pub(crate) const SENSE_WAY: Way =
    Way { controller: pac::DMA1, number: 1, request: 5, purpose: Purpose::Collect };
pub(crate) type SenseDma = peripherals::DMA1_CH2;

/// The link's UART. DMA1 channels 3 and 4; DMAMUX inputs 26 and 27 are USART2's receiver and transmitter (RM0440 table 93; also in
/// embassy-stm32's table of the chip).
pub(crate) const LINK_UART: pac::usart::Usart = pac::USART2;
pub(crate) const RECEIVE_WAY: Way =
    Way { controller: pac::DMA1, number: 2, request: 26, purpose: Purpose::Receive };
pub(crate) const SEND_WAY: Way =
    Way { controller: pac::DMA1, number: 3, request: 27, purpose: Purpose::Send };

// The ADCs' clock is the AHB's divided by 4, 42.5 MHz: at most 52 MHz with several ADCs and a supply of 2.7 V or more (DS12288
// table 66). 47.5 cycles of sampling and 12.5 of conversion, after 2.125 of latency (DS12288 table 66, CKMODE = 11), are
// 1.46 us of 2.5 us. 47.5 cycles charge the 5 pF through more than 20 kOhm to a quarter of a code.
//   held: (2.125 + 47.5) / 42.5 MHz = 1167.6 ns after the trigger. The timer's 425 cycles of the AHB are not a multiple of 4,
//   so the trigger waits for the divider for 0, 3, 2, 1 cycles in turn, 8.8 ns on average, which is added.
//   the DAC's output register changes three cycles of the AHB after the trigger (RM0440, DAC conversion), 17.6 ns.
pub(crate) const SENSE_DELAY_NS: i32 = 1159;

/// The clock of both ADCs, and that they convert together and give their codes as one word (RM0440, ADC12_CCR). The requests
/// go on when the DMA begins its ring again, which also keeps revision Y from converting channel 0 (ES0430 2.7.8).
pub(crate) fn tune_adcs() {
    pac::ADC12_COMMON.ccr().write(|w| {
        w.set_ckmode(Ckmode::SYNC_DIV4);
        w.set_dual(Dual::DUAL_R);
        w.set_mdma(Mdma::ENABLED12B10B);
        w.set_dmacfg(Dmacfg::CIRCULAR);
    });
}

/// The sampling time of one of the channels 0 to 9; a reset sets 12 bits.
pub(crate) fn tune_adc(adc: Adc, channel: u8) {
    adc.smpr().write(|w| w.set_smp(channel.into(), SampleTime::CYCLES47_5));
}

/// Two slots of eight pages of 2 KiB at the end of bank 2, as offsets from 0x0800_0000. With option bit DBANK = 0 there
/// is no bank 2 (no chip is delivered so): embassy-stm32 panics, and the program restarts over and over, muted.
pub(crate) const FLASH_SLOTS: [u32; 2] = [0x7_8000, 0x7_c000];
pub(crate) const SLOT_BYTES: usize = 16 * 1024;
/// The 32 KiB before them.
pub(crate) const PROFILE_SLOTS: [(u32, usize); 2] = [(0x7_0000, SLOT_BYTES), (0x7_4000, SLOT_BYTES)];

pub(crate) const WATCHDOG: pac::iwdg::Iwdg = pac::IWDG;
/// One count is 1 ms at the nominal 32 kHz.
pub(crate) const WATCHDOG_PRESCALER: u32 = 32;
/// The watchdog's oscillator runs at 29.5 to 34 kHz (DS12288 table 45).
pub(crate) const WATCHDOG_FASTEST_HZ: u32 = 34_000;
/// The nominal period around an erasure. Eight pages erase in 8 * 24.5 ms at most (DS12288 table 47), and 8.5 KiB are
/// written in 1088 * 0.1 ms: 0.31 s together, far below half of the period.
pub(crate) const ERASURE_WATCHDOG_MS: u32 = 2_000;

/// System memory (AN2606, bootloader V13.x: USART, I2C, SPI, USB DFU on PA11/PA12).
pub(crate) const SYSTEM_MEMORY: u32 = 0x1fff_0000;

#[interrupt]
fn USART2() {
    uart_link::on_uart();
}

#[interrupt]
fn DMA1_CHANNEL3() {
    uart_link::on_received();
}

#[interrupt]
fn DMA1_CHANNEL4() {
    uart_link::on_sent();
}

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
pub(crate) const READ_INTERRUPT: interrupt::Interrupt = interrupt::DMA1_CHANNEL3;
pub(crate) const SEND_INTERRUPT: interrupt::Interrupt = interrupt::DMA1_CHANNEL4;

/// On the internal oscillator, 16 MHz: `take` raises the clocks.
pub(crate) fn config() -> Config {
    let mut config = Config::default();
    config.bdma_interrupt_priority = priority::DAC;
    config
}

/// The clock tree above.
fn clocks() -> rcc::Config {
    let mut clocks = rcc::Config::default();
    clocks.hse = Some(Hse { freq: Hertz(24_000_000), mode: HseMode::Oscillator });
    clocks.pll = Some(Pll {
        source: PllSource::HSE,
        prediv: PllPreDiv::DIV6,
        mul: PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(PllRDiv::DIV2),
    });
    clocks.sys = Sysclk::PLL1_R;
    clocks.boost = true;
    // Until `raise`.
    clocks.ahb_pre = AHBPrescaler::DIV2;
    clocks.apb1_pre = APBPrescaler::DIV1;
    clocks.apb2_pre = APBPrescaler::DIV1;
    clocks
}

/// Range 1's boost mode, which 170 MHz need: PWR_CR5.R1MODE = 0, bit 8 (RM0440 6.4.21). stm32-metapac 21 has that field at
/// bit 0, so embassy-stm32's own `boost` clears a bit that does not exist. It cannot be done before embassy's start, which
/// resets PWR; so the start leaves the clocks slow, and they are raised after it. The AHB is divided before it (RM0440 6.1.5).
fn boost() {
    pac::RCC.cfgr().modify(|w| w.set_hpre(AHBPrescaler::DIV2));
    pac::PWR.cr5().modify(|w| w.0 &= !(1 << 8));
}

/// The last step to 170 MHz: the AHB's prescaler from 2 to 1, 1 us after the switch to the PLL or later (RM0440 6.1.5), with the wait
/// states of the full rate set before (3.3.3). TIM5, embassy's time, keeps its pace: nothing waits for it yet.
fn raise() {
    const WAIT_STATES: Latency = Latency::WS4;
    pac::FLASH.acr().modify(|w| w.set_latency(WAIT_STATES));
    while pac::FLASH.acr().read().latency() != WAIT_STATES {}
    // At 85 MHz 2 us.
    cortex_m::asm::delay(CORE_HZ / 1_000_000);
    pac::RCC.cfgr().modify(|w| w.set_hpre(AHBPrescaler::DIV1));
    let time = pac::TIM5;
    time.psc().write_value((TIMER_HZ / embassy_time::TICK_HZ as u32 - 1) as u16);
    // Loads the prescaler, without the update's flag.
    time.cr1().modify(|w| w.set_urs(Urs::COUNTER_ONLY));
    time.egr().write(|w| w.set_ug(true));
    time.cr1().modify(|w| w.set_urs(Urs::ANY_EVENT));
}

/// After a reset the caches are on and the prefetch is off (RM0440 3.7.1).
pub(crate) fn tune_flash() {
    pac::FLASH.acr().modify(|w| {
        w.set_icen(true);
        w.set_dcen(true);
        w.set_prften(true);
    });
}

/// DAC_MCR.HFSEL must be 10 because the DAC's clock is the AHB at 170 MHz, above 160 MHz (RM0440 22.7.16). It can be
/// written only while both channels are off.
pub(crate) fn tune_dac() {
    pac::DAC1.mcr().modify(|w| w.set_hfsel(0b10));
}

/// TIM8_AF1.BKINE lets the pin with the timer's BKIN function through to the break input. BKINP stays 0: not inverted (RM0440, TIMx_AF1;
/// the fields are also in stm32-metapac's `Af1Adv`). After a reset BKINE is 1 by the manual; no chip was looked at.
pub(crate) fn admit_break_pin() {
    MUTE_TIMER.af1().modify(|w| w.set_bkine(true));
}

/// SYSCFG_MEMRMP.MEM_MODE = 001: system memory at address 0, as it is when BOOT0 chooses it (RM0440 10.2.1).
pub(crate) fn map_system_memory() {
    pac::RCC.apb2enr().modify(|w| w.set_syscfgen(true));
    pac::SYSCFG.memrmp().modify(|w| w.set_mem_mode(0b001));
}

/// Nothing to do: this link has no USB core.
pub(crate) fn stop_usb_clocks() {}

pub(crate) struct Link {
    uart: Peri<'static, peripherals::USART2>,
    receive: Peri<'static, peripherals::PA3>,
    transmit: Peri<'static, peripherals::PA2>,
    channels: (Peri<'static, peripherals::DMA1_CH3>, Peri<'static, peripherals::DMA1_CH4>),
}

pub(crate) fn take(mut p: Peripherals) -> Board {
    boost();
    rcc::reinit(clocks(), &mut p.RCC);
    raise();
    Board {
        // PB5, D4 on the Arduino header; not PB4 or PB6, which USB-C's dead-battery resistors pull after reset. The
        // wiring has a resistor to ground on it (BOARDS.md).
        unmute: MutedPin::take(p.PB5),
        mute_timer: p.TIM8,
        // PC7, D9 on the Arduino header.
        trigger: low(p.PC7),
        trigger_input: Flex::new(p.PA6),
        trigger_timer: p.TIM3,
        // LD2, green.
        lamp: Output::new(p.PA5, Level::Low, Speed::Low),
        dac: p.DAC1,
        sample_timer: p.TIM4,
        dac_stream: p.DMA1_CH1,
        dac_pin: p.PA4,
        sensors: (p.ADC1, p.ADC2, p.DMA1_CH2),
        sense_pins: [Flex::new(p.PA0), Flex::new(p.PA1)],
        button: Flex::new(p.PC13),
        stop_input: Flex::new(p.PB7),
        flash: p.FLASH,
        link: Link { uart: p.USART2, receive: p.PA3, transmit: p.PA2, channels: (p.DMA1_CH3, p.DMA1_CH4) },
    }
}

impl Link {
    /// USART2 on PA2 and PA3 (alternate function 7), which the board wires to the ST-LINK. UM2505 names LPUART1 for
    /// them (alternate function 12); both peripherals can use these pins. The clock is APB1: 170 MHz / 184 = 923913
    /// baud, 0.25 % from 921600. embassy-stm32 sets up pins, clock, rate and FIFOs and enables the interrupt; the rest of the UART is the
    /// link's. Panics if the pins or the rate are impossible, which does not depend on outside data.
    pub(crate) fn open(self, mut config: usart::Config) {
        let Self { uart, receive, transmit, channels } = self;
        config.baudrate /= RAISED;
        match Uart::new_blocking(uart, receive, transmit, config) {
            // A driver that is dropped switches its UART off.
            Ok(uart) => core::mem::forget(uart),
            Err(error) => panic!("USART2: {error:?}"),
        }
        // They are the link's from now on.
        let _ = channels;
    }
}

/// The start waits for the crystal.
pub(crate) const fn has_clock() -> bool {
    true
}

/// RCC_CR.CSSON: if the crystal stops, the internal oscillator takes over, the mute timer gets a break, and the NMI comes
/// (RM0440 7.2.10; the failure is one of the break's internal sources, 28.3.18).
pub(crate) fn guard_clock() {
    pac::RCC.cr().modify(|w| w.set_csson(true));
}

/// Whether the NMI came because the crystal has stopped. Clears the flag, which would raise the NMI again.
pub(crate) fn take_clock_failure() -> bool {
    let has_failed = pac::RCC.cifr().read().cssf();
    pac::RCC.cicr().write(|w| w.set_cssc(true));
    has_failed
}

/// A debugger that halts the core stops the sample timer, but not the mute timer, which so runs out (RM0440, DBGMCU).
/// These registers keep what a debugger has written through a reset, so both bits are written.
pub(crate) fn set_debug_freezes() {
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_tim4(true));
    pac::DBGMCU.apb2fzr().modify(|w| w.set_tim8(false));
}

/// RCC_CSR (RM0440 7.4.28): every reset sets PINRSTF too. A power-on sets BORRSTF (there is no separate flag), so a
/// reset by the brown-out level looks like a power-on here. A dip that ends above that level is reported as a
/// brown-out, from the record that the supply detector's handler leaves. Clears the flags.
pub(crate) fn take_reset_flags() -> ResetFlags {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    ResetFlags {
        watchdog: flags.iwdgrstf() || flags.wwdgrstf(),
        // The option bytes' loader resets, too (`store/g4.rs`).
        software: flags.sftrstf() || flags.oblrstf(),
        power_on: flags.borrstf(),
        brown_out: false,
        pin: flags.pinrstf(),
    }
}

/// Level 4 resets below 2.8 V (RM0440 3.7.8); chips leave the factory with level 0, 1.7 V.
pub(crate) const BROWN_OUT_LEVEL: u8 = 4;

/// The chip's device id and its revision (DBGMCU_IDCODE, RM0440 47.6.1).
pub(crate) fn chip() -> (u16, u16) {
    let identity = pac::DBGMCU.idcode().read();
    // 12 bits; stm32-metapac 21 has 16 of them.
    (identity.dev_id() & 0xfff, identity.rev_id())
}

/// The G474's RAM has a parity, which is not watched.
pub(crate) fn watch_ram() {}

pub(crate) fn ram_errors() -> Option<u8> {
    None
}

/// The buffered DAC is linear from 0.2 V to VREF+ - 0.2 V (DS12288, DAC characteristics): 1.45 V of the half swing of 1.65 V.
pub(crate) const LINEAR_PER_MILLE: u16 = 880;

/// The internal reference VREFINT is channel 18 of ADC1 (RM0440, ADC connectivity).
pub(crate) const REFERENCE_ADC: Adc = pac::ADC1;
pub(crate) const REFERENCE_CHANNEL: u8 = 18;
/// VREFINT_CAL, and the VREF+ at which the factory measured it, in mV (DS12288, internal voltage reference calibration values).
pub(crate) const REFERENCE_CALIBRATION: (usize, u32) = (0x1fff_75aa, 3000);

/// ADC1's clock as `tune_adcs` sets it, on its own, with the reference connected: its buffer is up within 12 us, less than the
/// regulator takes (DS12288, embedded internal voltage reference).
pub(crate) fn start_reference() {
    rcc::enable_and_reset::<peripherals::ADC1>();
    pac::ADC12_COMMON.ccr().write(|w| {
        w.set_ckmode(Ckmode::SYNC_DIV4);
        w.set_vrefen(true);
    });
}

/// 640.5 cycles of 42.5 MHz are 15 us, of which the reference wants 4 (DS12288).
pub(crate) fn tune_reference(adc: Adc, channel: u8) {
    adc.smpr2().write(|w| w.set_smp(usize::from(channel) - 10, SampleTime::CYCLES640_5));
}

/// The clock is off again, so that `sense` resets both ADCs before they serve the inputs: embassy-stm32 0.6 counts who uses the
/// clock that they share, and resets for the first one only.
pub(crate) fn end_reference() {
    rcc::disable::<peripherals::ADC1>();
}

/// PWR_CR2.PLS = 110 (RM0440 6.4.2): the supply detector trips at 2.90 V (DS12288 table 19).
pub(crate) fn start_supply_detector() {
    pac::PWR.cr2().modify(|w| {
        w.set_pls(0b110);
        w.set_pvde(true);
    });
    // SYSCFG_CFGR2: PVDL and CLL connect the detector and the core's lock-up with the break of TIM1, 8, 15, 16, 17 and 20, and
    // keep that, PVDE and PLS until the next reset (RM0440, SYSCFG_CFGR2; the break's internal sources: 28.3.18).
    pac::RCC.apb2enr().modify(|w| w.set_syscfgen(true));
    pac::SYSCFG.cfgr2().modify(|w| {
        w.set_pvdl(true);
        w.set_cll(true);
    });
}
