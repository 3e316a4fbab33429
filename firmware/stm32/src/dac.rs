//! Blocks of codes onto the DAC: a timer, a circular DMA stream and one interrupt.
//!
//! ```text
//! TIM6 update --TRGO--> DAC1 channel 1: DOR <- DHR, pin moves; then it asks the DMA for the next code
//!                                        ^
//! ring of two blocks --DMA, circular, 32 bit--> DHR12R1
//!        ^                 | half / whole ring played: interrupt
//!  DacStream::write_block  +--> on_dma: the half left is filled with a fade (see `ring`), the renderer is woken
//! ```
//! The timer alone sets the pace: one code every [`board::TIMER_PERIOD`] ticks of [`board::TIMER_HZ`], with no jitter
//! from software. Latency: at most one block from `write_block` to the pin (128 codes = 320 us at 400 kS/s).
//!
//! A missed deadline shows in two ways, and both are reported as [`Underrun`]:
//! * the renderer is late: the DMA enters a half that was not written. It then plays the fade that the interrupt put
//!   there and mid-scale after it; `ring` counts it.
//! * the DMA is late: the DAC's next trigger comes before the DMA has answered the last request. The DAC sets DMAUDR,
//!   raises its interrupt (DMAUDRIE), holds its last code and asks no more (RM0440 Rev 9, 22.4.8, and the DAC's
//!   chapters in RM0090 and RM0433). Recovery as those chapters say: clear the flag, clear DMAEN, set up DMA and DAC
//!   anew; here with a ring that fades from the held code to mid-scale.
//!
//! embassy-stm32 0.6 has no ring-buffered DAC, and its `WritableRingBuffer` begins with a write index one past its
//! end and serves one flag an interrupt, so the stream is driven through the PAC. Everything that touches TIM6, DAC1 or
//! its DMA stream is in this file, in `stream`, one file for each kind of DMA (`dac/streams.rs`, `dac/channels.rs`), and in
//! the board's `tune_dac`.

#[cfg_attr(feature = "dma-channels", path = "dac/channels.rs")]
#[cfg_attr(feature = "dma-streams", path = "dac/streams.rs")]
mod stream;

use core::cell::UnsafeCell;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, Ordering};
use core::task::Poll;

use embassy_stm32::gpio::Flex;
use embassy_stm32::pac;
use embassy_stm32::{Peri, interrupt, peripherals, rcc};
use embassy_sync::waitqueue::AtomicWaker;
use slipline_app::bank::BLOCK;
use slipline_app::ports::{DacStream, Underrun};

use crate::board;
use crate::ring::{Halves, MID_SCALE, ramp};

/// The codes the DMA reads: two blocks, one word each (the DAC's registers are accessed by words only).
struct Ring(UnsafeCell<[u32; 2 * BLOCK]>);

// SAFETY: the DMA only reads it. A half is written by the DMA's interrupt at the moment the DMA leaves it, and by the
// renderer between `claim` and `commit`; the interrupt that could touch the same half comes one block later, and
// `commit` then discards what was written.
unsafe impl Sync for Ring {}

impl Ring {
    /// Writes one half, code by code.
    fn write(&self, half: usize, codes: impl Iterator<Item = u16>) {
        let first = self.0.get().cast::<u32>().wrapping_add((half & 1) * BLOCK);
        for (n, code) in codes.take(BLOCK).enumerate() {
            // SAFETY: `first` is the start of a half of BLOCK words and `n` is below BLOCK. Volatile, because the DMA
            // reads it behind the compiler's back.
            unsafe { first.add(n).write_volatile(u32::from(code)) };
        }
    }

    /// The last code of a half.
    fn last(&self, half: usize) -> u16 {
        let word = self.0.get().cast::<u32>().wrapping_add((half & 1) * BLOCK + BLOCK - 1);
        // SAFETY: the last word of a half of the ring.
        (unsafe { word.read_volatile() } & 0xfff) as u16
    }

    fn address(&self) -> u32 {
        self.0.get() as u32
    }
}

// On the H743 the DMA cannot reach the RAM that holds the other variables; memory/h743zi.x places this section.
// Nothing initialises it: `Dac::start` writes every word before the DMA is enabled.
#[unsafe(link_section = ".uninit.dma")]
static RING: Ring = Ring(UnsafeCell::new([0; 2 * BLOCK]));
static HALVES: Halves = Halves::full();
static WAKER: AtomicWaker = AtomicWaker::new();
/// The DAC or its DMA has stopped by itself and must be set up anew.
static STARVED: AtomicBool = AtomicBool::new(false);

/// The running DAC.
pub(crate) struct Dac {
    _dac: Peri<'static, peripherals::DAC1>,
    _timer: Peri<'static, peripherals::TIM6>,
    _stream: Peri<'static, board::DacDma>,
    _pin: Flex<'static>,
}

impl Dac {
    /// Brings the pin to mid-scale, then starts the timer and the DMA with a ring of mid-scale.
    ///
    /// The amplifier must be muted: the pin moves from floating to half the supply.
    pub(crate) fn start(
        dac: Peri<'static, peripherals::DAC1>,
        timer: Peri<'static, peripherals::TIM6>,
        stream: Peri<'static, board::DacDma>,
        pin: Peri<'static, peripherals::PA4>,
    ) -> Self {
        // The clock tree as the board's file derives it; a slip there would be a wrong pitch everywhere.
        assert!(
            rcc::frequency::<peripherals::TIM6>().0 == board::TIMER_HZ,
            "TIM6 does not run at the board's rate"
        );

        // PA4 is channel 1's output on all three chips. Analogue mode before the channel is enabled, or the digital
        // input draws current at half the supply (RM0090 chapter 14).
        let mut pin = Flex::new(pin);
        pin.set_as_analog();

        rcc::enable_and_reset::<peripherals::DAC1>();
        rcc::enable_and_reset::<peripherals::TIM6>();
        let regs = pac::DAC1;
        // DAC_MCR.MODE1, where there is one, stays 000: external pin, buffer on.
        board::tune_dac();
        // Without trigger (TEN = 0) a value in DHR is taken over one APB cycle later, so the first voltage the
        // channel ever drives is mid-scale (it is loaded before EN).
        regs.dhr12r(0).write(|w| w.set_dhr(MID_SCALE));
        // TSEL1 cannot be changed while EN1 is set (RM0440 22.4.7), and `restart` leaves both as they are.
        regs.cr().modify(|w| w.set_tsel(0, board::DAC_TRIGGER));
        regs.cr().modify(|w| w.set_en(0, true));
        // tWAKEUP: at most 10 us on the F407 with the buffer on (7.5 us on the others); 20 us at the core's clock.
        cortex_m::asm::delay(board::CORE_HZ / 50_000);

        // TIM6: prescaler 1, counts 0..=PERIOD-1, its update event is TRGO (MMS = 010). ARR is not buffered: it is
        // set before the counter starts and never again.
        let timer_regs = pac::TIM6;
        timer_regs.psc().write_value(0);
        timer_regs.arr().write(|w| w.set_arr(board::TIMER_PERIOD - 1));
        timer_regs.cr2().modify(|w| w.set_mms(pac::timer::vals::Mms::UPDATE));

        RING.write(0, core::iter::repeat(MID_SCALE));
        RING.write(1, core::iter::repeat(MID_SCALE));
        let started = Self { _dac: dac, _timer: timer, _stream: stream, _pin: pin };
        run();
        started
    }
}

/// A block that goes from a code to mid-scale.
fn fade(from: u16) -> impl Iterator<Item = u16> {
    ramp::<{ BLOCK as u16 }>(from)
}

/// Enables the stream, the trigger and the timer, in this order: the first trigger finds a DMA that answers.
fn run() {
    HALVES.refill();
    stream::start(RING.address(), pac::DAC1.dhr12r(0).as_ptr() as u32, 2 * BLOCK as u16);
    pac::DAC1.cr().modify(|w| {
        w.set_ten(0, true);
        w.set_dmaen(0, true);
        w.set_dmaudrie(0, true);
    });
    pac::TIM6.cr1().modify(|w| w.set_cen(true));
}

/// Sets everything up anew after the DAC or the DMA has stopped: fades from the code the pin holds to mid-scale.
fn restart() {
    pac::TIM6.cr1().modify(|w| w.set_cen(false));
    stream::stop();
    // The channel itself stays on: the pin keeps its voltage.
    pac::DAC1.cr().modify(|w| {
        w.set_dmaudrie(0, false);
        w.set_dmaen(0, false);
    });
    pac::DAC1.sr().write(|w| w.set_dmaudr(0, true));
    let held = pac::DAC1.dor(0).read().dor();
    RING.write(0, fade(held));
    RING.write(1, core::iter::repeat(MID_SCALE));
    STARVED.store(false, Ordering::Relaxed);
    run();
}

impl DacStream for Dac {
    async fn write_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun> {
        let mut late = false;
        loop {
            if STARVED.load(Ordering::Relaxed) {
                late = true;
                restart();
            }
            match HALVES.claim() {
                Ok(Some(half)) => {
                    RING.write(half, codes.iter().copied());
                    match HALVES.commit() {
                        Ok(()) if late => return Err(Underrun),
                        Ok(()) => return Ok(()),
                        Err(_) => late = true,
                    }
                }
                Ok(None) => wait().await,
                Err(_) => late = true,
            }
        }
    }
}

/// Until a half is free or the DAC has stopped.
async fn wait() {
    poll_fn(|context| {
        WAKER.register(context.waker());
        let waits = HALVES.is_full() && !STARVED.load(Ordering::Relaxed);
        if waits { Poll::Pending } else { Poll::Ready(()) }
    })
    .await;
}

/// The DMA's interrupt: a half has been played, or the stream has failed.
pub(crate) fn on_dma() {
    let flags = stream::take_flags();
    if flags.failed {
        STARVED.store(true, Ordering::Relaxed);
    }
    if flags.half && flags.whole {
        // This interrupt was kept away for a block or longer. The DMA itself tells where it is.
        HALVES.resynchronise(playing());
        let playing = playing();
        RING.write(1 - playing, fade(RING.last(playing)));
    } else if flags.half || flags.whole {
        let left = HALVES.finish();
        RING.write(left, fade(RING.last(1 - left)));
    }
    WAKER.wake();
}

/// The DAC's interrupt: a trigger came before the DMA had delivered.
#[interrupt]
fn TIM6_DAC() {
    if pac::DAC1.sr().read().dmaudr(0) {
        // The flag itself is cleared by `restart`, after the DMA has been stopped; until then the interrupt would come
        // again and again.
        pac::DAC1.cr().modify(|w| w.set_dmaudrie(0, false));
        STARVED.store(true, Ordering::Relaxed);
        WAKER.wake();
    }
}

/// Holds the DAC where it is while `work` keeps the processor from answering: no triggers, so no deadlines. The sample
/// index stands still with it.
pub(crate) fn paused<R>(work: impl FnOnce() -> R) -> R {
    pac::TIM6.cr1().modify(|w| w.set_cen(false));
    let result = work();
    pac::TIM6.cr1().modify(|w| w.set_cen(true));
    result
}

/// Mid-scale at once and for good, from any state of the program: for the fault handlers.
pub(crate) fn silence() {
    pac::TIM6.cr1().modify(|w| w.set_cen(false));
    // Without trigger the value goes through to the pin one APB cycle later.
    pac::DAC1.cr().modify(|w| {
        w.set_ten(0, false);
        w.set_dmaen(0, false);
    });
    pac::DAC1.dhr12r(0).write(|w| w.set_dhr(MID_SCALE));
}

/// What the stream's interrupt found.
struct Flags {
    half: bool,
    whole: bool,
    failed: bool,
}

/// The half the DMA reads now.
fn playing() -> usize {
    usize::from(usize::from(stream::left()) <= BLOCK)
}
