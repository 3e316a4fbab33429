//! The fast ADCs of G4 and H7, in dual regular simultaneous mode: RM0440 chapter 21, and the ADC chapter of RM0433.
//!
//! * The board's file gives clock and sampling time, and so the delay. A conversion is over before the next trigger, and takes
//!   longer than half of the period.
//! * Only the master has the trigger, and only it is started and stopped: the slave follows. Both codes come as one word, the
//!   slave's in the upper half, by the master's request.
//! * A word that the DMA does not take before the next is ready sets OVR, which stands until 1 is written to it.
//! * Every wait for an ADC has a limit of reads. An ADC that does not answer converts nothing; its blocks are reported as
//!   lost.

use embassy_stm32::pac::adc::Adc;
use embassy_stm32::pac::adc::vals::{Adcaldif, Adstp, Exten};
use embassy_stm32::pac::{ADC1, ADC2, ADC12_COMMON};
use embassy_stm32::{peripherals, rcc};

use crate::board::{self, SENSE_CHANNELS, SENSE_TRIGGER};

pub(super) use crate::board::SENSE_DELAY_NS as DELAY_NS;

/// Looks at the calibration, the longest wait: 14 ms on the H743. A look takes 10 cycles of the core or more, so this is 50 ms
/// at least.
const CALIBRATION_LOOKS: u32 = 2_000_000;
/// Looks at the ready flag and at the end of a conversion, which take some us.
const LOOKS: u32 = 1000;

/// The register from which the DMA takes both codes.
pub(super) fn data() -> u32 {
    ADC12_COMMON.cdr().as_ptr() as u32
}

/// Calibrates both ADCs and switches them on. They convert when [`arm`] has been called.
pub(super) fn set_up() {
    // One clock and one reset for both.
    rcc::enable_and_reset::<peripherals::ADC1>();
    board::tune_adcs();
    for (adc, channel) in [(ADC1, SENSE_CHANNELS[0]), (ADC2, SENSE_CHANNELS[1])] {
        set_up_one(adc, channel);
    }
    ADC1.cfgr().modify(|w| {
        w.set_extsel(SENSE_TRIGGER);
        w.set_exten(Exten::RISING_EDGE);
    });
}

fn set_up_one(adc: Adc, channel: u8) {
    switch_on(adc, channel, board::tune_adc);
}

/// The code of the chip's internal reference; `None` if its ADC does not answer. Before [`set_up`]. The second of two conversions
/// counts: one that comes late after a calibration may be wrong (ES0430 2.7.7).
pub(super) fn reference_code() -> Option<u16> {
    board::start_reference();
    let adc = board::REFERENCE_ADC;
    switch_on(adc, board::REFERENCE_CHANNEL, board::tune_reference);
    let mut code = None;
    for _ in 0..2 {
        adc.cr().modify(|w| w.set_adstart(true));
        // 80 us at most.
        wait(CALIBRATION_LOOKS, || adc.isr().read().eoc());
        code = adc.isr().read().eoc().then(|| adc.dr().read().rdata());
    }
    board::end_reference();
    code
}

/// Calibrates an ADC and switches it on, for one channel, as `tune` sets it up.
fn switch_on(adc: Adc, channel: u8, tune: fn(Adc, u8)) {
    adc.cr().modify(|w| w.set_deeppwd(false));
    adc.cr().modify(|w| w.set_advregen(true));
    // The regulator's start: at most 20 us (DS12288 table 66; 10 us, DS12110).
    cortex_m::asm::delay(board::CORE_HZ / 50_000);
    // One conversion of one channel.
    adc.sqr1().write(|w| w.set_sq(0, channel));
    tune(adc, channel);
    adc.cr().modify(|w| w.set_adcaldif(Adcaldif::SINGLE_ENDED));
    adc.cr().modify(|w| w.set_adcal(true));
    wait(CALIBRATION_LOOKS, || !adc.cr().read().adcal());
    // ADEN waits for four cycles of the ADC after the calibration.
    cortex_m::asm::delay(board::CORE_HZ / 1_000_000);
    adc.isr().write(|w| w.set_adrdy(true));
    adc.cr().modify(|w| w.set_aden(true));
    wait(LOOKS, || adc.isr().read().adrdy());
}

/// No trigger has an effect from now on, and nothing is being converted.
pub(super) fn disarm() {
    if ADC1.cr().read().adstart() {
        ADC1.cr().modify(|w| w.set_adstp(Adstp::STOP));
        wait(LOOKS, || !ADC1.cr().read().adstart());
    }
}

/// Clears earlier requests and overruns. Reading the codes clears a request.
pub(super) fn clear() {
    ADC12_COMMON.cdr().read();
    for adc in [ADC1, ADC2] {
        adc.isr().write(|w| {
            w.set_eoc(true);
            w.set_eos(true);
            w.set_ovr(true);
        });
    }
}

/// Converts from the next trigger on.
pub(super) fn arm() {
    ADC1.cr().modify(|w| w.set_adstart(true));
}

/// Whether a word was lost.
pub(super) fn has_overrun() -> bool {
    let flags = ADC12_COMMON.csr().read();
    flags.ovr_mst() || flags.ovr_slv()
}

/// Waits until `is_done`, for `looks` reads at most.
fn wait(looks: u32, is_done: impl Fn() -> bool) {
    for _ in 0..looks {
        if is_done() {
            break;
        }
    }
}
