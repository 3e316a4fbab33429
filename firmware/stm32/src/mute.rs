//! The amplifier's mute pin: a timer's output that falls by itself when no block has come for 4 ms.
//!
//! ```text
//! counter, 1 MHz: 0 ---------------> 4000: the output goes low and stays low
//!                 ^ each good block: 0 again
//! pin = output, while MOE is set; low while it is not
//! ```
//! No program, interrupt or clock of the core takes part in muting. What it needs is the timer's own clock. If that
//! fails, the clock security system's failure event is a break: it clears MOE in hardware. So do the supply detector and a
//! core that has locked up, on the chips whose SYSCFG connects them (`board::start_supply_detector`).
//!
//! The channel is in the mode "inactive on match": a match takes the output low, and nothing in that mode takes it high.
//! So the one write that a block does, 0 to the counter, cannot switch the amplifier on, whenever it comes. (A one-pulse
//! timer in a PWM mode mutes too, but it is high whenever the counter stands on a pulse's value: a block that came in the
//! moment of the counter's stop would leave it there for good.) The output is made high by "forced active" while MOE is
//! still clear, so that a program that dies between the two modes leaves the pin low.
//!
//! Facts of the timer, the same in RM0090 17.3.8 to 17.3.12 and 17.4, RM0440 28.3 and 28.6, RM0433 38.3 and 38.4:
//! * MOE = 0 with OSSI = 1: the pin is driven to OISx (OISxN for a complementary output), which is 0 after a reset.
//! * CCxNE alone, without CCxE: the complementary output follows the channel's reference, not its complement.
//! * BKE = 1 with BKP = 1 (active high): no pin is mapped to the break input, which reads 0 then, and the clock security
//!   system's failure takes effect, as the other internal sources do. AOE = 0: only the program sets MOE again.
//! * SR.BIF is set as soon as the break input is active, and kept until the program clears it, which it cannot while the input is
//!   active. On the G474 and the H743 the chip's own sources of a break set SBIF instead.
//! * LOCK = 2 keeps all this, and the polarities, until the next reset. Level 3 would keep the mode, too.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use cortex_m::peripheral::DWT;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Pull, Speed};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::pac::timer::vals::{Bkp, Lock, Ossi};
use embassy_stm32::{Peri, rcc};
use slipline_app::ports::{HasMuted, Mute, MuteFall, MuteTrial, PinLevel};

use crate::board::{self, MUTE_CHANNEL as CHANNEL, MUTE_TIMER as TIMER, MutedPin};
use crate::pin_lock;

/// Time from the last good block until the amplifier is off, in us. A block lasts 0.32 ms, so twelve may be missing.
const STAYS_ON_US: u16 = 4000;

/// A trial: no block restarts the timer until the amplifier is muted.
static IS_WITHHELD: AtomicBool = AtomicBool::new(false);
/// How long a trial waits for the pin. A look takes 10 cycles of the core or more: should the cycle counter stand still, the looks end it.
const TRIAL_US: u32 = 20_000;
const LOOKS: u32 = 1_000_000;

/// Output compare modes.
const INACTIVE_ON_MATCH: u8 = 0b010;
const FORCED_INACTIVE: u8 = 0b100;
const FORCED_ACTIVE: u8 = 0b101;

/// The amplifier's mute pin.
pub(crate) struct MutePin {
    is_on: bool,
    /// Off, with the stop input watched.
    on_bench: bool,
    has_resistor: bool,
}

impl MutePin {
    /// Gives the pin, which is an output and low, to the timer, which keeps it low, and locks both.
    ///
    /// Without its resistor the pin stays low: nothing would hold it while the chip is in reset.
    #[allow(clippy::useless_conversion, reason = "these fields are wider on some chips")]
    pub(crate) fn start(timer: Peri<'static, board::MuteTimer>, pin: MutedPin) -> Self {
        let MutedPin { mut pin, has_resistor } = pin;
        // The board's file derives the clock tree by hand.
        assert!(
            board::RAISED * rcc::frequency::<board::MuteTimer>().0 == board::MUTE_TIMER_HZ,
            "the mute timer does not run at the board's rate"
        );
        // The timer is this file's from now on.
        let _ = timer;
        rcc::enable_and_reset::<board::MuteTimer>();
        TIMER.psc().write_value((board::MUTE_TIMER_HZ / 1_000_000 - 1) as u16);
        TIMER.arr().write(|w| w.set_arr(u16::MAX.into()));
        TIMER.ccr(CHANNEL).write(|w| w.set_ccr(STAYS_ON_US.into()));
        // Loads the prescaler.
        TIMER.egr().write(|w| w.set_ug(true));
        set_mode(FORCED_INACTIVE);
        // Before the lock, which keeps it.
        board::admit_break_pin();
        TIMER.bdtr().write(|w| {
            w.set_ossi(Ossi::IDLE_LEVEL);
            w.set_bke(0, true);
            w.set_bkp(0, Bkp::ACTIVE_HIGH);
            w.set_lock(Lock::LEVEL2);
        });
        TIMER.ccer().write(|w| {
            w.set_cce(CHANNEL, !board::MUTE_IS_COMPLEMENTARY);
            w.set_ccne(CHANNEL, board::MUTE_IS_COMPLEMENTARY);
        });
        TIMER.cr1().write(|w| w.set_cen(true));
        pin.set_as_af_unchecked(board::MUTE_FUNCTION, AfType::output(OutputType::PushPull, Speed::Low));
        // A `Flex` that is dropped makes its pin an input again.
        core::mem::forget(pin);
        let (port, number) = board::MUTE_PIN;
        pin_lock::lock(port, number);
        Self { is_on: false, on_bench: false, has_resistor }
    }
}

impl Mute for MutePin {
    fn set_muted(&mut self, muted: bool) {
        let muted = muted || !self.has_resistor;
        match (self.is_on, muted) {
            (true, true) => {
                off();
                IS_WITHHELD.store(false, Relaxed);
            }
            (false, false) => on(),
            _ => {}
        }
        self.is_on = !muted;
        self.on_bench = false;
    }

    fn bench(&mut self) {
        if self.on_bench {
            return;
        }
        self.set_muted(true);
        forget_stop();
        self.on_bench = true;
    }

    fn stay_on(&mut self) -> Result<(), HasMuted> {
        if self.on_bench {
            return if self.was_stopped() { Err(HasMuted) } else { Ok(()) };
        }
        if !self.has_resistor || IS_WITHHELD.load(Relaxed) {
            // Without its resistor it is off for good, and no fault: everything but the amplifier works.
            return Ok(());
        }
        if !is_on() {
            return Err(HasMuted);
        }
        TIMER.cnt().write(|w| w.set_cnt(0));
        Ok(())
    }

    /// The stop input alone breaks the output of a program that goes on: the other sources of a break end it (`crash`), or are the end
    /// of the core.
    fn was_stopped(&mut self) -> bool {
        TIMER.sr().read().bif(0)
    }
}

/// Gives the stop input's pin to the timer, as its break: a contact to ground, and the chip's own resistor to the supply. An open contact
/// or a cut wire is a high level, which clears MOE, and keeps it clear, without a clock or the program.
///
/// The pin is an input of the timer's break as soon as it has the alternate function (DS8626 table 9), on the G474 and the H743 through
/// the gate that `board::admit_break_pin` has opened. Only where the profile says so: an open pin never lets the amplifier on.
pub(crate) fn fit_stop_input(mut pin: Flex<'static>) {
    pin.set_as_af_unchecked(board::STOP_INPUT_FUNCTION, AfType::input(Pull::Up));
    core::mem::forget(pin);
}

/// Whether the stop input's pin is high: open, if it is fitted.
pub(crate) fn is_stop_input_high() -> bool {
    let (port, number) = board::STOP_INPUT_PIN;
    port.idr().read().idr(number) == Idr::HIGH
}

/// The level of the mute pin, whatever drives it: an input register shows the pin in every mode but the analogue one.
pub(crate) fn level() -> PinLevel {
    let (port, number) = board::MUTE_PIN;
    if port.idr().read().idr(number) == Idr::HIGH { PinLevel::High } else { PinLevel::Low }
}

/// Takes the pin, which is high, low in this way, and times it by the cycle counter. Interrupts go on: what they delay shows in
/// `within_us`.
pub(crate) fn attempt(trial: MuteTrial) -> Option<MuteFall> {
    const CYCLES_PER_US: u32 = board::CORE_HZ / 1_000_000;
    IS_WITHHELD.store(true, Relaxed);
    let begun = cortex_m::interrupt::free(|_| {
        let now = DWT::cycle_count();
        if trial == MuteTrial::Break {
            TIMER.egr().write(|w| w.set_bg(0, true));
            return now;
        }
        // It counts microseconds since the last block.
        now.wrapping_sub(u32::from(TIMER.cnt().read().cnt()) * CYCLES_PER_US)
    });
    let us = |since: u32, now: u32| now.wrapping_sub(since) / CYCLES_PER_US;
    let mut last_high = begun;
    for _ in 0..LOOKS {
        let level = level();
        let now = DWT::cycle_count();
        if level == PinLevel::Low {
            return Some(MuteFall { low_after_us: us(begun, now), within_us: us(last_high, now) });
        }
        if us(begun, now) >= TRIAL_US {
            break;
        }
        last_high = now;
    }
    None
}

fn set_mode(mode: u8) {
    TIMER.ccmr_output(CHANNEL / 2).modify(|w| w.set_ocm(CHANNEL % 2, mode.into()));
}

/// Clears the break's flag, which stays set while the stop input is open.
fn forget_stop() {
    TIMER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_bif(0, false);
    });
}

/// Unmutes, for the time of [`STAYS_ON_US`].
fn on() {
    TIMER.cnt().write(|w| w.set_cnt(0));
    // Flags are cleared by writing 0, and kept by writing 1.
    TIMER.sr().write(|w| {
        w.0 = u32::MAX;
        w.set_ccif(CHANNEL, false);
    });
    forget_stop();
    set_mode(FORCED_ACTIVE);
    set_mode(INACTIVE_ON_MATCH);
    TIMER.bdtr().modify(|w| w.set_moe(true));
}

/// Mutes at once, from any state of the program and until the renderer unmutes: one write. All of the register but MOE
/// and the filters is locked.
pub(crate) fn off() {
    TIMER.bdtr().write(|_| {});
}

/// Whether the amplifier is on: the pin has been switched on, and neither has the counter reached its mark since, nor has
/// a break come. One that came while it was being switched on has left its flag only.
pub(crate) fn is_on() -> bool {
    let seen = TIMER.sr().read();
    TIMER.bdtr().read().moe() && !seen.ccif(CHANNEL) && !seen.bif(0)
}
