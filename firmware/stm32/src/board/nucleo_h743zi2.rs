//! NUCLEO-H743ZI2: STM32H743ZI, USB on the user's micro-AB socket.
//!
//! RM0433 is cited by register; tables are those of the data sheet DS12110 Rev 10.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_stm32::gpio::{Flex, Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::adc::Adc;
use embassy_stm32::pac::adc::vals::{Boost, Dmngt, Ovrmod, Pcsel, Res, SampleTime};
use embassy_stm32::pac::adccommon::vals::{Ckmode, Damdf, Dual, Presc};
use embassy_stm32::pac::common::{RW, Reg};
use embassy_stm32::pac::crs::vals::Syncsrc;
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Hsi48Config, Pll, PllDiv, PllMul, PllPreDiv, PllSource, Sysclk,
    VoltageScale, mux,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals, interrupt, peripherals, rcc};
use slipline_app::ports::INPUTS;

use super::{Board, MutedPin, low};
use crate::dma::{Purpose, Way};
use crate::reset::ResetFlags;
use crate::{dac, priority, supply};

/// The core on PA11 and PA12, which the reference manual calls OTG2.
pub(crate) use crate::usb_link::Usb as Link;

pub(crate) const NAME: &str = "NUCLEO-H743ZI2";

// Clocks (RM0433, RCC; DS12110 table 50). The ST-LINK feeds 8 MHz into OSC_IN (bypass mode).
//   VCO in = 8 / 1 = 8 MHz (DIVM1 = 1), VCO = 8 * 100 = 800 MHz (DIVN1 = 100; wide range, 192 to 836 MHz),
//   SYSCLK = 800 / 2 = 400 MHz (DIVP1 = 2), the limit of voltage scale 1.
//   HCLK = 400 / 2 = 200 MHz, APB1 to APB4 = 200 / 2 = 100 MHz.
//   TIM8, the sample timer, is on APB2; with TIMPRE = 0 and APB2 divided by 2 its timers run at HCLK = 200 MHz (RM0433,
//   RCC_CFGR).
//   200 MHz / 500 = 400 kHz.
//   USB: VCO = 8 * 60 = 480 MHz (DIVM3 = 1, DIVN3 = 60), 480 / 10 = 48 MHz (DIVQ3 = 10), as exact as the ST-LINK's
//   clock. The VCO must be above 420 MHz: below, embassy-stm32 0.6 chooses the medium VCO range, which is for inputs of
//   1 to 2 MHz only (DS12110, PLL characteristics, medium VCO frequency range).
//   Without the ST-LINK's clock (its socket has no cable) the PLLs count HSI, 64 MHz / 8 = 8 MHz (DIVM1 = DIVM3 = 8), which is some
//   per cent off: the same clocks by their names, and the device is never armed. USB then has HSI48. Full speed needs 0.25 %, so the
//   CRS trims HSI48 by the USB core's frames (`trim_usb_clock`).
pub(crate) const CORE_HZ: u32 = 400_000_000;
pub(crate) const TIMER_HZ: u32 = 200_000_000;
pub(crate) const TIMER_PERIOD: u16 = 500;
/// embassy's record of the clocks is the chip's.
pub(crate) const RAISED: u32 = 1;

// The sample timer is TIM8. Its trigger output reaches the DAC and the ADCs (below).
pub(crate) type SampleTimer = peripherals::TIM8;
pub(crate) const SAMPLE_TIMER: pac::timer::TimAdv = pac::TIM8;

// The mute pin is PE9: TIM1's channel 1 (alternate function 1, DS12110 table 13). TIM1 is on APB2; with TIMPRE = 0 and
// APB2 divided by 2 its timers run at HCLK = 200 MHz.
pub(crate) type MuteTimer = peripherals::TIM1;
pub(crate) const MUTE_TIMER: pac::timer::TimAdv = pac::TIM1;
pub(crate) const MUTE_TIMER_HZ: u32 = 200_000_000;
pub(crate) const MUTE_CHANNEL: usize = 0;
pub(crate) const MUTE_IS_COMPLEMENTARY: bool = false;
pub(crate) const MUTE_FUNCTION: u8 = 1;
// The user button B1 is PC13 (UM2407).
pub(crate) const BUTTON_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOC, 13);
pub(crate) const MUTE_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOE, 9);
// The stop input is PE15: TIM1's break input (alternate function 1, DS12110 table 14).
pub(crate) const STOP_INPUT_PIN: (pac::gpio::Gpio, usize) = (pac::GPIOE, 15);
pub(crate) const STOP_INPUT_FUNCTION: u8 = 1;

// The trigger output is PD15: TIM4's channel 4 (alternate function 2, DS12110 table 12). TIM4's internal trigger 3 is TIM8
// (RM0433, TIMx internal trigger connection).
pub(crate) type TriggerTimer = peripherals::TIM4;
pub(crate) const TRIGGER_TIMER: pac::timer::TimGp16 = pac::TIM4;
pub(crate) const TRIGGER_SOURCE: pac::timer::vals::Ts = pac::timer::vals::Ts::ITR3;
pub(crate) const TRIGGER_CHANNEL: usize = 3;
pub(crate) const TRIGGER_FUNCTION: u8 = 2;
// The trigger input is PD14: TIM4's channel 3 (alternate function 2 as well, DS12110 table 12).
pub(crate) const TRIGGER_INPUT_CHANNEL: usize = 2;

/// DAC_CR.TSEL1: 7 is TIM8 TRGO (RM0433, dac_ch1_trg7).
pub(crate) const DAC_TRIGGER: u8 = 7;
/// DMA1 stream 0. DMAMUX1 channels 0 to 7 feed streams 0 to 7 of DMA1; its input 67 is DAC1's channel 1 (RM0433, DMAMUX1).
pub(crate) const DAC_WAY: Way = Way { controller: pac::DMA1, number: 0, request: 67, purpose: Purpose::Feed };
pub(crate) type DacDma = peripherals::DMA1_CH0;

// The inputs are PA3 (A0 on the Arduino header; sensor, ADC1's channel 15) and PC0 (A1; shunt, ADC2's channel 10).
pub(crate) const SENSE_CHANNELS: [u8; INPUTS] = [15, 10];
/// ADC_CFGR.EXTSEL: 7 is TIM8 TRGO (RM0433, ADC1/2/3 external triggers, adc_ext_trg7).
pub(crate) const SENSE_TRIGGER: u8 = 7;
/// DMA1 stream 1. DMAMUX1 input 9 is ADC1 (RM0433, adc1_dma).
pub(crate) const SENSE_WAY: Way =
    Way { controller: pac::DMA1, number: 1, request: 9, purpose: Purpose::Collect };
pub(crate) type SenseDma = peripherals::DMA1_CH1;

// The ADCs' kernel clock is PLL3's output R, 480 / 10 = 48 MHz, which they divide to 24 MHz: by PRESC = 2 in revision Y, which
// takes up to 36 MHz, and by a fixed 2 in later ones (DS12110, ADC characteristics; RM0433, ADC clocks). Both PLLs count the
// same 8 MHz, so a sample is 60 cycles, always in the same place. 32.5 cycles of sampling and 6.5 of conversion, after 3 of
// latency, are 1.77 us of 2.5 us. 32.5 cycles charge the 4 pF through more than 20 kOhm to a quarter of a code.
//   held: (3 + 32.5) / 24 MHz = 1479.2 ns after the trigger; the latency is 2.5 to 3.5 cycles (DS12110), 21 ns more or less,
//   by where the PLLs have locked.
//   the DAC's output register changes three cycles of APB1 after the trigger (RM0433, DAC trigger selection), 30 ns.
pub(crate) const SENSE_DELAY_NS: i32 = 1449;
const ADC_KERNEL_HZ: u32 = 48_000_000;

/// Whether the chip is of revision Y, the first that was sold (DBGMCU REV_ID).
fn is_revision_y() -> bool {
    pac::DBGMCU.idc().read().rev_id() == 0x1003
}

/// The clock of both ADCs, and that they convert together and give their codes as one word (RM0433, ADC12_CCR).
pub(crate) fn tune_adcs() {
    assert!(
        rcc::frequency::<peripherals::ADC1>().0 == ADC_KERNEL_HZ,
        "the ADCs do not run at the board's rate"
    );
    pac::ADC12_COMMON.ccr().write(|w| {
        w.set_ckmode(Ckmode::ASYNCHRONOUS);
        w.set_presc(if is_revision_y() { Presc::DIV2 } else { Presc::DIV1 });
        w.set_dual(Dual::DUAL_R);
        w.set_damdf(Damdf::FORMAT32TO10);
    });
}

/// One of the channels 10 to 19: its analogue switch and its sampling time; 12 bits, and a request for each word.
///
/// * BOOST is for clocks from 20 MHz on in revision Y, where it is one bit, and for 12.5 to 25 MHz in later ones.
/// * ADCALLIN: the calibration mends the steps of the conversion, too; without it codes are missing.
/// * OVRMOD = 1: without it the slave's codes may be shifted against the master's (ES0392, ADC slave data in dual regular
///   simultaneous mode). OVR is still set.
pub(crate) fn tune_adc(adc: Adc, channel: u8) {
    adc.cr().modify(|w| {
        w.set_boost(if is_revision_y() { Boost::LT12_5 } else { Boost::LT25 });
        w.set_adcallin(true);
    });
    adc.pcsel().write(|w| w.set_pcsel(channel.into(), Pcsel::PRESELECTED));
    adc.smpr(1).write(|w| w.set_smp(usize::from(channel) - 10, SampleTime::CYCLES32_5));
    adc.cfgr().modify(|w| {
        w.set_res(Res::BITS12);
        w.set_ovrmod(Ovrmod::OVERWRITE);
        w.set_dmngt(Dmngt::DMA_CIRCULAR);
    });
}

/// The request is chosen in the DMAMUX. TRBUFF (bufferable transfers) is for UARTs and stays 0.
pub(crate) fn route_dma(way: &Way, _: &mut pac::dma::regs::Cr) {
    pac::DMAMUX1.ccr(way.number).write(|w| w.set_dmareq_id(way.request));
}

/// The last two sectors of 128 KiB in bank 2, as offsets from 0x0800_0000.
pub(crate) const FLASH_SLOTS: [u32; 2] = [0x1c_0000, 0x1e_0000];
pub(crate) const SLOT_BYTES: usize = 128 * 1024;
/// The two sectors before them.
pub(crate) const PROFILE_SLOTS: [(u32, usize); 2] = [(0x18_0000, SLOT_BYTES), (0x1a_0000, SLOT_BYTES)];

pub(crate) const WATCHDOG: pac::iwdg::Iwdg = pac::IWDG1;
/// One count is 4 ms at the nominal 32 kHz.
pub(crate) const WATCHDOG_PRESCALER: u32 = 128;
/// The watchdog's oscillator runs at 29.8 to 33.6 kHz (DS12110 table 49).
pub(crate) const WATCHDOG_FASTEST_HZ: u32 = 33_600;
/// The nominal period around an erasure. The thread, but not the renderer, waits for it. embassy-stm32 0.6 erases with
/// FLASH_CR2.PSIZE as its last write has left it: 00, 8 bits at a time. That takes 4 s at most (DS12110 table 53; 2 s at
/// 64 bits). 272 flash words of at most 0.6 ms each follow: together 4.2 s, less than half of the shortest period.
pub(crate) const ERASURE_WATCHDOG_MS: u32 = 10_000;

/// System memory (AN2606; PA11/PA12 for DFU).
pub(crate) const SYSTEM_MEMORY: u32 = 0x1ff0_9800;

#[interrupt]
fn DMA1_STREAM0() {
    dac::on_dma();
}

#[interrupt]
fn PVD_AVD() {
    supply::on_dip();
}

pub(crate) const SUPPLY_INTERRUPT: interrupt::Interrupt = interrupt::PVD_AVD;
pub(crate) const DMA_INTERRUPT: interrupt::Interrupt = interrupt::DMA1_STREAM0;

/// Whether the ST-LINK's clock has come.
static HAS_CLOCK: AtomicBool = AtomicBool::new(false);
/// How long the start waits for it at least, in ms. The core has 64 MHz then.
const CLOCK_MS: u32 = 100;
const START_HZ: u32 = 64_000_000;

/// Whether the ST-LINK's clock runs: it was there at the start.
pub(crate) fn has_clock() -> bool {
    HAS_CLOCK.load(Relaxed)
}

/// Looks for the ST-LINK's clock (RM0433, RCC_CR: HSEBYP is written while HSEON is 0). One that is absent is switched off again, so that
/// the internal oscillators can be chosen instead.
fn find_clock() -> bool {
    pac::RCC.cr().modify(|w| w.set_hsebyp(true));
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    let is_ready = (0..CLOCK_MS).any(|_| {
        let is_ready = pac::RCC.cr().read().hserdy();
        if !is_ready {
            cortex_m::asm::delay(START_HZ / 1000);
        }
        is_ready
    });
    if !is_ready {
        pac::RCC.cr().modify(|w| w.set_hseon(false));
    }
    is_ready
}

pub(crate) fn config() -> Config {
    let mut config = Config::default();
    let has_clock = find_clock();
    HAS_CLOCK.store(has_clock, Relaxed);
    let (source, prediv) =
        if has_clock { (PllSource::HSE, PllPreDiv::DIV1) } else { (PllSource::HSI, PllPreDiv::DIV8) };
    config.rcc.hse = has_clock.then_some(Hse { freq: Hertz(8_000_000), mode: HseMode::Bypass });
    // `trim_usb_clock` synchronises it: embassy-stm32 0.6 always sets the CRS to OTG_HS.
    config.rcc.hsi48 = (!has_clock).then_some(Hsi48Config { sync_from_usb: false });
    config.rcc.pll1 = Some(Pll {
        source,
        prediv,
        mul: PllMul::MUL100,
        fracn: None,
        divp: Some(PllDiv::DIV2),
        divq: None,
        divr: None,
    });
    config.rcc.pll3 = Some(Pll {
        source,
        prediv,
        mul: PllMul::MUL60,
        fracn: None,
        divp: None,
        divq: Some(PllDiv::DIV10),
        divr: Some(PllDiv::DIV10),
    });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV2;
    config.rcc.apb1_pre = APBPrescaler::DIV2;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config.rcc.apb3_pre = APBPrescaler::DIV2;
    config.rcc.apb4_pre = APBPrescaler::DIV2;
    config.rcc.voltage_scale = VoltageScale::Scale1;
    config.rcc.mux.usbsel = if has_clock { mux::Usbsel::PLL3_Q } else { mux::Usbsel::HSI48 };
    config.rcc.mux.adcsel = mux::Adcsel::PLL3_R;
    config.dma_interrupt_priority = priority::DAC;
    config
}

/// The CRS trims HSI48 by the frames of the USB core on PA11 and PA12, which is OTG_FS: SYNCSRC = 00 (RM0433, CRS_CFGR; it is written
/// while CEN is 0). The reload value and the limit of a reset are those for 48 MHz and a frame a millisecond.
fn trim_usb_clock() {
    pac::RCC.apb1henr().modify(|w| w.set_crsen(true));
    pac::CRS.cfgr().modify(|w| w.set_syncsrc(Syncsrc::from_bits(0b00)));
    pac::CRS.cr().modify(|w| {
        w.set_autotrimen(true);
        w.set_cen(true);
    });
}

/// Nothing to do: this DAC has one speed.
pub(crate) fn tune_dac() {}

/// TIM1_AF1.BKINE lets the pin with the timer's BKIN function through to the break input. BKINP stays 0: not inverted (RM0433, TIMx_AF1;
/// the fields are also in stm32-metapac's `Af1Adv`). After a reset BKINE is 1 by the manual; no chip was looked at.
pub(crate) fn admit_break_pin() {
    MUTE_TIMER.af1().modify(|w| w.set_bkine(true));
}

/// Nothing to do: this chip has no remap to address 0, so VTOR alone leads to the bootloader's vectors.
pub(crate) fn map_system_memory() {}

/// RCC_AHB1ENR (RM0433 8.7.40): the enables of both USB cores and of their ULPI, bits 25 to 28. If a core is on at the reset the
/// ROM runs, but its DFU never appears to the host; resetting the core (AHB1RSTR) does not help, this does. Found on a
/// NUCLEO-H743ZI2 (ST's forum, thread 148198); the manual gives no reason.
pub(crate) fn stop_usb_clocks() {
    pac::RCC.ahb1enr().modify(|w| {
        w.set_usb_otg_hsen(false);
        w.set_usb_otg_hs_ulpien(false);
        w.set_usb_otg_fsen(false);
        w.set_usb_otg_fs_ulpien(false);
    });
}

/// The instruction cache hides the flash's wait states. The data cache stays off: it does not serve the DTCM, where the
/// variables are, and the DMA's ring must not be cached.
///
/// Revision Y (DBGMCU REV_ID 0x1003) may read the AXI SRAM wrongly when two reads are under way (errata sheet ES0392
/// Rev 8, 2.2.9). READ_ISS_OVERRIDE of AXI_TARG7_FN_MOD allows one read at a time, as the sheet advises.
pub(crate) fn tune_flash() {
    if is_revision_y() {
        // SAFETY: a register of the AXI interconnect (RM0433, AXI_TARGx_FN_MOD: base 0x5100_0000, target 7 at 0x8000,
        // FN_MOD at 0x108) that nothing else touches; it may be written at any time.
        unsafe { (0x5100_8108 as *mut u32).write_volatile(1) };
    }
    // SAFETY: called once, before any interrupt handler runs that could use the system control block.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    core.SCB.enable_icache();
}

pub(crate) fn take(p: Peripherals) -> Board {
    if !has_clock() {
        trim_usb_clock();
    }
    // The switch that would feed the USB socket from the board, for a device in it (UM2407: PD10, active high). Here a host feeds
    // it. NuttX and MicroPython name the same pin for this board (MB1364), and MicroPython switches it off by the same level; only
    // NuttX's host driver takes it for active low. PC0 is A1, the shunt's input, on this board.
    core::mem::forget(Output::new(p.PD10, Level::Low, Speed::Low));
    Board {
        // PE9, D6 on the Arduino header. The wiring has a resistor to ground on it (BOARDS.md).
        unmute: MutedPin::take(p.PE9),
        mute_timer: p.TIM1,
        // PD15, D9 on the Arduino header.
        trigger: low(p.PD15),
        trigger_input: Flex::new(p.PD14),
        trigger_timer: p.TIM4,
        // LD1, green.
        lamp: Output::new(p.PB0, Level::Low, Speed::Low),
        dac: p.DAC1,
        sample_timer: p.TIM8,
        dac_stream: p.DMA1_CH0,
        dac_pin: p.PA4,
        sensors: (p.ADC1, p.ADC2, p.DMA1_CH1),
        sense_pins: [Flex::new(p.PA3), Flex::new(p.PC0)],
        button: Flex::new(p.PC13),
        stop_input: Flex::new(p.PE15),
        flash: p.FLASH,
        link: Link { core: p.USB_OTG_FS, dp: p.PA12, dm: p.PA11 },
    }
}

/// RCC_CR.HSECSSON: if the ST-LINK's clock stops, the internal oscillator takes over, the mute timer gets a break, and the
/// NMI comes (RM0433 8.5.3).
pub(crate) fn guard_clock() {
    if !has_clock() {
        return;
    }
    pac::RCC.cr().modify(|w| w.set_hsecsson(true));
}

/// Whether the NMI came because the clock from outside has stopped. Clears the flag, which would raise the NMI again.
pub(crate) fn take_clock_failure() -> bool {
    let has_failed = pac::RCC.cifr().read().hsecssf();
    pac::RCC.cicr().write(|w| w.set_hsecssc(true));
    has_failed
}

/// A debugger that halts the core stops the sample timer, but not the mute timer, which so runs out (RM0433, DBGMCU).
/// These registers keep what a debugger has written through a reset, so both bits are written.
pub(crate) fn set_debug_freezes() {
    pac::DBGMCU.apb2fzr1().modify(|w| {
        w.set_tim8(true);
        w.set_tim1(false);
    });
}

/// RCC_RSR (RM0433 8.4.4): a power-on sets PORRSTF, BORRSTF and PINRSTF; a brown-out sets the last two; every other
/// reset sets PINRSTF besides its own flag. Clears the flags.
pub(crate) fn take_reset_flags() -> ResetFlags {
    let flags = pac::RCC.rsr().read();
    pac::RCC.rsr().modify(|w| w.set_rmvf(true));
    ResetFlags {
        watchdog: flags.iwdg1rstf() || flags.wwdg1rstf(),
        software: flags.sftrstf(),
        power_on: flags.porrstf(),
        brown_out: flags.borrstf(),
        pin: flags.pinrstf(),
    }
}

/// Level 3 resets below 2.61 V until 2.70 V (DS12110 table 27); chips leave the factory with level 0, off.
pub(crate) const BROWN_OUT_LEVEL: u8 = 3;

/// The chip's device id and its revision (DBGMCU_IDC, RM0433).
pub(crate) fn chip() -> (u16, u16) {
    let identity = pac::DBGMCU.idc().read();
    (identity.dev_id(), identity.rev_id())
}

/// RAMECC1's monitors of the AXI SRAM and of the DTCM's two halves (RM0433, RAM ECC monitoring): configuration at 0x20 times the
/// number, status behind it. The peripheral access crate lacks them, and has a RAMECC at the same address of the H7A3. Checked in public
/// headers of the H743: CR.ECCELEN is 0x20; SR.SEDCF, DEDF and DEBWDF are 1, 2 and 4. ST's HAL clears them as here
/// (`__HAL_RAMECC_CLEAR_FLAG`), and its example `RAMECC_ErrorCount` enables no clock for them.
fn ram_monitors() -> impl Iterator<Item = (Reg<u32, RW>, Reg<u32, RW>)> {
    const RAMECC1: usize = 0x5200_9000;
    [1, 3, 4].into_iter().map(|number| {
        let at = RAMECC1 + 0x20 * number;
        // SAFETY: two registers of a peripheral that nothing else uses; they may be read and written at any time.
        unsafe { (Reg::from_ptr(at as *mut u32), Reg::from_ptr((at + 4) as *mut u32)) }
    })
}

/// RAMECC_MxCR.ECCELEN: errors are latched from now on. SEDCF, DEDF and DEBWDF are cleared by writing 0.
pub(crate) fn watch_ram() {
    for (configuration, status) in ram_monitors() {
        configuration.write_value(1 << 5);
        status.write_value(0);
    }
}

/// SEDCF, DEDF and DEBWDF of these monitors since then.
pub(crate) fn ram_errors() -> Option<u8> {
    Some(ram_monitors().fold(0, |found, (_, status)| found | (status.read() & 0b111) as u8))
}

/// The buffered DAC is linear from 0.2 V to VDDA - 0.2 V (DS12110, DAC characteristics): 1.45 V of the half swing of 1.65 V.
pub(crate) const LINEAR_PER_MILLE: u16 = 880;

/// The internal reference VREFINT is channel 19 of ADC3 (RM0433, ADC connectivity), which serves no input.
pub(crate) const REFERENCE_ADC: Adc = pac::ADC3;
pub(crate) const REFERENCE_CHANNEL: u8 = 19;
/// VREFINT_CAL, of 16 bits as the ADC's codes after a reset, and the VREF+ at which the factory measured it, in mV (DS12110,
/// internal reference voltage calibration values).
pub(crate) const REFERENCE_CALIBRATION: (usize, u32) = (0x1ff1_e860, 3300);

/// ADC3's clock, and the reference connected. 48 MHz / 4 are 12 MHz in revision Y, 6 MHz after the fixed 2 of later ones: neither
/// needs BOOST.
pub(crate) fn start_reference() {
    rcc::enable_and_reset::<peripherals::ADC3>();
    pac::ADC3_COMMON.ccr().write(|w| {
        w.set_ckmode(Ckmode::ASYNCHRONOUS);
        w.set_presc(Presc::DIV4);
        w.set_vrefen(true);
    });
}

/// 387.5 cycles are 32 us or more, of which the reference wants 4.3 (DS12110). The calibration of the conversion's steps would take
/// 14 ms; it is left out, since one part in a hundred is enough here.
pub(crate) fn tune_reference(adc: Adc, channel: u8) {
    adc.pcsel().write(|w| w.set_pcsel(channel.into(), Pcsel::PRESELECTED));
    adc.smpr(1).write(|w| w.set_smp(usize::from(channel) - 10, SampleTime::CYCLES387_5));
}

/// ADC3 is off again: a reset leaves it in deep power-down.
pub(crate) fn end_reference() {
    rcc::enable_and_reset::<peripherals::ADC3>();
    rcc::disable::<peripherals::ADC3>();
}

/// PWR_CR1.PLS = 110: the supply detector trips at 2.76 V (DS12110 table 27).
pub(crate) fn start_supply_detector() {
    pac::PWR.cr1().modify(|w| {
        w.set_pls(0b110);
        w.set_pvde(true);
    });
    // PVDL (bit 2) and CM7L (bit 6) connect the detector and the core's lock-up with the break of TIM1, 8, 15, 16 and 17, and
    // keep that, PVDE and PLS until the next reset (RM0433, SYSCFG_CFGR; the break's internal sources: 38.3.16).
    pac::RCC.apb4enr().modify(|w| w.set_syscfgen(true));
    // SAFETY: the peripheral access crate lacks this register of SYSCFG, at 0x18; nothing else uses it.
    let cfgr = unsafe { Reg::<u32, RW>::from_ptr(pac::SYSCFG.as_ptr().byte_add(0x18).cast()) };
    cfgr.modify(|w| *w |= 1 << 6 | 1 << 2);
}
