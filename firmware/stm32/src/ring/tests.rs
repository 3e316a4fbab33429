//! The ring against a DMA that reads it sample by sample, while the renderer is as late as can be.

use std::cell::{Cell, RefCell};

use proptest::prelude::*;
use slipline_app::safety::fade::FADE_STEP;

use super::*;

/// Codes that are copied while the DMA reads one. The copy takes about 600 cycles, so at least 85 on the F407.
const COPIED_PER_SAMPLE: usize = 85;

/// The ring's memory with a DMA that goes on while it is written.
struct Model {
    halves: Halves,
    codes: RefCell<[u16; 2 * BLOCK]>,
    /// The next code to be read.
    position: Cell<usize>,
    played: RefCell<Vec<u16>>,
    /// Whether the DMA's interrupt is served: it has the higher priority, so at once.
    is_served: Cell<bool>,
}

impl Model {
    fn silent() -> Self {
        Self {
            halves: Halves::full(),
            codes: RefCell::new([MID_SCALE; 2 * BLOCK]),
            position: Cell::new(0),
            played: RefCell::default(),
            is_served: Cell::new(true),
        }
    }

    /// The DMA reads a code.
    fn sample(&self) {
        let at = self.position.get();
        self.played.borrow_mut().push(self.codes.borrow()[at]);
        self.position.set((at + 1) % (2 * BLOCK));
        if (at + 1).is_multiple_of(BLOCK) && self.is_served.get() {
            self.halves.finish(&Interrupt(self));
        }
    }

    fn samples(&self, count: usize) {
        for _ in 0..count {
            self.sample();
        }
    }

    /// The renderer: waits for room, renders for `rendering` samples, then hands its block over.
    fn hand_over(&self, codes: &[u16; BLOCK], rendering: usize) -> Result<(), Late> {
        while self.halves.is_full() {
            self.sample();
        }
        self.samples(rendering);
        assert!(self.halves.offer(self, codes)?, "there was room");
        Ok(())
    }
}

impl Ring for Model {
    fn write(&self, half: usize, codes: impl Iterator<Item = u16>) {
        for (n, code) in codes.take(BLOCK).enumerate() {
            if n % COPIED_PER_SAMPLE == COPIED_PER_SAMPLE - 1 {
                self.sample();
            }
            self.codes.borrow_mut()[half * BLOCK + n] = code;
        }
    }

    fn last(&self, half: usize) -> u16 {
        self.codes.borrow()[half * BLOCK + BLOCK - 1]
    }

    fn left(&self) -> usize {
        2 * BLOCK - self.position.get()
    }
}

/// The ring as the DMA's interrupt writes it: just after the DMA has left that half, so the DMA stands still meanwhile.
struct Interrupt<'a>(&'a Model);

impl Ring for Interrupt<'_> {
    fn write(&self, half: usize, codes: impl Iterator<Item = u16>) {
        self.0.codes.borrow_mut()[half * BLOCK..][..BLOCK]
            .iter_mut()
            .zip(codes)
            .for_each(|(to, code)| *to = code);
    }

    fn last(&self, half: usize) -> u16 {
        self.0.last(half)
    }

    fn left(&self) -> usize {
        self.0.left()
    }
}

/// Blocks of a tone of 20 kHz at nearly full scale, and its largest step.
fn tone(block: usize) -> [u16; BLOCK] {
    std::array::from_fn(|n| {
        let turns = 0.05 * (block * BLOCK + n) as f64;
        (f64::from(MID_SCALE) + 2000.0 * (std::f64::consts::TAU * turns).sin()).round() as u16
    })
}
const STEEPEST: u16 = 630;

/// Renders a tone in 40 samples a block, but one block takes `delay` samples more; what plays, and how many were late.
/// After one that is late the renderer is silent.
fn play_with_a_delay(delay: usize) -> (Vec<u16>, usize) {
    let model = Model::silent();
    let mut late = 0;
    for block in 0..40 {
        let codes = if late == 0 { tone(block) } else { [MID_SCALE; BLOCK] };
        let rendering = if block == 20 { 40 + delay } else { 40 };
        late += usize::from(model.hand_over(&codes, rendering) == Err(Late));
    }
    model.samples(BLOCK);
    (model.played.take(), late)
}

/// What plays is the tone without a gap, up to where it leaves it for a line to mid-scale.
fn is_one_line_after_the_tone(played: &[u16]) -> bool {
    let tone: Vec<u16> = (0..60).flat_map(tone).collect();
    // The ring begins with two blocks of mid-scale.
    let sounding = &played[2 * BLOCK..];
    let Some(left) = sounding.iter().zip(&tone).position(|(a, b)| a != b) else { return true };
    let line: Vec<u16> = fade(tone[left - 1]).take(sounding.len() - left).collect();
    left % BLOCK == 0 && sounding[left..] == line
}

#[test]
fn a_renderer_that_is_late_by_any_number_of_samples_leaves_the_tone_by_one_line_and_never_comes_back_to_it() {
    for delay in 0..5 * BLOCK {
        let (played, late) = play_with_a_delay(delay);
        assert!(is_one_line_after_the_tone(&played), "late by {delay}: not one line");
        let steepest = played.windows(2).map(|pair| pair[0].abs_diff(pair[1])).max();
        assert!(steepest <= Some(STEEPEST + FADE_STEP), "late by {delay}: {steepest:?}");
        // Rendering begins when the DMA leaves a half.
        assert_eq!(late > 0, 40 + delay > BLOCK - MARGIN, "late by {delay}");
        // The block after it comes into the same half, and may find too little of it left.
        assert!(late <= 2, "late by {delay}: {late}");
        assert!(late == 0 || played.ends_with(&[MID_SCALE; BLOCK]));
    }
}

/// Revises the last block of a tone to silence, `delay` samples after its hand-over. Returns the codes that play, whether
/// the block was revisable, and the result of the revision.
fn revise_after(delay: usize, rendering: usize) -> (Vec<u16>, bool, Result<(), Late>) {
    let model = Model::silent();
    for block in 0..10 {
        model.hand_over(&tone(block), 10).unwrap();
    }
    model.samples(delay);
    let is_revisable = model.halves.is_revisable(&model);
    model.samples(rendering);
    let revised = model.halves.revise(&model, &[MID_SCALE; BLOCK]);
    for _ in 0..8 {
        let _ = model.hand_over(&[MID_SCALE; BLOCK], 10);
    }
    (model.played.take(), is_revisable, revised)
}

#[test]
fn a_block_that_waits_is_revised_whole_or_not_at_all() {
    // Handed over 10 samples and the copy after the half before it began.
    let gone = 10 + BLOCK / COPIED_PER_SAMPLE;
    for delay in 0..BLOCK + 20 {
        let (played, is_revisable, revised) = revise_after(delay, 0);
        assert_eq!(is_revisable, gone + delay <= BLOCK - REVISION, "after {delay}");
        assert_eq!(revised.is_ok(), gone + delay <= BLOCK - MARGIN, "after {delay}");
        // Blocks 0 to 9 begin after two of mid-scale.
        let waiting = &played[(2 + 9) * BLOCK..][..BLOCK];
        if revised.is_ok() {
            assert_eq!(waiting, [MID_SCALE; BLOCK], "after {delay}");
        } else {
            assert_eq!(waiting, tone(9), "after {delay}");
            assert!(is_one_line_after_the_tone(&played), "after {delay}");
        }
        assert!(played.ends_with(&[MID_SCALE; BLOCK]));
    }
}

#[test]
fn a_block_that_is_revisable_leaves_the_time_that_the_renderer_takes_for_it() {
    for delay in 0..BLOCK {
        let (_, is_revisable, revised) = revise_after(delay, REVISION - MARGIN);
        assert!(revised.is_ok() || !is_revisable, "after {delay}");
    }
}

#[test]
fn a_block_that_is_not_played_is_not_revisable() {
    let model = Model::silent();
    for block in 0..4 {
        model.hand_over(&tone(block), 10).unwrap();
    }
    assert!(model.halves.is_revisable(&model));
    assert_eq!(model.hand_over(&tone(4), BLOCK), Err(Late));
    model.hand_over(&tone(5), 10).unwrap();
    assert!(!model.halves.is_revisable(&model), "the line is under way");
}

#[test]
fn after_the_line_blocks_are_played_again_where_their_index_says() {
    let model = Model::silent();
    let late = |block| if block == 3 { BLOCK } else { 0 };
    for block in 0..20 {
        let codes = match block {
            0..=3 | 12.. => tone(block),
            _ => [MID_SCALE; BLOCK],
        };
        assert_eq!(model.hand_over(&codes, 40 + late(block)).is_err(), block == 3, "{block}");
    }
    model.samples(BLOCK);
    let played = model.played.take();
    for block in 12..19 {
        assert_eq!(played[(2 + block) * BLOCK..][..BLOCK], tone(block), "{block}");
    }
}

#[test]
fn an_interrupt_that_is_lost_leaves_the_ring_in_step_with_the_dma_and_counts_as_late() {
    for lost in [1, 2, 3] {
        let model = Model::silent();
        for block in 0..6 {
            model.hand_over(&tone(block), 40).unwrap();
        }
        model.is_served.set(false);
        model.samples(lost * BLOCK);
        model.is_served.set(true);
        // Both flags are found at once by the next interrupt that is served.
        model.halves.resynchronise(&Interrupt(&model));
        assert_eq!(model.halves.offer(&model, &tone(6)), Err(Late), "{lost} lost");
        for _ in 0..8 {
            assert_eq!(model.hand_over(&[MID_SCALE; BLOCK], 40), Ok(()), "{lost} lost");
        }
        assert!(model.played.take().ends_with(&[MID_SCALE; BLOCK]), "{lost} lost");
    }
}

#[test]
fn asking_whether_the_ring_is_full_does_not_hide_a_late_block() {
    let model = Model::silent();
    model.samples(2 * BLOCK);
    assert!(!model.halves.is_full());
    assert_eq!(model.halves.offer(&model, &tone(0)), Err(Late));
}

#[test]
fn a_ring_that_is_filled_again_goes_to_mid_scale_from_the_code_that_the_pin_holds() {
    let model = Model::silent();
    model.halves.refill(&Interrupt(&model), 4095);
    for _ in 0..6 {
        model.hand_over(&[0; BLOCK], 40).unwrap();
    }
    let played = model.played.take();
    let line: Vec<u16> = fade(4095).take(4 * BLOCK).collect();
    assert_eq!(played[..4 * BLOCK], line);
}

proptest! {
    /// Whatever the renderer's times: what plays is its blocks, whole, or lines of the fade's slope, and a block that
    /// is not played was reported late or came while the line was under way.
    #[test]
    fn only_whole_blocks_or_lines_are_played(times in prop::collection::vec(0..3 * BLOCK, 1..60)) {
        let model = Model::silent();
        let mut silent_until = 0;
        for (block, &rendering) in times.iter().enumerate() {
            let codes = if block < silent_until { [MID_SCALE; BLOCK] } else { tone(block) };
            if model.hand_over(&codes, rendering) == Err(Late) {
                silent_until = block + 6;
            }
        }
        let played = model.played.take();
        let halves: Vec<&[u16]> = played.chunks_exact(BLOCK).collect();
        let mut before = MID_SCALE;
        for half in halves {
            let line: Vec<u16> = fade(before).take(BLOCK).collect();
            let is_whole = (0..times.len()).any(|block| half == tone(block));
            prop_assert!(is_whole || half == line);
            before = half[BLOCK - 1];
        }
    }
}

#[test]
fn the_fetches_are_counted_to_the_code_also_while_the_interrupt_waits_and_where_the_count_wraps() {
    let model = Model::silent();
    for sample in 0..5 * BLOCK as u32 {
        assert_eq!(model.halves.fetched(&model), sample);
        model.sample();
    }
    assert_eq!(model.halves.taken(), 1, "the second of the two halves that it begins with");
    model.is_served.set(false);
    model.samples(BLOCK - 1);
    let before = model.halves.fetched(&model);
    for sample in 1..BLOCK as u32 {
        model.sample();
        assert_eq!(model.halves.fetched(&model), before + sample, "the half is over, and not counted yet");
    }
    let model = Model::silent();
    model.halves.played.store(u32::MAX - 1, Relaxed);
    model.samples(2 * BLOCK - 3);
    assert_eq!(model.halves.fetched(&model), 0_u32.wrapping_sub(3));
}
