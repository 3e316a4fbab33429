//! What minor 3 adds: the comb, and what the inputs measure.

use super::Example;
use heapless::Vec;
use slipline_protocol::command::{Apply, Comb, CombTone};
use slipline_protocol::listen::{
    CapturePart, CaptureWindow, Captured, InPhaseQuadrature, InputsReport, ListenPart, ListenWindow,
    Listened, Progress, WindowShape,
};
use slipline_protocol::refusal::{Field, Refusal};
use slipline_protocol::units::{CentiDecibel, Level, Phase};
use slipline_protocol::{Command, Event};

/// The commands of minor 3.
pub(crate) fn commands() -> std::vec::Vec<Example<Command>> {
    let tones = [
        CombTone { harmonic: 1311, level: Level(4000), phase: Phase(0) },
        CombTone { harmonic: 1442, level: Level(4000), phase: Phase(8192) },
    ];
    let comb = Comb {
        period_blocks: 40,
        tones: Vec::from_slice(&tones).unwrap(),
        master: CentiDecibel(-600),
        glide: 4000,
        apply: Apply::Next,
    };
    let tone = CombTone { harmonic: u16::MAX, level: Level(u16::MAX), phase: Phase(u16::MAX) };
    let largest = Comb {
        period_blocks: u16::MAX,
        tones: Vec::from_slice(&[tone; 16]).unwrap(),
        master: CentiDecibel(i16::MIN),
        glide: u32::MAX,
        apply: Apply::At(u64::MAX),
    };
    let window = ListenWindow {
        from: Some(256_000),
        blocks: 400,
        shape: WindowShape::Rectangular,
        slots: 0x0003,
        input: Some(0),
    };
    let all =
        ListenWindow { from: None, blocks: u16::MAX, shape: WindowShape::Hann, slots: u16::MAX, input: None };
    let late = ListenWindow { from: Some(u64::MAX), input: Some(u8::MAX), ..all };
    let capture = CaptureWindow { from: Some(256_000), input: 1, log2_codes: 3, values: 4096 };
    let at_once = CaptureWindow { from: None, input: 0, log2_codes: 0, values: 1 };
    let values =
        CaptureWindow { from: Some(u64::MAX), input: u8::MAX, log2_codes: u8::MAX, values: u16::MAX };
    let commands = [
        ("comb", Command::Comb(comb)),
        ("comb-largest", Command::Comb(largest)),
        ("inputs", Command::Inputs),
        ("listen", Command::Listen(window)),
        ("listen-next", Command::Listen(all)),
        ("listen-largest", Command::Listen(late)),
        ("listen-read", Command::ListenRead(ListenPart { input: 0, first_slot: 8 })),
        ("listen-stop", Command::ListenStop),
        ("capture", Command::Capture(capture)),
        ("capture-next", Command::Capture(at_once)),
        ("capture-largest", Command::Capture(values)),
        ("capture-read", Command::CaptureRead(CapturePart { first: 40 })),
        ("capture-stop", Command::CaptureStop),
    ];
    commands.map(|(label, command)| (label.to_owned(), command)).into()
}

/// The events of minor 3.
pub(crate) fn events() -> std::vec::Vec<Example<Event>> {
    let inputs = InputsReport { inputs: 2, lock_ins: 16, delay_ns: -1125, lost_blocks: 3, now: 128_000 };
    let most = InputsReport {
        inputs: u8::MAX,
        lock_ins: u8::MAX,
        delay_ns: i64::MIN,
        lost_blocks: u32::MAX,
        now: u64::MAX,
    };
    let answers = [
        InPhaseQuadrature { in_phase: 1_234_567_890, quadrature: -987_654_321 },
        InPhaseQuadrature { in_phase: 0, quadrature: 0 },
    ];
    let listened = Listened {
        progress: Progress::Finished,
        begin: 256_000,
        blocks: 400,
        weight: 400 << 15,
        followed: 1,
        lowest: 1800,
        highest: 2290,
        answers: Vec::from_slice(&answers).unwrap(),
    };
    let running = Listened { progress: Progress::Running, answers: Vec::new(), ..listened };
    let highest = InPhaseQuadrature { in_phase: i64::MIN, quadrature: i64::MAX };
    let largest = Listened {
        progress: Progress::Broken { at: u64::MAX },
        begin: u64::MAX,
        blocks: u16::MAX,
        weight: u32::MAX,
        followed: u16::MAX,
        lowest: u16::MAX,
        highest: u16::MAX,
        answers: Vec::from_slice(&[highest; 8]).unwrap(),
    };
    let captured = Captured {
        progress: Progress::Running,
        from: 256_000,
        captured: 42,
        first: 40,
        values: Vec::from_slice(&[2047, 2049]).unwrap(),
    };
    let all = Captured {
        progress: Progress::Broken { at: u64::MAX },
        from: u64::MAX,
        captured: u16::MAX,
        first: u16::MAX,
        values: Vec::from_slice(&[u32::MAX; 40]).unwrap(),
    };
    let mut events = std::vec![
        ("inputs-reply".to_owned(), Event::Inputs(inputs)),
        ("inputs-reply-largest".to_owned(), Event::Inputs(most)),
        ("listened".to_owned(), Event::Listened(listened)),
        ("listened-nothing".to_owned(), Event::Listened(Listened::default())),
        ("listened-running".to_owned(), Event::Listened(running)),
        ("listened-largest".to_owned(), Event::Listened(largest)),
        ("captured".to_owned(), Event::Captured(captured)),
        ("captured-largest".to_owned(), Event::Captured(all)),
    ];
    let fields = [
        ("comb-period", Field::CombPeriod),
        ("window-blocks", Field::WindowBlocks),
        ("lock-ins", Field::LockIns),
        ("input", Field::Input),
        ("capture-codes", Field::CaptureCodes),
        ("capture-values", Field::CaptureValues),
    ];
    for (label, field) in fields {
        let refusal = Refusal::OutOfRange { field, min: 0, max: 1, got: 2 };
        events.push((format!("refused-out-of-range-{label}"), Event::Refused(refusal)));
    }
    events
}
