//! A target on the device's inputs: any measurement and any level hold, and any failure meanwhile.

use std::sync::{Arc, Mutex};

use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_protocol::Command;
use slipline_protocol::event::Event;
use slipline_protocol::hold::{HoldProgress, HoldSetting, HoldTone};
use slipline_protocol::listen::{
    CapturePart, CaptureWindow, ListenPart, ListenWindow, Progress, WindowShape,
};
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::{CentiDecibel, SampleIndex};

use crate::answer;
use crate::client::Client;
use crate::rig::{BLOCK, MID, Rig, comb, drive};

/// What the first input has sampled since the start; the second is stuck.
#[derive(Clone, Default)]
struct Heard(Arc<Mutex<Vec<u16>>>);

const STUCK: u16 = 77;

impl SimulatedInputs for Heard {
    fn inputs(&self) -> usize {
        2
    }

    fn sample(&mut self, codes: &[u16; BLOCK as usize], _: bool, sensed: &mut [[u16; BLOCK as usize]; 2]) {
        sensed[0] = codes.map(|code| (code + MID) / 2);
        sensed[1] = [STUCK; BLOCK as usize];
        self.0.lock().expect("no test panics here").extend(sensed[0]);
    }
}

/// The last order of each kind, with the index in its answer.
#[derive(Default)]
struct Ordered {
    listen: Option<(SampleIndex, ListenWindow)>,
    capture: Option<(SampleIndex, CaptureWindow)>,
    /// Whether the capture was stopped, or a block was lost since one of the two was ordered.
    is_cut: bool,
    lost: u32,
    /// Whether a hold has changed the sounding levels, or may have changed them.
    has_held: bool,
}

/// Measurements, captures, holds, lost blocks and sound, each of one byte that chooses it and some more: every reading
/// matches the sampled inputs, a device that measures sends the codes of one that does not, and one that holds is never
/// above full scale.
///
/// # Panics
/// If that does not hold.
pub fn inputs(data: &[u8]) {
    let mut bytes = data.iter().copied();
    let options = Options { block_waits: data.len().is_multiple_of(2), ..Options::default() };
    let heard = Heard::default();
    let mut rig = Rig::of(SimulatedDevice::with_inputs(options.clone(), Box::new(heard.clone())));
    let mut deaf = Rig::new(options);
    for rig in [&mut rig, &mut deaf] {
        rig.make_ready();
    }
    let mut ordered = Ordered::default();
    for _ in 0..60 {
        let Some(choice) = bytes.next() else { break };
        let mut byte = || bytes.next().unwrap_or(0);
        match choice % 12 {
            0 | 1 => {
                let index = match byte() % 3 {
                    0 => None,
                    near => Some(rig.device.now() + u64::from(byte()) * u64::from(near) * 7),
                };
                let kind = byte();
                let shape = if kind.is_multiple_of(2) { WindowShape::Rectangular } else { WindowShape::Hann };
                let input = (kind / 2 % 4).checked_sub(1);
                let slots = u16::from_le_bytes([byte(), byte()]);
                let window = ListenWindow { from: index, blocks: byte().into(), shape, slots, input };
                order(&mut rig, &Command::Listen(window), |at| ordered.listen = Some((at, window)));
            }
            2 | 3 => {
                let from = match byte() % 3 {
                    0 => None,
                    near => Some(rig.device.now() + u64::from(byte()) * u64::from(near) * 7),
                };
                let (input, log2_codes) = (byte() % 3, byte() % 12);
                let window = CaptureWindow { from, input, log2_codes, values: u16::from(byte()) * 9 };
                order(&mut rig, &Command::Capture(window), |at| ordered.capture = Some((at, window)));
            }
            4 => {
                if is_holding(&mut rig) {
                    assert_eq!(rig.refused(&Command::ListenStop), Refusal::Busy(Busy::Holding));
                } else {
                    rig.accepted(&Command::ListenStop);
                    ordered.listen = None;
                }
            }
            5 => {
                rig.accepted(&Command::CaptureStop);
                ordered.is_cut = true;
            }
            6 => {
                let blocks = 1 + u32::from(byte() % 4);
                rig.device.inject_overrun(blocks);
                ordered.lost += blocks;
                ordered.is_cut = true;
            }
            7 => {
                let sound =
                    drive(&[(byte() % 16, f64::from(byte()) / 255.0, f64::from(byte()) / 255.0)], 2000);
                both(&mut rig, &mut deaf, &Command::Drive(sound), &ordered);
            }
            8 => {
                let tones = [1, 2, 3].map(|n| (n * (1 + u16::from(byte())), f64::from(byte()) / 800.0, 0.0));
                both(&mut rig, &mut deaf, &Command::Comb(comb(1 + u16::from(byte()), &tones)), &ordered);
            }
            9 => both(&mut rig, &mut deaf, &Command::Stop, &ordered),
            10 => {
                let tones = (0..byte() % 4)
                    .map(|_| HoldTone { slot: byte() % 17, amplitude: u32::from(byte()) << (byte() % 14) });
                let tones = tones.collect();
                let setting = HoldSetting {
                    input: byte() % 3,
                    time_constant: u32::from(byte()) << (byte() % 8),
                    blocks: byte().into(),
                    max_rise: CentiDecibel(i16::from_le_bytes([byte(), byte() % 32])),
                    slew: CentiDecibel(i16::from_le_bytes([byte(), byte() % 32])),
                    tones,
                };
                let begins = !setting.tones.is_empty();
                if matches!(rig.send(&Command::Hold(setting)), Event::Accepted(_)) && begins {
                    ordered.has_held = true;
                    ordered.listen = None;
                }
            }
            _ => {}
        }
        let blocks = u64::from(byte() % 64);
        for rig in [&mut rig, &mut deaf] {
            rig.live_blocks(blocks);
        }
        check(&mut rig, &ordered, &heard.0.lock().expect("no test panics here"));
    }
    for rig in [&mut rig, &mut deaf] {
        rig.live_blocks(10);
    }
    if !ordered.has_held {
        assert!(rig.recording.codes == deaf.recording.codes, "to measure changes nothing that sounds");
    }
    let report = answer!(rig, Command::Inputs, Inputs);
    assert_eq!(report.lost_blocks, ordered.lost);
    rig.hello();
    let Event::Listened(listened) = rig.send(&Command::ListenRead(ListenPart { input: 0, first_slot: 0 }))
    else {
        panic!("no report of the measurement")
    };
    assert_eq!(listened.progress, Progress::Idle, "a session ends what the last one began");
}

/// Gives an order that may be refused for a value outside its range.
fn order(rig: &mut Rig, command: &Command, taken: impl FnOnce(SampleIndex)) {
    match rig.send(command) {
        Event::Accepted(accepted) => taken(accepted.at),
        Event::Refused(Refusal::OutOfRange { .. } | Refusal::Busy(Busy::Holding)) => {}
        other => panic!("{command:?}: {other:?}"),
    }
}

/// Gives both devices a command; they answer alike, unless a hold has changed what sounds.
fn both(rig: &mut Rig, deaf: &mut Rig, command: &Command, ordered: &Ordered) {
    let (answer, other) = (rig.send(command), deaf.send(command));
    if !ordered.has_held {
        assert_eq!(answer, other, "{command:?}");
    }
}

fn is_holding(rig: &mut Rig) -> bool {
    let held = answer!(rig, Command::HoldRead, Held);
    held.progress == HoldProgress::On
}

/// Compares the reported readings with the samples of the first input.
fn check(rig: &mut Rig, ordered: &Ordered, heard: &[u16]) {
    let status = rig.status();
    assert!(status.sum_per_mille <= 1000 && status.counters.clips == 0, "{status:?}");
    if is_holding(rig) {
        // The measurement is the hold's.
        return;
    }
    for input in 0..2 {
        let Event::Listened(reading) = rig.send(&Command::ListenRead(ListenPart { input, first_slot: 3 }))
        else {
            panic!("no report of the measurement")
        };
        let Some((begin, window)) = ordered.listen else {
            assert_eq!(reading.progress, Progress::Idle);
            continue;
        };
        assert_eq!((reading.begin, reading.followed & !window.slots), (begin, 0));
        assert!(
            reading.blocks <= window.blocks
                && (ordered.is_cut || !matches!(reading.progress, Progress::Broken { .. }))
        );
        match reading.progress {
            Progress::Finished => {
                let codes = &heard[begin as usize..][..usize::from(window.blocks) * BLOCK as usize];
                let is_measured = window.input.is_none_or(|measured| measured == input);
                let (lowest, highest) = match input {
                    _ if !is_measured => (0, 0),
                    0 => (*codes.iter().min().expect("codes"), *codes.iter().max().expect("codes")),
                    _ => (STUCK, STUCK),
                };
                assert_eq!(
                    (reading.lowest, reading.highest, reading.blocks),
                    (lowest, highest, window.blocks)
                );
                assert_eq!(reading.answers.len(), 8);
            }
            Progress::Broken { at } => assert!(at >= begin),
            Progress::Idle | Progress::Running => assert!(reading.answers.is_empty()),
        }
    }
    let capture = answer!(rig, Command::CaptureRead(CapturePart { first: 0 }), Captured);
    let Some((from, window)) = ordered.capture.filter(|_| capture.progress != Progress::Idle) else { return };
    assert_eq!(capture.from, from);
    assert!(capture.captured <= window.values);
    assert!(capture.captured == window.values || capture.progress != Progress::Finished);
    let size = 1 << window.log2_codes;
    for (place, value) in capture.values.iter().enumerate() {
        let sum = match window.input {
            0 => heard[from as usize + place * size..][..size].iter().map(|code| u32::from(*code)).sum(),
            _ => u32::from(STUCK) << window.log2_codes,
        };
        assert_eq!(*value, sum);
    }
}
