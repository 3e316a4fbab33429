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
//! its DMA stream is in this file; what differs between the chips is in `stream` below and in the board's constants.

use core::cell::UnsafeCell;
use core::future::poll_fn;
use core::sync::atomic::{AtomicBool, Ordering};
use core::task::Poll;

use embassy_stm32::gpio::Flex;
use embassy_stm32::pac;
use embassy_stm32::{Peri, peripherals, rcc};
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

// On the H743 the DMA cannot reach the RAM that holds the other variables; memory/h743zi.x places this section, and
// nothing initialises it: `Dac::start` writes every word before the DMA is enabled.
#[cfg_attr(feature = "board-nucleo-h743zi2", unsafe(link_section = ".dma"))]
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
        // DAC_MCR.HFSEL: the DAC's clock is the AHB at 170 MHz; above 160 MHz it wants 10 (RM0440 22.7.16). MODE1 stays
        // 000: external pin, buffer on. Both only while the channel is off.
        #[cfg(feature = "board-nucleo-g474re")]
        regs.mcr().modify(|w| w.set_hfsel(0b10));
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
        HALVES.resynchronise(stream::playing());
        let playing = stream::playing();
        RING.write(1 - playing, fade(RING.last(playing)));
    } else if flags.half || flags.whole {
        let left = HALVES.finish();
        RING.write(left, fade(RING.last(1 - left)));
    }
    WAKER.wake();
}

/// The DAC's interrupt: a trigger came before the DMA had delivered.
pub(crate) fn on_underrun() {
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

/// The stream of a chip with the stream DMA (F4, H7): RM0090 chapter 10, RM0433 likewise.
#[cfg(not(feature = "board-nucleo-g474re"))]
mod stream {
    use super::Flags;
    use crate::board::{DMA_STREAM, route_dma};
    use embassy_stm32::pac::DMA1;
    use embassy_stm32::pac::dma::{regs, vals};

    /// Streams 0 to 3 have their flags in LISR, 4 to 7 in HISR; the PAC indexes both.
    const GROUP: usize = DMA_STREAM / 4;
    const FLAG: usize = DMA_STREAM % 4;

    pub(super) fn start(ring: u32, register: u32, words: u16) {
        stop();
        let stream = DMA1.st(DMA_STREAM);
        stream.par().write_value(register);
        stream.m0ar().write_value(ring);
        stream.ndtr().write_value(regs::Ndtr(u32::from(words)));
        // Direct mode (DMDIS = 0): no FIFO, the stream holds one word ready, so a request is answered in a few cycles.
        stream.fcr().write(|w| w.set_dmdis(vals::Dmdis::ENABLED));
        stream.cr().write(|w| {
            w.set_dir(vals::Dir::MEMORY_TO_PERIPHERAL);
            // Both 32 bit; in direct mode the memory's size is forced to the peripheral's anyway.
            w.set_msize(vals::Size::BITS32);
            w.set_psize(vals::Size::BITS32);
            w.set_minc(true);
            w.set_pinc(false);
            w.set_circ(true);
            w.set_pl(vals::Pl::VERY_HIGH);
            w.set_pfctrl(vals::Pfctrl::DMA);
            w.set_htie(true);
            w.set_tcie(true);
            w.set_teie(true);
            route_dma(w);
        });
        // What was written to the ring is in memory before the stream may read it.
        cortex_m::asm::dmb();
        stream.cr().modify(|w| w.set_en(true));
    }

    pub(super) fn stop() {
        let stream = DMA1.st(DMA_STREAM);
        stream.cr().modify(|w| w.set_en(false));
        // EN reads 1 until the last access is done, and the other registers are locked until then (RM0090, 10.3.17).
        while stream.cr().read().en() {}
        clear();
    }

    fn clear() {
        DMA1.ifcr(GROUP).write(|w| {
            w.set_htif(FLAG, true);
            w.set_tcif(FLAG, true);
            w.set_teif(FLAG, true);
            w.set_dmeif(FLAG, true);
            w.set_feif(FLAG, true);
        });
    }

    pub(super) fn take_flags() -> Flags {
        let seen = DMA1.isr(GROUP).read();
        // Only what was seen: a flag that rises now raises the interrupt again.
        DMA1.ifcr(GROUP).write(|w| {
            w.set_htif(FLAG, seen.htif(FLAG));
            w.set_tcif(FLAG, seen.tcif(FLAG));
            w.set_teif(FLAG, seen.teif(FLAG));
        });
        Flags { half: seen.htif(FLAG), whole: seen.tcif(FLAG), failed: seen.teif(FLAG) }
    }

    /// The half the stream reads now. NDTR counts down what is left of the ring.
    pub(super) fn playing() -> usize {
        usize::from(usize::from(DMA1.st(DMA_STREAM).ndtr().read().ndt()) <= slipline_app::bank::BLOCK)
    }
}

/// The stream of a chip with the channel DMA behind a DMAMUX (G4): RM0440 chapters 12 and 13.
#[cfg(feature = "board-nucleo-g474re")]
mod stream {
    use super::Flags;
    use crate::board::{DMA_REQUEST, DMA_STREAM};
    use embassy_stm32::pac::bdma::vals;
    use embassy_stm32::pac::{DMA1, DMAMUX1};

    pub(super) fn start(ring: u32, register: u32, words: u16) {
        stop();
        // Channels 1 to 8 of DMA1 hang on DMAMUX channels 0 to 7 (RM0440 13.3.2).
        DMAMUX1.ccr(DMA_STREAM).write(|w| w.set_dmareq_id(DMA_REQUEST));
        let channel = DMA1.ch(DMA_STREAM);
        channel.par().write_value(register);
        channel.mar().write_value(ring);
        channel.ndtr().write(|w| w.set_ndt(words));
        channel.cr().write(|w| {
            w.set_dir(vals::Dir::FROM_MEMORY);
            w.set_msize(vals::Size::BITS32);
            w.set_psize(vals::Size::BITS32);
            w.set_minc(true);
            w.set_pinc(false);
            w.set_circ(true);
            w.set_pl(vals::Pl::VERY_HIGH);
            w.set_htie(true);
            w.set_tcie(true);
            w.set_teie(true);
        });
        // What was written to the ring is in memory before the channel may read it.
        cortex_m::asm::dmb();
        channel.cr().modify(|w| w.set_en(true));
    }

    pub(super) fn stop() {
        DMA1.ch(DMA_STREAM).cr().modify(|w| w.set_en(false));
        DMA1.ifcr().write(|w| w.set_gif(DMA_STREAM, true));
    }

    pub(super) fn take_flags() -> Flags {
        let seen = DMA1.isr().read();
        // Only what was seen: a flag that rises now raises the interrupt again.
        DMA1.ifcr().write(|w| {
            w.set_htif(DMA_STREAM, seen.htif(DMA_STREAM));
            w.set_tcif(DMA_STREAM, seen.tcif(DMA_STREAM));
            w.set_teif(DMA_STREAM, seen.teif(DMA_STREAM));
        });
        Flags { half: seen.htif(DMA_STREAM), whole: seen.tcif(DMA_STREAM), failed: seen.teif(DMA_STREAM) }
    }

    /// The half the channel reads now. NDTR counts down what is left of the ring.
    pub(super) fn playing() -> usize {
        usize::from(usize::from(DMA1.ch(DMA_STREAM).ndtr().read().ndt()) <= slipline_app::bank::BLOCK)
    }
}
