//! What a proof says against what the renderer sends.

use std::boxed::Box;
use std::vec::Vec;

use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use proptest::prelude::*;
use slipline_dds::bank::BLOCK;
use slipline_dds::bank::code::MID_SCALE;
use slipline_protocol::command::{Apply, ChordTone, Drive};
use slipline_protocol::limits::{MAX_HARMONIC, MAX_KNOT_STEP};
use slipline_protocol::refusal::Busy;
use slipline_protocol::timing::Timing;
use slipline_protocol::units::{CentiDecibel, Level, Phase};

use super::*;
use crate::mailbox::{Mailbox, Stop};
use crate::planning::plan::Planner;
use crate::renderer::Renderer;
use crate::slots::{SlotIndex, TableRef};

const RATE: u32 = 400_000;
const GLIDE: u32 = 2000;

/// Frequencies from 0.45 of the rate down to almost nothing, at gains around a half.
fn knots() -> Vec<Knot> {
    (0..65u32)
        .map(|i| Knot { step: MAX_KNOT_STEP - i * (MAX_KNOT_STEP / 65), gain: Gain((1 << 30) + (i << 20)) })
        .chain([Knot { step: 1, gain: Gain::FULL }])
        .collect()
}

fn chord(period_log2: u8, tones: &[(u16, u16, u16)]) -> Chord {
    let tone = |&(harmonic, level, phase): &(u16, u16, u16)| ChordTone {
        harmonic,
        level: Level(level),
        phase: Phase(phase),
    };
    Chord {
        period_log2,
        tones: tones.iter().map(tone).collect(),
        master: CentiDecibel(0),
        glide: GLIDE,
        apply: Apply::Next,
    }
}

fn placed(chord: &Chord) -> Result<ChordTones, Refusal> {
    let knots = knots();
    ChordTones::of(chord, knots.len() as u16, |index| knots[usize::from(index)])
}

/// Any chord that is placed, with levels up to those of `loudest`.
fn chords(loudest: u16) -> impl Strategy<Value = Chord> {
    let tone = (any::<u16>(), 0..=loudest, any::<u16>());
    (CHORD_PERIOD_LOG2.0..=CHORD_PERIOD_LOG2.1, prop::collection::vec(tone, 1..=MAX_TONES)).prop_map(
        |(period_log2, mut tones)| {
            let highest = MAX_HARMONIC >> (CHORD_PERIOD_LOG2.1 - period_log2);
            tones.iter_mut().for_each(|tone| tone.0 = 1 + tone.0 % highest);
            tones.sort_unstable();
            tones.dedup_by_key(|tone| tone.0);
            chord(period_log2, &tones)
        },
    )
}

/// A renderer with a table, whose planning never stops.
struct Rig {
    mailbox: Box<Mailbox<NoopRawMutex>>,
    renderer: Renderer,
    table: TableRef,
}

impl Rig {
    fn new() -> Self {
        let mailbox = Box::new(Mailbox::new());
        let knots = knots();
        for (index, &knot) in (0..).zip(&knots) {
            mailbox.write_knot(SlotIndex::First, index, knot);
        }
        mailbox.arm_from(0);
        let table = TableRef { slot: SlotIndex::First, knots: knots.len() as u16 };
        Self { mailbox, renderer: Renderer::new(Timing::at(RATE)), table }
    }

    /// Plans by `plan`, from where the output is, and hands it over.
    fn plan(
        &mut self,
        plan: impl FnOnce(
            &mut Planner<'_>,
            &crate::mailbox::View,
            TableRef,
        ) -> Result<crate::motion::Motion, Refusal>,
    ) -> Result<(), Refusal> {
        let view = self.mailbox.view();
        let (timing, mut never) = (Timing::at(RATE), || false);
        let slots = self.mailbox.slots();
        let mut planner = Planner { slots, timing: &timing, is_stopped: &mut never };
        let motion = plan(&mut planner, &view, self.table)?;
        self.mailbox.publish(&motion, &view).unwrap();
        Ok(())
    }

    fn sound(&mut self, chord: &Chord) -> Result<(), Refusal> {
        self.plan(|planner, view, table| {
            let mut tones = ChordTones::NONE;
            planner.place_chord(chord, table, &mut tones)?;
            planner.chord(&tones, view.next, chord.glide, table, &view.motion)
        })
    }

    fn drive(&mut self, drive: &Drive) -> Result<(), Refusal> {
        self.plan(|planner, view, table| planner.drive(drive, view.next, table, &view.motion))
    }

    /// The lowest and the highest code of the next `blocks` blocks.
    fn extent(&mut self, blocks: u32) -> (u16, u16) {
        let (mut lowest, mut highest, mut codes) = (MID_SCALE, MID_SCALE, [0; BLOCK]);
        for _ in 0..blocks {
            self.mailbox.feed();
            self.renderer.render(&self.mailbox, &mut codes);
            for code in codes {
                (lowest, highest) = (lowest.min(code), highest.max(code));
            }
        }
        (lowest, highest)
    }

    fn clips(&self) -> u32 {
        self.mailbox.view().report.clips
    }
}

/// The blocks of the rise.
const RISE: u32 = GLIDE.div_ceil(BLOCK as u32) + 1;

fn silence() -> Drive {
    Drive { tones: heapless::Vec::new(), master: CentiDecibel(0), glide: GLIDE, apply: Apply::Next }
}

/// The chord with its levels scaled so that its peak is just below full scale, or its loudest level is the highest.
fn as_loud_as_fits(chord: &Chord) -> Chord {
    let extent = Proof::new().extent(&placed(chord).unwrap(), &mut || false).unwrap();
    let factor = f64::from(slipline_dds::bank::FULL_SCALE) / f64::from(extent.peak());
    let loudest = chord.tones.iter().map(|tone| tone.level.0).max().unwrap();
    let factor = factor.min(f64::from(u16::MAX) / f64::from(loudest));
    let mut scaled = chord.clone();
    for tone in &mut scaled.tones {
        tone.level = Level((f64::from(tone.level.0) * factor) as u16);
    }
    scaled
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_proven_peak_is_the_peak_of_the_sent_codes(quiet in chords(7000)) {
        prop_assume!(quiet.tones.iter().any(|tone| tone.level.0 > 100));
        let chord = as_loud_as_fits(&quiet);
        let tones = placed(&chord).unwrap();
        let mut proof = Proof::new();
        let extent = proof.extent(&tones, &mut || false).unwrap();
        prop_assert_eq!(proof.check(&tones, &mut || false), Ok(()));
        let mut rig = Rig::new();
        rig.sound(&chord).unwrap();
        let (low, high) = rig.extent(RISE);
        let (lowest, highest) = extent.codes();
        prop_assert!(lowest.saturating_sub(1) <= low && high <= highest + 1, "the rise stays below the peak");
        let period = tones.period() / BLOCK as u32;
        // Two periods, from anywhere: one is as the other.
        for _ in 0..2 {
            prop_assert_eq!(rig.extent(period), (lowest, highest));
        }
        // Folded back, faded and stopped, it never clips.
        rig.mailbox.set_limit(700);
        rig.extent(rig_period());
        rig.mailbox.set_limit(1000);
        rig.extent(rig_period());
        rig.drive(&silence()).unwrap();
        rig.extent(5);
        rig.mailbox.stop(Stop::Emergency);
        rig.extent(20);
        prop_assert_eq!(rig.extent(2), (MID_SCALE, MID_SCALE));
        prop_assert_eq!(rig.clips(), 0);
    }

    #[test]
    fn a_chord_above_full_scale_is_refused_with_its_peak_and_none_that_clips_is_accepted(chord in chords(u16::MAX)) {
        let tones = placed(&chord).unwrap();
        let (sum, full) = (tones.sum(), u64::from(Gain::FULL.0));
        match Proof::new().check(&tones, &mut || false) {
            Ok(()) if sum <= full => {}
            Ok(()) => {
                let mut rig = Rig::new();
                rig.sound(&chord).unwrap();
                rig.extent(RISE + tones.period() / BLOCK as u32);
                prop_assert_eq!(rig.clips(), 0);
            }
            Err(Refusal::Peak { peak_per_mille }) => {
                prop_assert!(peak_per_mille > 1000);
                let truth = exact_peak(&tones);
                prop_assert!((f64::from(peak_per_mille) / 1000.0 - truth).abs() < 2e-3, "{peak_per_mille} {truth}");
            }
            Err(Refusal::Headroom { sum_per_mille }) => {
                prop_assert!(sum_per_mille > 5657);
                prop_assert!(exact_peak(&tones) > 1.0, "no phases help");
            }
            other => prop_assert!(false, "{other:?}"),
        }
    }
}

/// Blocks of a fold-back period.
fn rig_period() -> u32 {
    (Timing::at(RATE).limit_period / BLOCK as u64) as u32
}

/// The largest sample of a period in doubles, full scale = 1.
fn exact_peak(tones: &ChordTones) -> f64 {
    let turn = 2f64.powi(64);
    let value = |n: u32| -> f64 {
        let tone = |(_, step, phase, amplitude): (usize, PhaseStep, u64, Gain)| {
            let at = step.0.wrapping_mul(n.into()).wrapping_add(phase) as f64 / turn;
            f64::from(amplitude.0) / f64::from(Gain::FULL.0) * (core::f64::consts::TAU * at).sin()
        };
        tones.sounding().map(tone).sum()
    };
    (0..tones.period()).map(|n| value(n).abs()).fold(0.0, f64::max)
}

/// Sixteen tones in phase at the period's quarter: the sum of the amplitudes is 4, and so is the peak.
fn in_phase() -> Chord {
    let tones: Vec<_> = (0..16).map(|i| (16 + 4 * i, 16_384, 16_384)).collect();
    chord(10, &tones)
}

#[test]
fn tones_that_meet_are_refused_with_the_peak_they_have_together() {
    let tones = placed(&in_phase()).unwrap();
    let Err(Refusal::Peak { peak_per_mille }) = Proof::new().check(&tones, &mut || false) else { panic!() };
    assert_eq!(u64::from(peak_per_mille), tones.sum() * 1000 / u64::from(Gain::FULL.0) + 1);
}

#[test]
fn a_chord_whose_sum_overflows_32_bits_is_refused_before_it_is_rendered() {
    let loud: Vec<_> = (0..16).map(|i| (16 + 4 * i, u16::MAX, 16_384)).collect();
    let tones = placed(&chord(10, &loud)).unwrap();
    let refused = Proof::new().check(&tones, &mut || panic!("nothing is rendered"));
    assert!(matches!(refused, Err(Refusal::Headroom { sum_per_mille: 8000.. })), "{refused:?}");
}

#[test]
fn a_proof_looks_for_a_stop_before_each_block() {
    let tones = placed(&in_phase()).unwrap();
    let blocks = tones.period() / BLOCK as u32;
    for stopped_after in 0..blocks {
        let mut looks = 0;
        let refused = Proof::new().extent(&tones, &mut || {
            looks += 1;
            looks > stopped_after
        });
        assert_eq!((refused, looks), (Err(Refusal::Busy(Busy::DriveActive)), stopped_after + 1));
    }
    let mut looks = 0;
    let done = Proof::new().extent(&tones, &mut || {
        looks += 1;
        false
    });
    assert!(done.is_ok());
    // Four before the tones' bases, one before each block, one after the last.
    assert_eq!(looks, 4 + blocks + 1);
}

#[test]
fn an_invalid_chord_is_refused_by_its_field_and_range() {
    let good = [(100, 1000, 0), (101, 1000, 0)];
    assert!(placed(&chord(12, &good)).is_ok());
    let range = |field, min, max, got| Err(Refusal::OutOfRange { field, min, max, got });
    for period_log2 in [0, 6, 15, 32, 255] {
        let refused = placed(&chord(period_log2, &good)).map(|_| ());
        assert_eq!(refused, range(Field::ChordPeriod, 7, 14, period_log2.into()));
    }
    let highest = i64::from(MAX_HARMONIC >> 2);
    for (tones, min, got) in [
        (&[(0, 1, 0)][..], 1, 0),
        (&[(1844, 1, 0)], 1, 1844),
        (&[(u16::MAX, 1, 0)], 1, 65_535),
        (&[(7, 1, 0), (7, 1, 0)], 8, 7),
        (&[(7, 1, 0), (6, 1, 0)], 8, 6),
    ] {
        assert_eq!(placed(&chord(12, tones)).map(|_| ()), range(Field::Harmonic, min, highest, got));
    }
    assert_eq!(placed(&chord(12, &[])).map(|_| ()), range(Field::ToneCount, 1, 16, 0));
    assert_eq!(ChordTones::of(&chord(12, &good), 0, |_| Knot::default()), Err(Refusal::NoTable));
    // Frequencies that the table has not.
    let narrow = [Knot { step: 1 << 28, gain: Gain(5) }, Knot { step: 1 << 29, gain: Gain(9) }];
    let at = |harmonic| {
        ChordTones::of(&chord(12, &[(harmonic, u16::MAX, 0)]), 2, |index| narrow[usize::from(index)])
    };
    for outside in [255, 513] {
        assert_eq!(at(outside).map(|_| ()), range(Field::Harmonic, 256, 512, outside.into()));
    }
    // No louder than the table says.
    for (harmonic, gain) in [(256, 5), (384, 7), (512, 9)] {
        assert_eq!(at(harmonic).unwrap().sum(), gain);
    }
}

#[test]
fn a_chord_begins_in_silence_alone_and_what_follows_it_keeps_the_sum() {
    // Schroeder's phases.
    let turned = |i: u16| (400 + 4 * i, 10_000, 0u16.wrapping_sub((i * i).wrapping_mul(4096)));
    let loud = as_loud_as_fits(&chord(12, &(0..8).map(turned).collect::<Vec<_>>()));
    let tones = placed(&loud).unwrap();
    assert!(tones.sum() > u64::from(Gain::FULL.0) / 10 * 14);
    assert_eq!(Proof::new().check(&tones, &mut || false), Ok(()));
    let mut rig = Rig::new();
    rig.sound(&loud).unwrap();
    let (low, high) = rig.extent(RISE + 32);
    assert!(low < 500 && high > 3500);
    assert_eq!(rig.sound(&loud), Err(Refusal::Busy(Busy::DriveActive)));
    // A drive, quiet as it may be, begins with the sum of the chord.
    let tone = slipline_protocol::command::Tone {
        slot: 0,
        position: slipline_protocol::units::Position(0),
        level: Level(1),
        phase: Phase(0),
    };
    let quiet = Drive { tones: [tone].into_iter().collect(), ..silence() };
    let refused = rig.drive(&quiet);
    assert!(matches!(refused, Err(Refusal::Headroom { sum_per_mille: 1001.. })), "{refused:?}");
    let swapped = rig.plan(|planner, view, table| planner.swap(view.next, table, &view.motion));
    assert!(matches!(swapped, Err(Refusal::Headroom { .. })), "{swapped:?}");
    rig.drive(&silence()).unwrap();
    rig.extent(RISE);
    assert_eq!(rig.extent(1), (MID_SCALE, MID_SCALE));
    rig.drive(&quiet).unwrap();
    assert_eq!(rig.clips(), 0);
}

#[test]
fn a_steady_bank_renders_what_the_bank_renders() {
    let tones = placed(&as_loud_as_fits(&in_phase())).unwrap();
    let (mut bank, mut steady) = (slipline_dds::bank::Bank::new(), slipline_dds::bank::SteadyBank::new());
    let mut blocks = [slipline_dds::bank::ToneBlock::default(); MAX_TONES];
    // What sounded before in the bank leaves no trace.
    blocks[15] = slipline_dds::bank::ToneBlock::steady(1 << 40, 1 << 20);
    bank.render(&blocks, &mut [0; BLOCK]);
    blocks[15] = slipline_dds::bank::ToneBlock::default();
    for (slot, step, phase, amplitude) in tones.sounding().take(15) {
        blocks[slot] = slipline_dds::bank::ToneBlock::steady(step.0, amplitude.0);
        bank.set_phase(slot, phase);
        steady.set(slot, step.0, phase, amplitude.0);
    }
    let (mut first, mut one, mut other) = ([0; BLOCK], [0; BLOCK], [0; BLOCK]);
    for block in 0..=8 {
        bank.render(&blocks, &mut one);
        steady.render(&mut other);
        assert_eq!(one, other);
        match block {
            0 => first = one,
            8 => assert_eq!(one, first, "a period of 1024 samples"),
            _ => {}
        }
    }
}

#[test]
fn a_multiples_step_is_the_exact_quotient_rounded_down() {
    for period in [128, 384, 4096, 16_384, 1_000_064, 128 * 65_535] {
        for harmonic in [1, 2, 3, 57, period / 7, period * 9 / 20] {
            let exact = (u128::from(harmonic) << 64) / u128::from(period);
            assert_eq!(u128::from(step_of(harmonic, period).0), exact, "{harmonic} of {period}");
        }
    }
}
