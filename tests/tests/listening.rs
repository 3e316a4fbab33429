//! The device's inputs, measured through the protocol.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_protocol::command::Comb;
use slipline_protocol::event::ResetCause;
use slipline_protocol::listen::{
    CapturePart, CaptureWindow, Captured, InputsReport, ListenPart, ListenWindow, Listened, Progress,
    WindowShape,
};
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::{Command, units::SampleIndex};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, MID, Rig, Table, comb, drive};
use slipline_tests::wire::Wire;

/// A block's codes, and whether the amplifier was muted.
type Note = ([u16; BLOCK as usize], bool);

/// Notes every block that it samples.
#[derive(Clone, Default)]
struct Notes(Arc<Mutex<Vec<Note>>>);

impl SimulatedInputs for Notes {
    fn sample(&mut self, codes: &[u16; BLOCK as usize], muted: bool, _: &mut [[u16; BLOCK as usize]; 2]) {
        self.0.lock().unwrap().push((*codes, muted));
    }
}

#[test]
fn the_inputs_sample_what_is_at_the_pin_whenever_a_block_is_played() {
    for block_waits in [false, true] {
        let notes = Notes::default();
        let options = Options { block_waits, ..Options::default() };
        let mut rig = Rig::of(SimulatedDevice::with_inputs(options, Box::new(notes.clone())));
        rig.make_ready();
        rig.play(&[(0, 0.3, 0.7)], 2000, 30);
        rig.device.inject_underrun();
        rig.live_ms(30);
        let noted = std::mem::take(&mut *notes.0.lock().unwrap());
        let (codes, muted): (Vec<_>, Vec<_>) = noted.into_iter().unzip();
        assert!(codes.as_flattened() == rig.recording.codes, "block waits: {block_waits}");
        assert_eq!(muted, rig.recording.muted, "block waits: {block_waits}");
        assert!(muted.contains(&false) && muted.ends_with(&[true]), "the underrun has muted it");

        // The plate stays where it is when the device is reset.
        rig.device.restart(ResetCause::Watchdog);
        rig.device.advance(5, |_| ());
        assert_eq!(notes.0.lock().unwrap().len(), 5);
    }
}

/// An armed device with the wire and a table of gain 1.
fn wired(options: Options) -> Rig {
    let mut rig = Rig::of(SimulatedDevice::with_inputs(options, Box::new(Wire::new())));
    rig.hello();
    rig.upload(&Table::line(65, 60_000.0, 20_000.0, |_| 1.0));
    rig.arm();
    rig
}

fn listened(rig: &mut Rig, input: u8, first_slot: u8) -> Listened {
    answer!(rig, Command::ListenRead(ListenPart { input, first_slot }), Listened)
}

fn captured(rig: &mut Rig, first: u16) -> Captured {
    answer!(rig, Command::CaptureRead(CapturePart { first }), Captured)
}

fn inputs(rig: &mut Rig) -> InputsReport {
    answer!(rig, Command::Inputs, Inputs)
}

/// Sixteen tones over a period of 40 blocks, from 234 Hz to 179 kHz, each of 0.05 of full scale.
fn sixteen() -> Comb {
    let tones: Vec<(u16, f64, f64)> =
        (0..16u16).map(|i| (3 + 150 * i + i % 3, 0.05, f64::from(i) * 0.37)).collect();
    comb(40, &tones)
}

fn window(from: Option<SampleIndex>, blocks: u16) -> ListenWindow {
    ListenWindow { from, blocks, shape: WindowShape::Rectangular, slots: u16::MAX, input: Some(0) }
}

#[test]
fn every_tone_of_a_comb_is_answered_by_what_the_wire_does_to_it() {
    for block_waits in [false, true] {
        let mut rig = wired(Options { block_waits, ..Options::default() });
        let at = rig.accepted(&Command::Comb(sixteen()));
        let begin = at + 20 * BLOCK;
        assert_eq!(rig.accepted(&Command::Listen(window(Some(begin - 127), 80))), begin);
        rig.live_blocks(30);
        let running = listened(&mut rig, 0, 0);
        assert_eq!((running.progress, running.begin), (Progress::Running, begin));
        assert!((1..80).contains(&running.blocks) && running.answers.is_empty(), "{running:?}");
        rig.live_blocks(80);
        let lower = listened(&mut rig, 0, 0);
        let upper = listened(&mut rig, 0, 8);
        assert_eq!((lower.progress, lower.begin, lower.blocks), (Progress::Finished, begin, 80));
        assert_eq!((lower.weight, lower.followed), (80 << 15, u16::MAX));
        assert_eq!(Listened { answers: lower.answers.clone(), ..upper.clone() }, lower);
        let scale = 4.0 / (16_383.0 * 128.0 * f64::from(lower.weight));
        let answers: Vec<_> = lower.answers.iter().chain(&upper.answers).collect();
        assert_eq!(answers.len(), 16);
        for (tone, answer) in sixteen().tones.iter().zip(answers) {
            let (re, im) = (answer.in_phase as f64 * scale, answer.quadrature as f64 * scale);
            let turns = -f64::from(tone.harmonic) / 5120.0 * Wire::LAG as f64;
            let amplitude = 2047.0 * 0.05 / 2.0;
            let off = (re - amplitude * (TAU * turns).cos()).hypot(im - amplitude * (TAU * turns).sin());
            assert!(off < 0.05, "{}: {re} {im}, {off} codes off", tone.harmonic);
        }
        assert!(lower.lowest < MID && lower.highest > MID + 2 * Wire::OFFSET, "{lower:?}");
        let unheard = listened(&mut rig, 1, 0);
        assert_eq!((unheard.lowest, unheard.highest), (0, 0));
        assert!(unheard.answers.iter().all(|answer| *answer == Default::default()), "it was not measured");
        let from = Some(begin + 200 * BLOCK);
        rig.accepted(&Command::Listen(ListenWindow { from, input: Some(1), ..window(None, 80) }));
        rig.live_blocks(200);
        let stuck = listened(&mut rig, 1, 0);
        assert_eq!((stuck.progress, stuck.followed), (Progress::Finished, u16::MAX));
        assert_eq!((stuck.lowest, stuck.highest), (Wire::STUCK, Wire::STUCK));
        let most = stuck.answers.iter().map(|it| it.in_phase.abs().max(it.quadrature.abs())).max().unwrap();
        assert!(most as f64 * scale < 0.01, "a constant answers nothing");
    }
}

#[test]
fn both_inputs_at_once_have_half_of_the_lock_ins() {
    let mut rig = wired(Options::default());
    let at = rig.accepted(&Command::Comb(sixteen()));
    let both = |slots| {
        let from = Some(at + 20 * BLOCK);
        Command::Listen(ListenWindow { from, slots, input: None, ..window(None, 40) })
    };
    let too_many = |got| Refusal::OutOfRange { field: Field::LockIns, min: 0, max: 8, got };
    assert_eq!(rig.refused(&both(0x1FF)), too_many(9));
    assert_eq!(rig.refused(&both(0xFFFF)), too_many(16));
    rig.accepted(&both(0xFF00));
    rig.live_blocks(80);
    let [sensor, stuck] = [0, 1].map(|input| listened(&mut rig, input, 8));
    assert_eq!((sensor.progress, sensor.followed, stuck.followed), (Progress::Finished, 0xFF00, 0xFF00));
    assert!(sensor.highest > sensor.lowest && sensor.answers.iter().all(|it| it.in_phase != 0));
    assert_eq!((stuck.lowest, stuck.highest), (Wire::STUCK, Wire::STUCK));
}

#[test]
fn a_capture_has_the_codes_from_the_requested_index_on() {
    let mut rig = wired(Options::default());
    rig.accepted(&Command::Drive(drive(&[(0, 0.4, 0.8)], 2000)));
    rig.record();
    let from = rig.device.now() + 300;
    let window = CaptureWindow { from: Some(from), input: 0, log2_codes: 2, values: 100 };
    assert_eq!(rig.accepted(&Command::Capture(window)), from);
    rig.live_blocks(4);
    let running = captured(&mut rig, 0);
    assert_eq!((running.progress, running.from, running.first), (Progress::Running, from, 0));
    assert!((1..60).contains(&running.captured), "{running:?}");
    rig.live_blocks(8);
    let mut values = Vec::new();
    while values.len() < 100 {
        let part = captured(&mut rig, values.len() as u16);
        assert_eq!((part.progress, part.captured), (Progress::Finished, 100));
        assert_eq!(part.values.len(), (100 - values.len()).min(40));
        values.extend_from_slice(&part.values);
    }
    assert_eq!(values[..running.values.len()], running.values);
    assert!(captured(&mut rig, 100).values.is_empty() && captured(&mut rig, u16::MAX).values.is_empty());
    let codes = rig.recording.from(from);
    let before = rig.recording.from(from - Wire::LAG as u64);
    assert_eq!(codes.len() + Wire::LAG, before.len());
    let sums: Vec<u32> =
        before[..400].chunks(4).map(|four| four.iter().map(|it| u32::from(Wire::heard(*it))).sum()).collect();
    assert_eq!(values, sums);
}

#[test]
fn a_lost_block_ends_what_is_measured_and_is_counted() {
    //
    let mut rig = wired(Options::default());
    rig.accepted(&Command::Comb(sixteen()));
    rig.live_blocks(20);
    let begin = rig.accepted(&Command::Listen(window(None, 40)));
    let capture = CaptureWindow { from: None, input: 0, log2_codes: 0, values: 4096 };
    assert_eq!(rig.accepted(&Command::Capture(capture)), begin);
    rig.live_blocks(10);
    rig.device.inject_overrun(3);
    rig.live_blocks(20);
    let at = begin + 10 * BLOCK;
    let broken = listened(&mut rig, 0, 0);
    assert_eq!((broken.progress, broken.blocks), (Progress::Broken { at }, 10));
    assert_eq!(broken.answers.len(), 8, "the sums up to there");
    let part = captured(&mut rig, 1240);
    assert_eq!((part.progress, part.captured, part.values.len()), (Progress::Broken { at }, 1280, 40));
    assert_eq!(inputs(&mut rig).lost_blocks, 3);
    // The next measurement is whole, and as exact.
    rig.accepted(&Command::Listen(window(None, 40)));
    rig.live_blocks(50);
    let whole = listened(&mut rig, 0, 0);
    assert_eq!((whole.progress, whole.followed), (Progress::Finished, u16::MAX));
    let scale = 4.0 / (16_383.0 * 128.0 * f64::from(whole.weight));
    let size = (whole.answers[0].in_phase as f64).hypot(whole.answers[0].quadrature as f64) * scale;
    assert!((size - 2047.0 * 0.025).abs() < 0.05, "{size}");
}

#[test]
fn the_inputs_are_described_and_what_they_cannot_do_is_refused() {
    let mut rig = wired(Options::default());
    let now = rig.device.now();
    assert_eq!(
        inputs(&mut rig),
        InputsReport { inputs: 2, lock_ins: 16, delay_ns: -250, lost_blocks: 0, now }
    );
    let (earliest, latest) = (now as i64, now as i64 + 24_000_000);
    let out = |field, min, max, got| Refusal::OutOfRange { field, min, max, got };
    let capture = CaptureWindow { from: None, input: 0, log2_codes: 0, values: 1 };
    for (command, refusal) in [
        (Command::Listen(window(None, 0)), out(Field::WindowBlocks, 1, 65_535, 0)),
        (Command::Listen(window(Some(now - 1), 1)), out(Field::ApplyAt, earliest, latest, earliest - 1)),
        (Command::Listen(window(Some(u64::MAX), 1)), out(Field::ApplyAt, earliest, latest, i64::MAX)),
        (Command::Listen(ListenWindow { input: Some(2), ..window(None, 1) }), out(Field::Input, 0, 1, 2)),
        (Command::ListenRead(ListenPart { input: 2, first_slot: 0 }), out(Field::Input, 0, 1, 2)),
        (Command::ListenRead(ListenPart { input: 0, first_slot: 16 }), out(Field::ToneSlot, 0, 15, 16)),
        (Command::Capture(CaptureWindow { input: 2, ..capture }), out(Field::Input, 0, 1, 2)),
        (Command::Capture(CaptureWindow { log2_codes: 11, ..capture }), out(Field::CaptureCodes, 0, 10, 11)),
        (
            Command::Capture(CaptureWindow { values: 4097, ..capture }),
            out(Field::CaptureValues, 1, 4096, 4097),
        ),
        (Command::Capture(CaptureWindow { values: 0, ..capture }), out(Field::CaptureValues, 1, 4096, 0)),
        (
            Command::Capture(CaptureWindow { from: Some(now - 1), ..capture }),
            out(Field::ApplyAt, earliest, latest, earliest - 1),
        ),
    ] {
        assert_eq!(rig.refused(&command), refusal, "{command:?}");
    }
    // Nothing of that has begun.
    assert_eq!(listened(&mut rig, 0, 0), Listened::default());
    assert_eq!(captured(&mut rig, 0), Captured::default());

    let mut deaf = Rig::armed();
    let report = inputs(&mut deaf);
    assert_eq!((report.inputs, report.lock_ins), (0, 0));
    let read = Command::ListenRead(ListenPart { input: 0, first_slot: 0 });
    for command in [
        Command::Listen(window(None, 1)),
        read.clone(),
        Command::Capture(capture),
        Command::CaptureRead(CapturePart { first: 0 }),
    ] {
        assert_eq!(deaf.refused(&command), Refusal::NotSupported);
    }
    rig.hello_of_minor(2);
    assert_eq!(rig.refused(&read), Refusal::UnknownMessage { id: 0x62 });
}

#[test]
fn a_stop_or_a_session_drops_what_is_measured_and_a_new_order_takes_its_place() {
    let mut rig = wired(Options::default());
    let capture = |values| Command::Capture(CaptureWindow { from: None, input: 0, log2_codes: 0, values });
    for _ in 0..2 {
        rig.accepted(&Command::Listen(window(None, 40)));
        rig.accepted(&capture(4096));
        rig.live_blocks(5);
        rig.accepted(&Command::ListenStop);
        rig.accepted(&Command::CaptureStop);
        assert_eq!(listened(&mut rig, 0, 0).progress, Progress::Idle);
        rig.live_blocks(1);
        assert_eq!(listened(&mut rig, 0, 0), Listened::default());
        let stopped = captured(&mut rig, 0);
        // The fifth block was over with the stop.
        assert_eq!((stopped.progress, stopped.captured), (Progress::Broken { at: stopped.from + 512 }, 512));
    }
    // Started and stopped before the next block.
    rig.accepted(&capture(9));
    rig.accepted(&Command::CaptureStop);
    rig.live_blocks(2);
    assert_eq!(captured(&mut rig, 0), Captured::default());

    rig.accepted(&Command::Listen(window(None, 3)));
    rig.accepted(&capture(200));
    rig.live_blocks(10);
    assert_eq!(listened(&mut rig, 0, 0).progress, Progress::Finished);
    assert_eq!(captured(&mut rig, 0).captured, 200);
    // The last results are forgotten at once, not when the next block comes.
    let begin = rig.accepted(&Command::Listen(window(None, 2)));
    rig.accepted(&capture(100));
    assert_eq!(
        (listened(&mut rig, 0, 0).progress, listened(&mut rig, 0, 0).begin),
        (Progress::Running, begin)
    );
    assert_eq!(captured(&mut rig, 0).captured, 0);
    rig.live_blocks(10);
    assert_eq!(listened(&mut rig, 0, 0).blocks, 2);
    rig.hello();
    assert_eq!(listened(&mut rig, 0, 0), Listened::default());
    rig.live_blocks(2);
    assert_eq!(listened(&mut rig, 0, 0), Listened::default());
    assert_eq!(captured(&mut rig, 0), Captured::default());
}

#[test]
fn a_tone_that_is_stopped_within_the_window_is_not_followed() {
    let mut rig = wired(Options::default());
    rig.play(&[(0, 0.4, 0.4), (5, 0.6, 0.4)], 2000, 10);
    rig.accepted(&Command::Listen(window(None, 400)));
    rig.live_blocks(10);
    rig.accepted(&Command::Drive(drive(&[(5, 0.6, 0.4)], 2000)));
    rig.live_blocks(400);
    let listened = listened(&mut rig, 0, 0);
    assert_eq!((listened.progress, listened.followed), (Progress::Finished, 1 << 5));
    assert_eq!((listened.answers[0].in_phase, listened.answers[0].quadrature), (0, 0));
    assert_ne!(listened.answers[5].in_phase, 0);
}

/// How much of a loud tone a Hann window of `blocks` shows in the answer of a faint one, in dB: the two differ by the block rate and
/// `tenths` of a bin.
fn leakage_db(blocks: u16, tenths: i32) -> f64 {
    // A tenth of a bin is the comb's base frequency; 30 kHz.
    let (period, faint) = (10 * blocks, 96 * blocks);
    let loud = (i32::from(faint + 10 * blocks) + tenths) as u16;
    let mut rig = wired(Options::default());
    let at = rig.accepted(&Command::Comb(comb(period, &[(faint, 1.0 / 65_535.0, 0.0), (loud, 0.9, 0.0)])));
    let hann = ListenWindow { shape: WindowShape::Hann, slots: 3, ..window(Some(at + 40 * BLOCK), blocks) };
    rig.accepted(&Command::Listen(hann));
    rig.live_blocks(u64::from(blocks) + 60);
    let heard = listened(&mut rig, 0, 0);
    assert_eq!((heard.progress, heard.followed), (Progress::Finished, 3));
    let [faint, loud] = [0, 1].map(|slot: usize| {
        let answer = &heard.answers[slot];
        (answer.in_phase as f64).hypot(answer.quadrature as f64)
    });
    20.0 * (faint / loud).log10()
}

#[test]
fn a_hann_window_of_blocks_leaks_where_two_tones_differ_by_the_block_rate() {
    // The figures of shared/PROTOCOL.md, "What the inputs measure": at its worst, and more than two bins away.
    for (blocks, worst_db, away_db) in [(20, -31.3, -47.0), (200, -51.6, -69.0)] {
        let worst = leakage_db(blocks, -8);
        assert!((worst - worst_db).abs() < 0.5, "{blocks} blocks: {worst} dB");
        for tenths in [-25, 25] {
            let away = leakage_db(blocks, tenths);
            assert!(away < away_db, "{blocks} blocks, {tenths} tenths of a bin: {away} dB");
        }
    }
}
