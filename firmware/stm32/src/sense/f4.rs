//! The F4's ADCs, in dual regular simultaneous mode: RM0090 chapter 13, and DS8626 tables 67 and 68.
//!
//! * The clock is APB2's, divided by 6: 84 / 6 = 14 MHz, of 36 MHz at most. A sample lasts 35 cycles of it exactly, so the
//!   trigger finds its divider always in the same place: the delay has no jitter. (84 / 4 = 21 MHz would have 52.5.)
//! * 15 cycles of sampling and 12 of conversion, after 2 of latency: 29 cycles, 2.07 us of 2.5 us.
//! * 15 cycles charge the 4 pF through up to 20 kOhm to a quarter of a code (DS8626, equation 1).
//! * Only the master has the trigger; the slave starts with it (13.9). DMA mode 2: both codes come as one word, ADC2's in the
//!   upper half, by ADC1's request. DDS = 1: requests go on when the DMA begins its ring again.
//! * A word that the DMA does not take before the next is ready sets OVR, and no request follows until OVR is cleared
//!   (13.8.1); ADC_CSR shows the flags of all.

use embassy_stm32::pac::adc::Adc;
use embassy_stm32::pac::adc::vals::{Exten, SampleTime};
use embassy_stm32::pac::adccommon::vals::{Adcpre, Dds, Dma, Multi};
use embassy_stm32::pac::{ADC1, ADC2, ADC123_COMMON};
use embassy_stm32::{peripherals, rcc};

use crate::board::{self, SENSE_CHANNELS, SENSE_TRIGGER};

const CLOCK_HZ: i64 = 14_000_000;
/// From the trigger to the end of sampling: the latency of DS8626 table 67, and the sampling time. The latency may be up to
/// one cycle less, 71 ns, depending on where the trigger finds the divider.
const HOLD_CYCLES: i64 = 2 + 15;
/// The DAC's output register changes three cycles of APB1 after the trigger (RM0090 14.3.4).
const DAC_CYCLES: i64 = 3;
const APB1_HZ: i64 = 42_000_000;
/// Rounded to the nearest nanosecond.
pub(super) const DELAY_NS: i32 = {
    let hold_ps = HOLD_CYCLES * 1_000_000_000_000 / CLOCK_HZ;
    let dac_ps = DAC_CYCLES * 1_000_000_000_000 / APB1_HZ;
    ((hold_ps - dac_ps + 500) / 1000) as i32
};

/// The register from which the DMA takes both codes.
pub(super) fn data() -> u32 {
    ADC123_COMMON.cdr().as_ptr() as u32
}

/// Switches both ADCs on, without a trigger.
pub(super) fn set_up() {
    assert!(
        i64::from(rcc::frequency::<peripherals::ADC1>().0) == 6 * CLOCK_HZ,
        "the ADCs do not run at the board's rate"
    );
    // Only the chip's reset has reset them.
    rcc::enable_and_reset::<peripherals::ADC1>();
    rcc::enable_and_reset::<peripherals::ADC2>();
    ADC123_COMMON.ccr().write(|w| {
        w.set_adcpre(Adcpre::DIV6);
        w.set_multi(Multi::DUAL_R);
        w.set_dds(Dds::CONTINUOUS);
    });
    for (adc, channel) in [(ADC1, SENSE_CHANNELS[0]), (ADC2, SENSE_CHANNELS[1])] {
        set_up_one(adc, channel);
    }
    ADC1.cr2().modify(|w| w.set_extsel(SENSE_TRIGGER));
    // tSTAB: at most 3 us (DS8626 table 67).
    cortex_m::asm::delay(board::CORE_HZ / 300_000);
}

/// The channel of the internal reference VREFINT, of ADC1 alone (RM0090 13.10).
const REFERENCE_CHANNEL: u8 = 17;
/// Looks at the end of its conversion: 492 cycles of 14 MHz, 35 us. A look takes 10 cycles of the core or more.
const LOOKS: u32 = 5000;

/// The code of the chip's internal reference; `None` if the ADC does not answer. Before [`set_up`].
pub(super) fn reference_code() -> Option<u16> {
    rcc::enable_and_reset::<peripherals::ADC1>();
    ADC123_COMMON.ccr().write(|w| {
        w.set_adcpre(Adcpre::DIV6);
        w.set_tsvrefe(true);
    });
    // 34 us, of which the reference wants 10 (DS8626, embedded internal reference voltage).
    ADC1.smpr1().write(|w| w.set_smp(usize::from(REFERENCE_CHANNEL) - 10, SampleTime::CYCLES480));
    ADC1.sqr3().write(|w| w.set_sq(0, REFERENCE_CHANNEL));
    ADC1.cr2().write(|w| w.set_adon(true));
    // The reference is up within 10 us, the ADC (tSTAB) within 3.
    cortex_m::asm::delay(board::CORE_HZ / 50_000);
    ADC1.cr2().modify(|w| w.set_swstart(true));
    let code = (0..LOOKS).find(|_| ADC1.sr().read().eoc()).map(|_| ADC1.dr().read().data());
    // embassy-stm32 0.6 knows no reset of this chip's ADCs: `set_up` writes the other registers as a whole.
    ADC1.cr2().write(|_| {});
    ADC1.smpr1().write(|_| {});
    code
}

/// One conversion of one channel, 12 bits, to the right: what a reset leaves in CR1 and SQR1.
fn set_up_one(adc: Adc, channel: u8) {
    // Channels 0 to 9.
    adc.smpr2().write(|w| w.set_smp(channel.into(), SampleTime::CYCLES15));
    adc.sqr3().write(|w| w.set_sq(0, channel));
    adc.cr2().write(|w| w.set_adon(true));
}

/// No trigger has an effect from now on. A conversion that runs goes on to its end.
pub(super) fn disarm() {
    ADC1.cr2().modify(|w| w.set_exten(Exten::DISABLED));
}

/// Forgets requests and overruns of before. No conversion runs. The flags are cleared by 0.
pub(super) fn clear() {
    ADC123_COMMON.ccr().modify(|w| w.set_dma(Dma::DISABLED));
    for adc in [ADC1, ADC2] {
        adc.sr().write(|_| {});
    }
    ADC123_COMMON.ccr().modify(|w| w.set_dma(Dma::MODE2));
}

/// Converts from the next trigger on.
pub(super) fn arm() {
    ADC1.cr2().modify(|w| w.set_exten(Exten::RISING_EDGE));
}

/// Whether a word was lost: no more come then.
pub(super) fn has_overrun() -> bool {
    let flags = ADC123_COMMON.csr().read();
    flags.ovr(0) || flags.ovr(1)
}
