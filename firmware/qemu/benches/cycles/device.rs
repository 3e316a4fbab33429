//! The functions that are measured, their state, and the image's entry.

use core::{cell::UnsafeCell, hint::black_box};

use crate::compare::{Draw, bank_differences, lock_in_differences};
use cortex_m::peripheral::{Peripherals, SYST, syst::SystClkSource};
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use slipline_app::dds::bank::{
    AMPLITUDE_ONE, BLOCK, Bank, MAX_STEP_CHANGE, TONES, ToneBlock,
    code::{MID_SCALE, codes},
};
use slipline_app::dds::lock_in::{History, LockIn, MAX_WINDOW_BLOCKS, Shape, State, Window};
use slipline_app::ports::INPUTS;

/// The state between the calls.
struct CycleBench {
    bank: Bank,
    tones: [ToneBlock; TONES],
    /// A glide up, as fast as the bank's stated accuracy allows, and the glide back down.
    glides: [[ToneBlock; TONES]; 2],
    /// Whether the last glide went up, so that the next one goes down.
    down: bool,
    samples: [i32; BLOCK],
    codes: [u16; BLOCK],
    clipped: u32,
    lock_in: LockIn<INPUTS>,
    history: History,
    phases: [u64; TONES],
    index: u64,
}

impl CycleBench {
    /// Measures one block of the tones, as they were rendered.
    fn measure(&mut self, glide: Option<bool>) {
        let Self { lock_in, history, phases, index, codes, .. } = self;
        let tones = match (glide, &self.glides) {
            (None, _) => &self.tones,
            (Some(false), [up, _]) => up,
            (Some(true), [_, down]) => down,
        };
        if lock_in.state() != State::Measuring {
            let window = Window {
                begin: *index,
                blocks: MAX_WINDOW_BLOCKS,
                shape: Shape::Hann,
                slots: u16::MAX,
                input: Some(0),
            };
            if lock_in.start(window, *index).is_err() {
                return;
            }
        }
        history.record(*index, phases, tones);
        lock_in.take_block(*index, core::slice::from_ref(codes), history.at(*index));
        *index += BLOCK as u64;
        for (phase, tone) in phases.iter_mut().zip(tones) {
            *phase = phase.wrapping_add(tone.step.wrapping_add(tone.step_end) << 6);
        }
    }

    /// Renders one block: a steady one, or the glide up or down.
    fn render(&mut self, glide: Option<bool>) {
        let tones = match (glide, &self.glides) {
            (None, _) => &self.tones,
            (Some(false), [up, _]) => up,
            (Some(true), [_, down]) => down,
        };
        self.bank.render(tones, &mut self.samples);
        self.clipped = self.clipped.wrapping_add(codes(&self.samples, &mut self.codes).clipped);
    }
}

struct Shared(UnsafeCell<CycleBench>);
// SAFETY: this image has one thread and no interrupts.
unsafe impl Sync for Shared {}

static BENCH: Shared = Shared(UnsafeCell::new(CycleBench {
    bank: Bank::new(),
    tones: [ToneBlock::steady(0, 0); TONES],
    glides: [[ToneBlock::steady(0, 0); TONES]; 2],
    down: false,
    samples: [0; BLOCK],
    codes: [MID_SCALE; BLOCK],
    clipped: 0,
    lock_in: LockIn::new(),
    history: History::new(),
    phases: [0; TONES],
    index: 0,
}));

fn bench() -> &'static mut CycleBench {
    // SAFETY: each function below takes the only reference and returns without keeping it.
    unsafe { &mut *BENCH.0.get() }
}

/// Lets the first `tones` slots sound, at frequencies from 1/40 to 2/5 of the sample rate.
#[unsafe(no_mangle)]
extern "C" fn bench_setup(tones: u32) {
    let bench = bench();
    bench.bank = Bank::new();
    bench.tones = [ToneBlock::default(); TONES];
    for (tone, slot) in bench.tones.iter_mut().zip(1_u32..=tones) {
        *tone = ToneBlock::steady(u64::MAX / 40 * u64::from(slot), AMPLITUDE_ONE / TONES as u32);
    }
    let [up, down] = &mut bench.glides;
    for ((tone, up), down) in bench.tones.iter().zip(up).zip(down) {
        *up = ToneBlock {
            step_end: tone.step + MAX_STEP_CHANGE,
            amplitude_end: tone.amplitude - tone.amplitude / 16,
            ..*tone
        };
        *down = ToneBlock {
            step: up.step_end,
            step_end: up.step,
            amplitude: up.amplitude_end,
            amplitude_end: up.amplitude,
        };
    }
    bench.down = false;
    bench.lock_in.stop();
    // The first block builds every basis.
    bench.render(None);
}

/// A block in which nothing changes.
#[unsafe(no_mangle)]
extern "C" fn bench_steady() {
    bench().render(None);
}

/// A block with another frequency for every tone, which is then kept.
#[unsafe(no_mangle)]
extern "C" fn bench_retune() {
    let bench = bench();
    for tone in &mut bench.tones {
        *tone = ToneBlock::steady(tone.step + MAX_STEP_CHANGE, tone.amplitude);
    }
    bench.render(None);
}

/// A block in which every tone moves in frequency and amplitude, back and forth.
#[unsafe(no_mangle)]
extern "C" fn bench_glide() {
    let bench = bench();
    bench.down = !bench.down;
    bench.render(Some(!bench.down));
}

/// A block of the lock-ins of steady tones.
#[unsafe(no_mangle)]
extern "C" fn bench_lock_in_steady() {
    bench().measure(None);
}

/// A block of the lock-ins of tones that move, back and forth.
#[unsafe(no_mangle)]
extern "C" fn bench_lock_in_glide() {
    let bench = bench();
    bench.down = !bench.down;
    bench.measure(Some(!bench.down));
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    hprintln!("{}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::nop();
    }
}

/// Blocks that are averaged; QEMU's timer ticks once in 40 instructions.
const BLOCKS: u32 = 64;
/// Under `-icount shift=0` an instruction takes 1 ns and the timer runs at 25 MHz.
const INSTRUCTIONS_PER_TICK: u32 = 40;

/// Cycles from one block of 128 codes to the next at 168 MHz and 400 kS/s.
const BLOCK_PERIOD: u32 = 168_000_000 / 400_000 * BLOCK as u32;

/// Instructions per block.
fn count(timer: &mut SYST, render: extern "C" fn()) -> u32 {
    timer.clear_current();
    let start = SYST::get_current();
    for _ in 0..BLOCKS {
        black_box(render)();
    }
    let ticks = start.wrapping_sub(SYST::get_current()) & 0x00FF_FFFF;
    ticks * INSTRUCTIONS_PER_TICK / BLOCKS
}

#[entry]
fn main() -> ! {
    let Some(peripherals) = Peripherals::take() else { unreachable!("taken once") };
    let mut timer = peripherals.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(0x00FF_FFFF);
    timer.enable_counter();

    let CycleBench { bank, lock_in, samples, codes, .. } = bench();
    let mut draw = Draw::new();
    let blocks = bank_differences(&mut draw, bank, samples, codes);
    hprintln!("blocks that differ from the portable kernel's: {} of 300", blocks);
    let measured = [None, Some(0), Some(1)];
    let sums: u32 =
        measured.into_iter().map(|input| lock_in_differences(&mut draw, lock_in, codes, input)).sum();
    hprintln!("blocks whose lock-in sums differ from the portable ones: {} of 600", sums);
    let different = blocks + sums;
    // Called through an opaque pointer, so that the symbol stays.
    black_box(bench_setup as extern "C" fn(u32))(TONES as u32);
    for (name, render) in [
        ("steady", bench_steady as extern "C" fn()),
        ("retune", bench_retune),
        ("glide", bench_glide),
        ("lock-in, steady", bench_lock_in_steady),
        ("lock-in, glide", bench_lock_in_glide),
    ] {
        let instructions = count(&mut timer, render);
        let thousandths = instructions * 1000 / (TONES * BLOCK) as u32;
        hprintln!(
            "{}: {} instructions per block, {}.{:03} per tone and sample, {} % of the block period if each took a cycle",
            name,
            instructions,
            thousandths / 1000,
            thousandths % 1000,
            instructions * 100 / BLOCK_PERIOD,
        );
    }
    debug::exit(if different == 0 { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::nop();
    }
}
