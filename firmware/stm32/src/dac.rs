//! Blocks of codes onto the DAC: a timer, a circular DMA stream and one interrupt.
//!
//! ```text
//! sample timer --TRGO--> DAC1 channel 1: DOR <- DHR, pin moves; then it asks the DMA for the next code
//!                                                 ^
//! ring of two blocks --DMA, circular, 32 bit--> DHR12R1
//!        ^                 | half / whole ring played: interrupt
//!  DacStream::write_block  +--> on_dma: the half left is filled with a line (see `ring`), the renderer is woken
//! ```
//! The timer alone sets the pace: one code every [`board::TIMER_PERIOD`] ticks of [`board::TIMER_HZ`], with no jitter
//! from software. Latency: a block is rendered when a half becomes free, and sounds one block later (128 codes = 320 us
//! at 400 kS/s).
//!
//! A missed deadline shows in two ways. Both are reported as [`Underrun`], the late block is not played, and the output
//! goes to mid-scale in one line:
//! * the renderer is late: the DMA enters, or is about to enter, a half that was not written. It then plays the line that
//!   the interrupt put there; see `ring`.
//! * the DMA is late: the DAC's next trigger comes before the DMA has answered the last request. The DAC sets DMAUDR,
//!   raises its interrupt (DMAUDRIE), holds its last code and asks no more (RM0440 Rev 9, 22.4.8, and the DAC's
//!   chapters in RM0090 and RM0433). Recovery as those chapters say: clear the flag, clear DMAEN, set up DMA and DAC
//!   again; here with a ring that goes from the held code to mid-scale.
//!
//! The F407's DAC differs (ES0182, "DMA underrun flag management" and "DMA request not automatically cleared by DMAEN=0"): an
//! underrun stops no transfer, and a request that stands when DMAEN is cleared is served when the stream is started again, at
//! once or when the DMA comes to it. Served before the first trigger, it brings the DMA one code ahead of the sample timer, and
//! so of the block timer and the inputs. That shows at the end of the first half (`is_ahead`); no request stands any more then,
//! and the next start is in step.
//!
//! If the DMA's own interrupt is late by a block or more, the DMA plays a block again before anyone can know. What bounds
//! that is the mute pin's timer (`mute`).
//!
//! embassy-stm32 0.6 has no ring-buffered DAC, and its `WritableRingBuffer` begins with a write index one past its end
//! and serves one flag per interrupt, so the stream is driven through the PAC. All code that touches the sample timer,
//! DAC1 or its DMA stream is in this file, in `dma`, and in the board's `tune_dac`; `sense` reads the timer's count.

use core::cell::UnsafeCell;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, Ordering};
use core::task::Poll;

use embassy_stm32::gpio::Flex;
use embassy_stm32::pac;
use embassy_stm32::{Peri, interrupt, peripherals, rcc};
use embassy_sync::waitqueue::AtomicWaker;
use slipline_app::BLOCK;
use slipline_app::dds::bank::code::MID_SCALE;
use slipline_app::ports::{DacStream, Underrun};

use crate::board::{self, DAC_WAY as STREAM, SAMPLE_TIMER};
use crate::ring::{Halves, Ring};
use crate::{sense, trigger};

/// The codes the DMA reads: two blocks, one word each (the DAC's registers are accessed by words only).
struct Codes(UnsafeCell<[u32; 2 * BLOCK]>);

// SAFETY: the DMA only reads it. A half is written by the DMA's interrupt at the moment the DMA leaves it, and by the
// renderer while it is free (`Halves::offer`); the interrupt that could touch the same half comes one block later.
unsafe impl Sync for Codes {}

impl Codes {
    fn address(&self) -> u32 {
        self.0.get() as u32
    }
}

impl Ring for Codes {
    fn write(&self, half: usize, codes: impl Iterator<Item = u16>) {
        let first = self.0.get().cast::<u32>().wrapping_add((half & 1) * BLOCK);
        // Not a `for` loop: a chain of two iterators takes half the cycles this way.
        codes.take(BLOCK).enumerate().for_each(|(n, code)| {
            // SAFETY: `first` is the start of a half of BLOCK words and `n` is below BLOCK. Volatile, because the
            // compiler does not know that the DMA reads it.
            unsafe { first.add(n).write_volatile(u32::from(code)) };
        });
    }

    fn write_block(&self, half: usize, codes: &[u16; BLOCK]) {
        let mut word = self.0.get().cast::<u32>().wrapping_add((half & 1) * BLOCK);
        // Reads in a row take fewer cycles than reads between writes.
        for &[a, b, c, d] in codes.as_chunks().0 {
            for code in [a, b, c, d] {
                // SAFETY: as above, one after the other.
                unsafe { word.write_volatile(u32::from(code)) };
                word = word.wrapping_add(1);
            }
        }
    }

    fn last(&self, half: usize) -> u16 {
        let word = self.0.get().cast::<u32>().wrapping_add((half & 1) * BLOCK + BLOCK - 1);
        // SAFETY: the last word of a half of the ring.
        (unsafe { word.read_volatile() } & 0xfff) as u16
    }

    fn left(&self) -> usize {
        usize::from(STREAM.left())
    }
}

// On the H743 the DMA cannot reach the RAM that holds the other variables; memory/h743zi.x places this section.
// Nothing initialises it: `Dac::start` writes every word before the DMA is enabled.
#[unsafe(link_section = ".uninit.dma")]
static RING: Codes = Codes(UnsafeCell::new([0; 2 * BLOCK]));
static HALVES: Halves = Halves::full();
static WAKER: AtomicWaker = AtomicWaker::new();
/// The DAC or its DMA has stopped by itself and must be set up again.
static STARVED: AtomicBool = AtomicBool::new(false);

/// The output's pin on port A: channel 1's on all three chips.
pub(crate) const PIN: usize = 4;

/// The running DAC.
pub(crate) struct Dac {
    _dac: Peri<'static, peripherals::DAC1>,
    _timer: Peri<'static, board::SampleTimer>,
    _stream: Peri<'static, board::DacDma>,
    _pin: Flex<'static>,
}

impl Dac {
    /// Brings the pin to mid-scale, then starts the timer and the DMA with a ring of mid-scale.
    ///
    /// The amplifier must be muted: the pin moves from floating to half the supply.
    pub(crate) fn start(
        dac: Peri<'static, peripherals::DAC1>,
        timer: Peri<'static, board::SampleTimer>,
        stream: Peri<'static, board::DacDma>,
        pin: Peri<'static, peripherals::PA4>,
    ) -> Self {
        // The board's file derives the clock tree by hand: an error there would make every frequency wrong.
        assert!(
            board::RAISED * rcc::frequency::<board::SampleTimer>().0 == board::TIMER_HZ,
            "the sample timer does not run at the board's rate"
        );

        // PA4 is channel 1's output on all three chips. Analogue mode before the channel is enabled, or the digital
        // input draws current at half the supply (RM0090 chapter 14).
        let mut pin = Flex::new(pin);
        pin.set_as_analog();

        rcc::enable_and_reset::<peripherals::DAC1>();
        rcc::enable_and_reset::<board::SampleTimer>();
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

        // Prescaler 1, counts 0..=PERIOD-1, its update event is TRGO (MMS = 010). ARR is not buffered: it is set before
        // the counter starts and never again.
        SAMPLE_TIMER.psc().write_value(0);
        SAMPLE_TIMER.arr().write(|w| w.set_arr(board::TIMER_PERIOD - 1));
        SAMPLE_TIMER.cr2().modify(|w| w.set_mms(pac::timer::vals::Mms::UPDATE));

        let started = Self { _dac: dac, _timer: timer, _stream: stream, _pin: pin };
        run(MID_SCALE);
        started
    }
}

/// Fills the ring with the line from `held`, the code of the pin, and enables the stream, the trigger and the timer, in
/// this order: at the first trigger the DMA is ready.
fn run(held: u16) {
    HALVES.refill(&RING, held);
    trigger::restart();
    sense::begin();
    STREAM.start(RING.address(), pac::DAC1.dhr12r(0).as_ptr() as u32, 2 * BLOCK as u16);
    pac::DAC1.cr().modify(|w| {
        w.set_ten(0, true);
        w.set_dmaen(0, true);
        w.set_dmaudrie(0, true);
    });
    SAMPLE_TIMER.cr1().modify(|w| w.set_cen(true));
}

/// Sets everything up again after the DAC or the DMA has stopped.
fn restart() {
    SAMPLE_TIMER.cr1().modify(|w| w.set_cen(false));
    // The channel itself stays on: the pin keeps its voltage. Before the stream, which may serve a request that stands.
    pac::DAC1.cr().modify(|w| {
        w.set_dmaudrie(0, false);
        w.set_dmaen(0, false);
    });
    STREAM.stop();
    pac::DAC1.sr().write(|w| w.set_dmaudr(0, true));
    let held = pac::DAC1.dor(0).read().dor();
    STARVED.store(false, Ordering::Relaxed);
    run(held);
}

impl DacStream for Dac {
    async fn room(&mut self) {
        wait().await;
    }

    async fn write_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun> {
        loop {
            if STARVED.load(Ordering::Relaxed) {
                // The DMA may still be blocked: until it has played a half, this is one event.
                while STARVED.load(Ordering::Relaxed) {
                    restart();
                    wait().await;
                }
                sense::skip();
                return Err(Underrun);
            }
            match HALVES.offer(&RING, codes) {
                Ok(false) => wait().await,
                taken => {
                    sense::expect(HALVES.taken());
                    return taken.map(|_| ()).map_err(|_| Underrun);
                }
            }
        }
    }

    fn is_revisable(&self) -> bool {
        !STARVED.load(Ordering::Relaxed) && HALVES.is_revisable(&RING)
    }

    fn revise_block(&mut self, codes: &[u16; BLOCK]) -> Result<(), Underrun> {
        HALVES.revise(&RING, codes).map_err(|_| Underrun)
    }
}

/// Waits until a half is free or the DAC has stopped.
async fn wait() {
    let is_over = || !HALVES.is_full() || STARVED.load(Ordering::Relaxed);
    poll_fn(|context| {
        // To register takes time, and every other turn comes when the wait is over.
        if is_over() {
            return Poll::Ready(());
        }
        WAKER.register(context.waker());
        // Once more, for it may have been woken between the two.
        if is_over() { Poll::Ready(()) } else { Poll::Pending }
    })
    .await;
}

/// The DMA's interrupt: a half has been played, or the stream has failed.
// Apart from its vector, so that the memory map can put it into RAM.
#[inline(never)]
pub(crate) fn on_dma() {
    let flags = STREAM.take_flags();
    // Before the renderer is woken, which may set it for the block that it writes.
    trigger::on_block();
    if flags.failed || is_ahead() {
        STARVED.store(true, Ordering::Relaxed);
    }
    if flags.half && flags.whole {
        // This interrupt was delayed for a block or longer. The DMA's own counter shows which half it reads.
        HALVES.resynchronise(&RING);
        sense::lose_step();
    } else if flags.half || flags.whole {
        HALVES.finish(&RING);
    }
    WAKER.wake();
}

/// Whether the DMA has fetched the last code of a block, and nothing after it, before the sample timer's trigger for that. In
/// the DMA's interrupt, where the block timer has counted the trigger that made the DMA fetch the code.
fn is_ahead() -> bool {
    trigger::awaits_last_code() && usize::from(STREAM.left()).is_multiple_of(BLOCK)
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

/// Holds the DAC's code while `work` keeps the processor busy: without triggers there are no deadlines. The sample
/// index stands still meanwhile.
pub(crate) fn paused<R>(work: impl FnOnce() -> R) -> R {
    SAMPLE_TIMER.cr1().modify(|w| w.set_cen(false));
    let result = work();
    SAMPLE_TIMER.cr1().modify(|w| w.set_cen(true));
    result
}

/// Stops the DMA for a millisecond, as a blocked bus does, with nobody to notice meanwhile: the DAC holds its code. Afterwards the
/// device behaves as after any DMA that does not deliver.
pub(crate) fn stall() {
    cortex_m::interrupt::free(|_| {
        STREAM.stop();
        cortex_m::asm::delay(board::CORE_HZ / 1000);
    });
}

/// Codes that the DMA has fetched since [`run`] began, modulo 2^32: as many as the sample timer has triggered, once the DMA has
/// answered the last trigger.
pub(crate) fn fetched() -> u32 {
    HALVES.fetched(&RING)
}

/// Sets the DAC to mid-scale at once and until the reset, from any state of the program: for the fault handlers.
pub(crate) fn silence() {
    SAMPLE_TIMER.cr1().modify(|w| w.set_cen(false));
    // Without a trigger, a value reaches the pin one APB cycle after it is written.
    pac::DAC1.cr().modify(|w| {
        w.set_ten(0, false);
        w.set_dmaen(0, false);
    });
    pac::DAC1.dhr12r(0).write(|w| w.set_dhr(MID_SCALE));
}
