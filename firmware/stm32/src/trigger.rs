//! The trigger output: a pin that rises when a program begins, by hardware alone. And the trigger input: a pin whose rise
//! begins a program.
//!
//! ```text
//! sample timer's update --TRGO--> DAC: next code
//!                       `-TRGO--> block timer: counts 0 ..= BLOCK - 1, one for each code that the DMA fetches
//!                                   pin = count < compare value: PULSE or 0, taken over when the count begins at 0
//! ```
//! The block timer has no clock but the sample timer's updates, so it keeps in step with the DMA's ring for ever: it is 0
//! whenever the DMA has fetched a block's last code. The renderer writes PULSE for the block that it has just put into the
//! ring; the timer takes it over at that block's start, whenever the write was. When the DMA has left a block, its
//! interrupt writes 0 for the block after. So the time of a write never shows at the pin.
//!
//! Delay: the DMA fetches a block's first code with the update after the one that raises the pin, and the DAC passes it on
//! with the next. So the pin rises two samples, 5 us, before the DAC's pin begins the program, always.
//!
//! A block that is late is not played and has no edge. If the DMA's interrupt is lost, an edge may come again with
//! each block, as the codes do; the amplifier is off then within 5 ms (`mute`).
//!
//! The input is another channel of the block timer, as an input capture: a rise sets the channel's flag, which stays until the
//! renderer looks at it, before each block while a program waits. The captured count is not used, and reading it would
//! clear the flag. A rise that comes before the look is for the block that is rendered then, and the DMA fetches that one
//! block later; so the program's first code is at the DAC's pin between one and two blocks after the rise. The output's
//! edge marks it to the sample.
//!
//! Facts of the timer, the same in RM0090 18.3 and 18.4, RM0433 39.3 and 39.4, and RM0440's chapter on TIM2 to TIM5:
//! * SMS = 111 (external clock mode 1): rising edges of the chosen trigger clock the counter. On the F407 the sample timer
//!   has twice the block timer's clock. The manual's only condition for two such timers is that the slave's clock is on
//!   (RM0090 18.3.15); `firmware/BOARDS.md` asks for a look at it on the first board.
//! * OCxPE = 1: a compare value is taken over at the update event, which comes with the count's step to 0.
//! * CCxS = 01 with CCxE = 1: a rise of TIx (CCxP = CCxNP = 0) sets CCxIF, in the slave modes, too. Writing 0 to the flag
//!   clears it, writing 1 to others leaves them.
//! * ICxF = 1111: a level counts after 8 equal samples at fDTS/32, with CKD = 00 256 periods of the timer's clock: 3.1 us on
//!   the F407 (84 MHz), 1.5 us on the G474 (170 MHz), 1.3 us on the H743 (200 MHz).
//! * PWM mode 1: the output is high while the count is below the compare value; with 0 never.

use embassy_stm32::gpio::{AfType, Flex, OutputType, Pull, Speed};
use embassy_stm32::pac::timer::vals::{CcmrInputCcs, FilterValue, Sms};
use embassy_stm32::{Peri, rcc};
use slipline_app::BLOCK;
use slipline_app::ports::Trigger;

use crate::board::{
    self, TRIGGER_CHANNEL as CHANNEL, TRIGGER_INPUT_CHANNEL as INPUT, TRIGGER_TIMER as TIMER,
};

/// Width of the pulse in samples: half a block, so that a program that begins a block later has an edge, too.
const PULSE: u16 = BLOCK as u16 / 2;

/// An output compare mode.
const PWM_MODE_1: u8 = 0b110;

/// The trigger output and input.
pub(crate) struct TriggerPins;

impl TriggerPins {
    /// Gives the pins to the block timer, which keeps the output low. Before the sample timer runs.
    pub(crate) fn start(
        timer: Peri<'static, board::TriggerTimer>,
        mut output: Flex<'static>,
        mut input: Flex<'static>,
    ) -> Self {
        // The timer is this file's from now on.
        let _ = timer;
        rcc::enable_and_reset::<board::TriggerTimer>();
        TIMER.arr().write(|w| w.set_arr(BLOCK as u16 - 1));
        TIMER.ccmr_output(CHANNEL / 2).modify(|w| {
            w.set_ocm(CHANNEL % 2, PWM_MODE_1.into());
            w.set_ocpe(CHANNEL % 2, true);
        });
        // CCxS can be written while the channel is off only.
        TIMER.ccmr_input(INPUT / 2).modify(|w| {
            w.set_ccs(INPUT % 2, CcmrInputCcs::TI4);
            w.set_icf(INPUT % 2, FilterValue::FDTS_DIV32_N8);
        });
        restart();
        TIMER.ccer().write(|w| {
            w.set_cce(CHANNEL, true);
            w.set_cce(INPUT, true);
        });
        TIMER.smcr().write(|w| {
            w.set_ts(board::TRIGGER_SOURCE);
            w.set_sms(Sms::EXT_CLOCK_MODE);
        });
        TIMER.cr1().write(|w| w.set_cen(true));
        let driven = AfType::output(OutputType::PushPull, Speed::High);
        output.set_as_af_unchecked(board::TRIGGER_FUNCTION, driven);
        // An input that is not connected stays low.
        input.set_as_af_unchecked(board::TRIGGER_FUNCTION, AfType::input(Pull::Down));
        // A `Flex` that is dropped gives its pin up.
        core::mem::forget((output, input));
        Self
    }
}

impl Trigger for TriggerPins {
    fn rise(&mut self) {
        set(PULSE);
    }

    fn has_risen(&mut self) -> bool {
        let has_risen = TIMER.sr().read().ccif(INPUT);
        if has_risen {
            TIMER.sr().write(|w| {
                w.0 = u32::MAX;
                w.set_ccif(INPUT, false);
            });
        }
        has_risen
    }
}

/// The compare value for the next block.
fn set(samples: u16) {
    TIMER.ccr(CHANNEL).write(|w| w.set_ccr(samples));
}

/// The DMA has left a block: the one that it reads now keeps its pulse, the one after it has none yet.
pub(crate) fn on_block() {
    set(0);
}

/// Whether the trigger for a block's last code is still to come. In step with the DMA that is never so when it has just
/// fetched this code.
pub(crate) fn awaits_last_code() -> bool {
    usize::from(TIMER.cnt().read().cnt()) == BLOCK - 1
}

/// The ring restarts, and so does the count; the pin is low. While the sample timer stands still.
pub(crate) fn restart() {
    set(0);
    // An update event: the count is 0, and the compare value is taken over.
    TIMER.egr().write(|w| w.set_ug(true));
}
