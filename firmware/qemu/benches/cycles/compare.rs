//! The assembly against the portable kernels, over blocks of every kind.

use slipline_app::dds::bank::{
    AMPLITUDE_ONE, BLOCK, Bank, TONES, ToneBlock,
    code::{codes, codes_portably},
};
use slipline_app::dds::lock_in::{History, LockIn, Shape, Window};
use slipline_app::ports::INPUTS;

/// Pseudo-random numbers, the same in every run.
pub(crate) struct Draw(u64);

impl Draw {
    pub(crate) const fn new() -> Self {
        Self(1)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 ^ (self.0 >> 29)
    }
}

/// Renders tones by the assembly and by the portable kernel; returns how many of 300 blocks differ.
pub(crate) fn bank_differences(
    draw: &mut Draw,
    bank: &mut Bank,
    samples: &mut [i32; BLOCK],
    native: &mut [u16; BLOCK],
) -> u32 {
    *bank = Bank::new();
    let mut portable = Bank::new();
    let mut tones = [ToneBlock::default(); TONES];
    let (mut different, mut samples_portable, mut codes_portable) = (0, [0; BLOCK], [0; BLOCK]);
    for block in 0..300 {
        for tone in &mut tones {
            let step = tone.step_end;
            let amplitude = tone.amplitude_end;
            let (step_end, amplitude_end) = match (block / 3) % 4 {
                // Steady with old and new frequencies, gliding softly, then anything at all.
                0 => (step, amplitude),
                1 => (step.wrapping_add(draw.next() >> 10), amplitude),
                2 => (step.wrapping_sub(draw.next() >> 10), (draw.next() >> 33) as u32),
                _ => (draw.next() / 2, (draw.next() >> 32) as u32),
            };
            *tone = ToneBlock { step, step_end, amplitude, amplitude_end };
        }
        bank.render(&tones, samples);
        portable.render_portable(&tones, &mut samples_portable);
        let converted = codes(samples, native);
        let converted_portably = codes_portably(&samples_portable, &mut codes_portable);
        different += u32::from(
            samples_portable != *samples || codes_portable != *native || converted != converted_portably,
        );
    }
    different
}

/// Measures pseudo-random codes of none, one and two inputs, or of `input` alone, by the assembly and by the portable kernel;
/// returns after how many of 200 blocks the sums differ, and one more if the wrong slots were given up.
pub(crate) fn lock_in_differences(
    draw: &mut Draw,
    lock_in: &mut LockIn<INPUTS>,
    codes: &mut [u16; BLOCK],
    input: Option<u8>,
) -> u32 {
    /// A slot that is not asked for, one that falls silent and one whose phase jumps.
    const LEFT_OUT: usize = 2;
    const SILENT: usize = 5;
    const JUMPING: usize = 11;
    let (mut portable, mut history) = (LockIn::<INPUTS>::new(), History::new());
    let slots = !(1 << LEFT_OUT);
    let window = Window { begin: 0, blocks: 200, shape: Shape::Hann, slots, input };
    if lock_in.start(window, 0).is_err() || portable.start(window, 0).is_err() {
        return 1;
    }
    let (mut phases, mut tones) = ([0_u64; TONES], [ToneBlock::steady(0, AMPLITUDE_ONE); TONES]);
    let mut different = 0;
    for block in 0..200_u64 {
        for tone in &mut tones {
            tone.step = tone.step_end;
            // Steady, as fast as a tone may glide, and anything at all.
            tone.step_end = match draw.next() % 3 {
                0 => tone.step,
                1 => tone.step.wrapping_add(draw.next() >> 10).wrapping_sub(draw.next() >> 10),
                _ => draw.next() / 2,
            };
        }
        for (slot, (phase, tone)) in phases.iter_mut().zip(&mut tones).enumerate() {
            match (slot, block) {
                (SILENT, 100..) => (tone.amplitude, tone.amplitude_end) = (0, 0),
                // A swell from nothing is not silent.
                (_, 50) => tone.amplitude = 0,
                (_, 51) => (tone.amplitude, tone.amplitude_end) = (AMPLITUDE_ONE, 0),
                (_, 52) => tone.amplitude_end = AMPLITUDE_ONE,
                (JUMPING, 150) => *phase = phase.wrapping_add(1),
                _ => {}
            }
        }
        let index = block * BLOCK as u64;
        history.record(index, &phases, &tones);
        codes.fill_with(|| (draw.next() >> 48) as u16);
        let mut ends = *codes;
        // The other input: nothing but the ends of the range, the largest products.
        ends.iter_mut().for_each(|code| *code = if *code < 1 << 15 { 0 } else { 4095 });
        let inputs = [*codes, ends];
        let some = match block {
            30 => 0,
            _ if block % 2 == 0 => 1,
            _ => 2,
        };
        let inputs = inputs.get(..some).unwrap_or_default();
        lock_in.take_block(index, inputs, history.at(index));
        portable.take_block_portably(index, inputs, history.at(index));
        different += u32::from(lock_in.reading() != portable.reading());
        for (phase, tone) in phases.iter_mut().zip(&tones) {
            *phase = phase.wrapping_add(tone.step.wrapping_add(tone.step_end) << 6);
        }
    }
    different + u32::from(lock_in.reading().followed != slots & !(1 << SILENT | 1 << JUMPING))
}
