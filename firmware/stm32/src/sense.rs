//! The inputs' codes: two ADCs that convert with every trigger of the DAC, and a ring of the DMA that the renderer reads.
//!
//! ```text
//! sample timer --TRGO--+--> DAC1: next code to the pin
//!                      `--> ADC1 (sensor) and ADC2 (shunt), at the same moment; both ready: one word
//!                                                 | DMA, circular
//!                                                 v
//!                                   ring of four blocks of words --> SenseStream::take_block, after each block rendered
//! ```
//! No interrupt belongs to it, and nothing waits for it: the renderer looks once a block how far the DMA has come.
//!
//! **Which code is whose.** Both DMAs make one transfer for each trigger, so what the ADC's DMA has stored is known from the
//! count of codes that the DAC's has fetched (`dac::fetched`), to the last code by the ADC's DMA's own counter:
//! ```text
//! lag = fetched - first trigger of the ring - words stored, modulo the ring: 1 until the ADC is ready, then 0
//! ```
//! Another lag means that the ADC has stopped or missed a trigger, or that the DMA does not take its words. Then, after an
//! overrun that the ADC itself flags, and when the DAC's interrupt has lost count, the ring restarts. The blocks that
//! are not whole in it are reported as lost; `places` keeps the others' places. If the ADC stays dead every block is
//! lost, and the restart, two samples long, is tried with each.
//!
//! The ring begins either with the sample timer, in step by itself, or while that runs: then the ADCs are armed between two
//! triggers, found by the count of codes and the timer's own count. In the second quarter of the timer's period the lag must
//! be 1.
//!
//! All code that touches the ADCs is in this file, in `adc` (one file for each kind of ADC) and in the board's file.

#[cfg_attr(feature = "adc-f4", path = "sense/f4.rs")]
#[cfg_attr(feature = "adc-fast", path = "sense/fast.rs")]
mod adc;

use core::cell::UnsafeCell;
use core::ops::Range;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use embassy_stm32::gpio::Flex;
use embassy_stm32::{Peri, peripherals};
use slipline_app::BLOCK;
use slipline_app::ports::{INPUTS, Overrun, SenseStream};

use crate::board::{self, SAMPLE_TIMER, SENSE_WAY as WAY};
use crate::places::{Places, Sampled, Search};

/// Words of the ring. A block is read while the one after it is sampled, and may be read two blocks later still.
const RING: usize = 4 * BLOCK;

/// If a trigger comes between the reads, a larger lag than this is a stop. What can come between takes 4 samples
/// (`ring::MARGIN`).
const STOPPED: u32 = 8;

const PERIOD: u16 = board::TIMER_PERIOD;
/// From this count of the sample timer on, the DAC's DMA has answered the period's trigger; it takes some tens of cycles.
const SETTLED: u16 = PERIOD / 4;
/// Until this count the ADCs cannot be ready: they take longer than half of the period (`adc`).
const CONVERTING: u16 = PERIOD / 2;

/// Reads of the timer's count, at most, until it is [`SETTLED`]. A read takes 25 cycles of the core or more, so that this
/// is a period at least (1000 cycles on the H743), and 3000 cycles if the timer stands still.
const LOOKS: u32 = 40;

/// Words of the ADCs: the sensor's code in the lower half, the shunt's in the upper one.
struct Codes(UnsafeCell<[u32; RING]>);

// SAFETY: the DMA writes it, and one task only reads it.
unsafe impl Sync for Codes {}

// Where the DMA can reach it; see `dac`. Nothing initialises it: a word is read only after the DMA has written it.
#[unsafe(link_section = ".uninit.dma")]
static CODES: Codes = Codes(UnsafeCell::new([0; RING]));
static PLACES: Places = Places::new();
/// The trigger of the ring's first word.
static ORIGIN: AtomicU32 = AtomicU32::new(0);
/// Whether the ring has been full since it began.
static IS_FULL: AtomicBool = AtomicBool::new(false);
/// The ring must restart before it is read again.
static IS_LOST: AtomicBool = AtomicBool::new(true);

impl Codes {
    /// Reads a block of one input, from a place in the ring on, counted round and round. A code has 16 bits of the ADCs' word; the
    /// upper four of them are 0.
    #[inline(never)]
    fn read(&self, place: usize, input: usize, codes: &mut [u16; BLOCK]) {
        let place = place % RING;
        let (until_end, from_start) = codes.split_at_mut((RING - place).min(BLOCK));
        self.read_run(place, input, until_end);
        if !from_start.is_empty() {
            self.read_run(0, input, from_start);
        }
    }

    /// Reads the codes of one input from a place on; the run does not pass the ring's end.
    // A call, so that its unrolled loops are in the fast memory once.
    #[inline(never)]
    fn read_run(&self, mut place: usize, input: usize, codes: &mut [u16]) {
        let halves = self.0.get().cast::<u16>().wrapping_add(input % INPUTS);
        // SAFETY: half of a word of the ring, for a place in it; the caller's two runs end with it. Volatile, because the
        // compiler does not know that the DMA writes it.
        let code = |place| unsafe { halves.wrapping_add(INPUTS * place).read_volatile() };
        // Reads in a row take fewer cycles than reads between writes.
        let (groups, rest) = codes.as_chunks_mut::<4>();
        for codes in groups {
            *codes = core::array::from_fn(|n| code(place + n));
            place += codes.len();
        }
        for (n, rest) in rest.iter_mut().enumerate() {
            *rest = code(place + n);
        }
    }
}

/// The inputs.
pub(crate) struct Inputs {
    /// `dac::fetched`.
    fetched: fn() -> u32,
    /// Blocks that have been read or lost, modulo 2^32.
    next: u32,
}

impl Inputs {
    /// Sets up the pins and the ADCs. Before the sample timer runs. `fetched` counts the codes that the DAC's DMA has fetched.
    pub(crate) fn start(
        fetched: fn() -> u32,
        sensors: (
            Peri<'static, peripherals::ADC1>,
            Peri<'static, peripherals::ADC2>,
            Peri<'static, board::SenseDma>,
        ),
        pins: [Flex<'static>; INPUTS],
    ) -> Self {
        // They are this file's from now on.
        let _ = sensors;
        for mut pin in pins {
            pin.set_as_analog();
            // A `Flex` that is dropped gives its pin up.
            core::mem::forget(pin);
        }
        adc::set_up();
        Self { fetched, next: 0 }
    }

    /// The reference voltage VREF+ in mV, by the chip's internal reference and its factory calibration; 0 if the ADC does not answer or
    /// nothing is stored. Before [`Inputs::start`].
    pub(crate) fn reference_mv() -> u16 {
        let (stored, at_mv) = board::REFERENCE_CALIBRATION;
        // SAFETY: a half word of the chip's system memory, which the factory has written; any bits are a value.
        let calibration = unsafe { (stored as *const u16).read_volatile() };
        match adc::reference_code() {
            Some(code @ 1..) if calibration != u16::MAX => {
                u16::try_from(u32::from(calibration) * at_mv / u32::from(code)).unwrap_or(u16::MAX)
            }
            _ => 0,
        }
    }

    /// The codes that can be read. Restarts if the ADC has stopped or may be out of step.
    fn sampled(&self) -> Sampled {
        if !IS_LOST.load(Relaxed)
            && !adc::has_overrun()
            && let Some(sampled) = self.follow()
        {
            return sampled;
        }
        IS_LOST.store(true, Relaxed);
        self.begin_anew();
        Sampled { until: (self.fetched)(), count: 0 }
    }

    /// The timer's count after a look at the DMA, the lag, the triggers so far, and those of them since the ring began.
    fn look(&self) -> (u16, u32, u32, u32) {
        let stored = (RING as u32).wrapping_sub(WAY.left().into());
        let count = SAMPLE_TIMER.cnt().read().cnt();
        let fetched = (self.fetched)();
        let since = fetched.wrapping_sub(ORIGIN.load(Relaxed));
        (count, since.wrapping_sub(stored) % RING as u32, fetched, since)
    }

    /// The DMA's position; `None` if it does not follow the triggers.
    fn follow(&self) -> Option<Sampled> {
        let (mut before, mut seen) = ((self.fetched)(), self.look());
        // A look between two triggers is exact. The next trigger is far right after one.
        for _ in 0..LOOKS {
            if seen.2 == before {
                break;
            }
            (before, seen) = (seen.2, self.look());
        }
        let (count, lag, fetched, since) = seen;
        let in_step = if fetched != before {
            0..=STOPPED
        } else if (SETTLED..CONVERTING).contains(&count) {
            // All four looks were in this place of one period.
            1..=1
        } else {
            0..=1
        };
        if !in_step.contains(&lag) {
            return None;
        }
        let stored = since.wrapping_sub(lag);
        if stored >= RING as u32 {
            IS_FULL.store(true, Relaxed);
        }
        // The oldest word may be overwritten while it is read.
        let count = if IS_FULL.load(Relaxed) { RING as u32 - 1 } else { stored };
        Some(Sampled { until: fetched.wrapping_sub(lag), count })
    }

    /// The triggers so far, if the timer's count is one of those wanted, all of them from [`SETTLED`] on: the DAC's DMA has answered
    /// every trigger then, and the next one is yet to come.
    fn settled(&self, wanted: Range<u16>) -> Option<u32> {
        let fetched = (self.fetched)();
        let count = SAMPLE_TIMER.cnt().read().cnt();
        (wanted.contains(&count) && (self.fetched)() == fetched).then_some(fetched)
    }

    /// Restarts while the sample timer runs. If that does not succeed, as when the timer stands still or an interrupt comes
    /// between, it is tried again with the next block.
    fn begin_anew(&self) {
        adc::disarm();
        // The conversion under way is over: it takes less than a period, and began in this one at the latest.
        let Some(now) = self.next_settled(PERIOD, |_| true) else { return };
        let Some(_) = self.next_settled(PERIOD, |fetched| fetched != now) else { return };
        prepare();
        // Half a period is left to arm them.
        let Some(origin) = self.next_settled(CONVERTING, |_| true) else { return };
        arm(origin);
        if self.settled(SETTLED..PERIOD) != Some(origin) {
            adc::disarm();
            IS_LOST.store(true, Relaxed);
        }
    }

    /// Waits until the triggers are [`settled`], before a count of the timer, with a number of them as wanted.
    fn next_settled(&self, before: u16, is_wanted: impl Fn(u32) -> bool) -> Option<u32> {
        (0..LOOKS).find_map(|_| self.settled(SETTLED..before).filter(|fetched| is_wanted(*fetched)))
    }

    fn lost(&mut self, blocks: u32) -> Option<Result<(), Overrun>> {
        self.next = self.next.wrapping_add(blocks);
        Some(Err(Overrun { blocks }))
    }
}

impl SenseStream for Inputs {
    fn inputs(&self) -> usize {
        INPUTS
    }

    fn delay_ns(&self) -> i32 {
        adc::DELAY_NS
    }

    fn take_block(
        &mut self,
        inputs: Range<usize>,
        codes: &mut [[u16; BLOCK]; INPUTS],
    ) -> Option<Result<(), Overrun>> {
        let first = match PLACES.find(self.next, self.sampled()) {
            Search::Pending => return None,
            Search::Lost(blocks) => return self.lost(blocks),
            Search::Found(first) => first,
        };
        let place = first.wrapping_sub(ORIGIN.load(Relaxed)) as usize;
        for (input, codes) in codes.iter_mut().enumerate().filter(|(input, _)| inputs.contains(input)) {
            CODES.read(place, input, codes);
        }
        // The DMA may have come round meanwhile, to the word that it writes next.
        if (self.fetched)().wrapping_sub(first) >= RING as u32 {
            return self.lost(1);
        }
        self.next = self.next.wrapping_add(1);
        Some(Ok(()))
    }

    fn skip_block(&mut self) -> Option<Result<(), Overrun>> {
        // Two have yet to be played, at most.
        if PLACES.waiting(self.next) <= 2 {
            return None;
        }
        let is_well = !IS_LOST.load(Relaxed) && !adc::has_overrun() && self.look().1 <= STOPPED;
        if !is_well && let Search::Lost(blocks) = PLACES.find(self.next, self.sampled()) {
            return self.lost(blocks);
        }
        self.next = self.next.wrapping_add(1);
        Some(Ok(()))
    }
}

/// The DAC's ring has taken a block as its half `half`.
pub(crate) fn expect(half: u32) {
    PLACES.take(half);
}

/// A block has come that the DAC's ring could not take.
pub(crate) fn skip() {
    PLACES.skip();
}

/// The DAC's interrupt was late by a block or more: its count may be wrong by some rounds of its ring.
pub(crate) fn lose_step() {
    IS_LOST.store(true, Relaxed);
}

/// Begins with the DAC's ring: while the sample timer stands still, and has for longer than a conversion takes.
pub(crate) fn begin() {
    PLACES.forget();
    adc::disarm();
    prepare();
    arm(0);
}

/// Both ends of the DMA's way forget what was, and the ring is empty. Nothing is being converted.
fn prepare() {
    adc::clear();
    WAY.start(CODES.0.get() as u32, adc::data(), RING as u16);
}

/// The next trigger's code is the ring's first word.
fn arm(origin: u32) {
    adc::arm();
    ORIGIN.store(origin, Relaxed);
    IS_FULL.store(false, Relaxed);
    IS_LOST.store(false, Relaxed);
}
