//! The level hold through the protocol: its corrections, its limits and its ends. The plate is a wire with a finger on it.

mod ending;

use std::sync::{Arc, Mutex};

use slipline_app::safety::thermal::Heat;
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_protocol::command::{Apply, TravelLimit, TravelSetting};
use slipline_protocol::event::{Event, Fault, State};
use slipline_protocol::hold::{
    Held, HeldTone, HoldLimit, HoldLoss, HoldProgress, HoldSetting, HoldState, HoldTone,
};
use slipline_protocol::limits::HOLD_PAUSE_BLOCKS;
use slipline_protocol::listen::{ListenPart, ListenWindow, Progress, WindowShape};
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::units::CentiDecibel;
use slipline_protocol::{Command, units::SampleIndex};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, MID, Rig, Table, chord, comb, drive};

/// The path of the codes from the pin to the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Touch {
    /// This share is left.
    Part(f64),
    /// Nothing but noise comes in.
    Unplugged,
    Stuck,
    Clipped,
}

#[derive(Clone)]
struct Finger(Arc<Mutex<Touch>>);

impl Finger {
    fn put(&self, touch: Touch) {
        *self.0.lock().unwrap() = touch;
    }
}

impl SimulatedInputs for Finger {
    fn sample(&mut self, codes: &[u16; BLOCK as usize], _: bool, sensed: &mut [[u16; BLOCK as usize]; 2]) {
        let touch = *self.0.lock().unwrap();
        for (number, (code, sensor)) in codes.iter().zip(&mut sensed[0]).enumerate() {
            let swing = 0.5 * (f64::from(*code) - f64::from(MID));
            *sensor = match touch {
                Touch::Part(part) => (f64::from(MID) + part * swing).round() as u16,
                Touch::Unplugged => MID + (number % 2) as u16,
                Touch::Stuck => 1000,
                Touch::Clipped => (f64::from(MID) + 3.0 * swing).clamp(0.0, 4095.0) as u16,
            };
        }
    }
}

const BLOCKS: u16 = 40;
/// From the beginning of one window to that of the next, in blocks.
const PERIOD: u64 = (BLOCKS + HOLD_PAUSE_BLOCKS) as u64;
const OFF: Command = Command::Hold(HoldSetting {
    input: 0,
    time_constant: 0,
    blocks: 0,
    max_rise: CentiDecibel(0),
    slew: CentiDecibel(0),
    tones: heapless::Vec::new(),
});

fn setting(tones: &[(u8, f64)]) -> HoldSetting {
    HoldSetting {
        input: 0,
        time_constant: 0,
        blocks: BLOCKS,
        max_rise: CentiDecibel(2000),
        slew: CentiDecibel(602),
        tones: tones
            .iter()
            .map(|&(slot, codes)| HoldTone { slot, amplitude: (codes * 256.0).round() as u32 })
            .collect(),
    }
}

fn hold(tones: &[(u8, f64)]) -> Command {
    Command::Hold(setting(tones))
}

fn held(rig: &mut Rig) -> Held {
    answer!(rig, Command::HoldRead, Held)
}

/// An armed device with a table of gain 1, and the finger on its plate.
fn touched(options: Options) -> (Rig, Finger) {
    let finger = Finger(Arc::new(Mutex::new(Touch::Part(1.0))));
    let mut rig = Rig::of(SimulatedDevice::with_inputs(options, Box::new(finger.clone())));
    rig.hello();
    rig.upload(&Table::line(65, 60_000.0, 20_000.0, |_| 1.0));
    rig.arm();
    (rig, finger)
}

/// A drive of these slots and levels.
fn sounds(levels: &[(u8, f64)]) -> Command {
    let place = |slot: u8| 0.1 + 0.05 * f64::from(slot);
    Command::Drive(drive(
        &levels.iter().map(|&(slot, level)| (slot, place(slot), level)).collect::<Vec<_>>(),
        2000,
    ))
}

/// The codes at the sensor of a tone of this level, with no finger.
const fn codes(level: f64) -> f64 {
    0.5 * 2047.0 * level
}

/// A device that drives these slots and levels, and holds them.
fn holding(options: Options, levels: &[(u8, f64)]) -> (Rig, Finger) {
    let (mut rig, finger) = touched(options);
    rig.accepted(&sounds(levels));
    rig.live_ms(10);
    rig.accepted(&hold(&levels.iter().map(|&(slot, level)| (slot, codes(level))).collect::<Vec<_>>()));
    (rig, finger)
}

/// Lets periods pass; the sum of all amplitudes never exceeds full scale. Returns the last one.
fn live(rig: &mut Rig, periods: u64) -> u16 {
    let mut sum = 0;
    for _ in 0..periods * 2 {
        rig.live_blocks(PERIOD / 2);
        let status = rig.status();
        assert!(status.sum_per_mille <= 1000 && status.counters.clips == 0, "{status:?}");
        sum = status.sum_per_mille;
    }
    sum
}

fn states(held: &Held) -> Vec<(u8, HoldState)> {
    held.tones.iter().map(|tone| (tone.slot, tone.state)).collect()
}

fn decibels(tone: &HeldTone) -> f64 {
    f64::from(tone.correction.0) / 100.0
}

#[test]
fn a_hold_restores_what_a_finger_takes_and_lowers_it_when_the_finger_leaves() {
    let (mut rig, finger) = touched(Options::default());
    rig.accepted(&sounds(&[(2, 0.1), (5, 0.2), (9, 0.15)]));
    rig.live_ms(10);
    assert_eq!(held(&mut rig), Held::default());
    let before = rig.status().sum_per_mille;
    // Slot 9 is not held.
    let begin = rig.accepted(&hold(&[(2, codes(0.1)), (5, codes(0.2))]));
    let began = held(&mut rig);
    assert_eq!((began.progress, began.begin, began.windows), (HoldProgress::On, begin, 0));
    assert_eq!(states(&began), [(2, HoldState::Settling), (5, HoldState::Settling)]);
    assert!(live(&mut rig, 4).abs_diff(before) <= 1);
    for (part, sum) in [(0.5, 600 + 150), (2.0, 150 + 150), (1.0, 300 + 150)] {
        finger.put(Touch::Part(part));
        let at = live(&mut rig, 12);
        assert!(at.abs_diff(sum) <= 6, "{part}: {at}");
        let report = held(&mut rig);
        assert_eq!(states(&report), [(2, HoldState::Held), (5, HoldState::Held)]);
        for (tone, level) in report.tones.iter().zip([0.1, 0.2]) {
            assert!((decibels(tone) + 20.0 * f64::log10(part)).abs() < 0.1, "{tone:?}");
            let share = f64::from(tone.amplitude) / 256.0 / codes(level);
            assert!((share - 1.0).abs() < 0.01, "{share}");
        }
    }
    // One window after the other.
    let report = held(&mut rig);
    let periods = (report.begin - begin) / BLOCK / PERIOD;
    assert!(
        report.windows == periods as u32 && (report.begin - begin).is_multiple_of(PERIOD * BLOCK),
        "{report:?}"
    );
    // The end brings back the drive.
    finger.put(Touch::Part(0.5));
    live(&mut rig, 8);
    rig.accepted(&OFF);
    assert_eq!(held(&mut rig), Held::default());
    assert_eq!(live(&mut rig, 2), before);
}

#[test]
fn tones_without_headroom_stay_at_the_limit_and_name_it() {
    let travel =
        TravelLimit { resonance_uhz: 2_000_000_000, quality_per_mille: 1000, static_ppm: 900_000_000 };
    let hot = Options { heat: Heat::AssumedHot, ..Options::default() };
    for (limit, options, levels) in [
        (HoldLimit::Headroom, Options::default(), [0.35, 0.25]),
        (HoldLimit::Thermal, hot, [0.2, 0.1]),
        (HoldLimit::Travel, Options::default(), [0.25, 0.15]),
        (HoldLimit::Rise, Options::default(), [0.1, 0.05]),
    ] {
        let (mut rig, finger) = touched(options);
        let is_travel = limit == HoldLimit::Travel;
        if is_travel {
            rig.send(&Command::SetTravelLimit(TravelSetting { limit: Some(travel) }));
        }
        let levels = [(2, levels[0]), (5, levels[1])];
        let answer = rig.send(&sounds(&levels));
        assert!(matches!(answer, Event::Accepted(_)), "{limit:?}: {answer:?}");
        rig.live_ms(20);
        let sum = rig.status().sum_per_mille;
        let rise = if limit == HoldLimit::Rise { 300 } else { 2000 };
        let tones = levels.map(|(slot, level)| (slot, codes(level)));
        let asked = HoldSetting { max_rise: CentiDecibel(rise), ..setting(&tones) };
        if limit != HoldLimit::Thermal {
            rig.accepted(&Command::Hold(asked.clone()));
            live(&mut rig, 3);
        }
        // The fold-back takes a half besides.
        finger.put(Touch::Part(if limit == HoldLimit::Thermal { 0.7 } else { 0.4 }));
        if limit == HoldLimit::Thermal {
            rig.accepted(&Command::Hold(asked));
        }
        let (sum_at, report) = (live(&mut rig, 14), held(&mut rig));
        let at_limit = HoldState::AtLimit(limit);
        assert_eq!(states(&report), [(2, at_limit), (5, at_limit)], "{report:?}");
        let rise = decibels(&report.tones[0]);
        match limit {
            HoldLimit::Headroom => assert!((997..=1000).contains(&sum_at), "{sum_at}"),
            HoldLimit::Thermal => assert_eq!((sum_at, rise), (sum, 0.0)),
            HoldLimit::Rise => assert!((rise - 3.0).abs() < 0.01, "{rise}"),
            // The device refuses whatever goes beyond the travel: with the table of gain 1 it may be so loud.
            _ => {
                let frequency = |slot: f64| 60_000.0 - 40_000.0 * (0.1 + 0.05 * slot);
                let share = |hz: f64| 900.0 / ((hz / 2000.0).powi(2) - 1.0);
                let loudest = levels.map(|(slot, level)| level * share(frequency(f64::from(slot))));
                let allowed = -20.0 * loudest.iter().sum::<f64>().log10();
                assert!(rise > 0.1 && rise <= allowed + 0.02, "{rise} of {allowed}");
            }
        }
    }
}

#[test]
fn a_table_that_ends_a_hold_does_not_let_the_next_one_begin_raised() {
    // four holds of 6 dB at most on one drive, each ended by a table; a fifth asks for less, and gets less.
    let levels = [(2, 0.05), (5, 0.02)];
    let (mut rig, finger) = touched(Options::default());
    rig.accepted(&sounds(&levels));
    rig.live_ms(20);
    finger.put(Touch::Part(0.3));
    let rise = |rig: &mut Rig, (slot, level): (u8, f64), most: i16| {
        let asked = HoldSetting { max_rise: CentiDecibel(most), ..setting(&[(slot, codes(level))]) };
        rig.accepted(&Command::Hold(asked));
        let sum = live(rig, 8);
        let report = held(rig);
        assert_eq!(states(&report), [(slot, HoldState::AtLimit(HoldLimit::Rise))], "{report:?}");
        assert!((decibels(&report.tones[0]) - f64::from(most) / 100.0).abs() < 0.011, "{report:?}");
        sum
    };
    let both = 2.0 * (50.0 + 20.0);
    for (round, tone) in [levels[0], levels[1], levels[0], levels[1]].into_iter().enumerate() {
        let sum = f64::from(rise(&mut rig, tone, 602));
        let most = if round == 0 { 100.0 + 20.0 } else { both };
        assert!((sum - most).abs() <= 2.0, "round {round}: {sum}");
        rig.upload(&Table::line(65, 60_000.0, 20_000.0, |_| 1.0));
        rig.live_ms(60);
        assert_eq!(held(&mut rig).progress, HoldProgress::Ended);
    }
    let sum = f64::from(rise(&mut rig, levels[0], 300));
    assert!((sum - (50.0 * 10_f64.powf(0.15) + 40.0)).abs() <= 2.0, "{sum}");
    // The end brings back the whole drive, of the slot that is not held, too.
    rig.accepted(&OFF);
    assert_eq!(live(&mut rig, 2), 71);
    // A new drive is a new measure.
    rig.accepted(&sounds(&[(2, 0.1)]));
    rig.live_ms(20);
    assert!((f64::from(rise(&mut rig, (2, 0.1), 602)) - 200.0).abs() <= 2.0);
}

#[test]
fn what_cannot_be_held_is_refused_by_its_field() {
    let out = |field, min: i64, max: i64, got: i64| Refusal::OutOfRange { field, min, max, got };
    let (mut rig, _) = touched(Options::default());
    let good = || setting(&[(2, codes(0.1))]);
    let ask = |rig: &mut Rig, setting: HoldSetting| rig.refused(&Command::Hold(setting));
    assert_eq!(ask(&mut rig, good()), Refusal::SilentTone { slot: 2 });
    rig.accepted(&sounds(&[(2, 0.1)]));
    assert_eq!(ask(&mut rig, good()), Refusal::Busy(Busy::CommitPending));
    rig.live_ms(10);
    for (setting, refusal) in [
        (HoldSetting { input: 1, ..good() }, out(Field::Input, 0, 0, 1)),
        (
            HoldSetting { time_constant: 24_000_001, ..good() },
            out(Field::TimeConstant, 0, 24_000_000, 24_000_001),
        ),
        // 5 ms are 2000 samples: 32 blocks less the pause.
        (HoldSetting { blocks: 19, ..good() }, out(Field::WindowBlocks, 20, 62_488, 19)),
        (HoldSetting { blocks: u16::MAX, ..good() }, out(Field::WindowBlocks, 20, 62_488, 65_535)),
        (HoldSetting { max_rise: CentiDecibel(-1), ..good() }, out(Field::MaxRise, 0, 2000, -1)),
        (HoldSetting { max_rise: CentiDecibel(2001), ..good() }, out(Field::MaxRise, 0, 2000, 2001)),
        (HoldSetting { slew: CentiDecibel(0), ..good() }, out(Field::Slew, 1, 6020, 0)),
        (setting(&[(16, 1.0)]), out(Field::ToneSlot, 0, 15, 16)),
        (setting(&[(2, 1.0), (2, 1.0)]), Refusal::SlotTwice { slot: 2 }),
        (setting(&[(3, 1.0)]), Refusal::SilentTone { slot: 3 }),
        (setting(&[(2, 0.05)]), out(Field::HeldAmplitude, 16, 524_032, 13)),
    ] {
        assert_eq!(ask(&mut rig, setting), refusal);
        assert_eq!(held(&mut rig), Held::default());
    }
    rig.accepted(&Command::Disarm);
    assert_eq!(ask(&mut rig, good()), Refusal::NotArmed);
    rig.accepted(&Command::EmergencyStop);
    assert!(matches!(ask(&mut rig, good()), Refusal::Faulted { .. }));
    let mut deaf = Rig::armed();
    for command in [hold(&[(2, 1.0)]), Command::HoldRead, OFF] {
        assert_eq!(deaf.refused(&command), Refusal::NotSupported);
    }
}

/// The limit of the travel makes a drive's glide longer, and so the window.
#[test]
fn a_slow_actuator_is_not_corrected_faster_than_it_can_follow() {
    let (mut rig, _) = touched(Options::default());
    let limit = TravelLimit { resonance_uhz: 50_000_000, quality_per_mille: 1000, static_ppm: 1_000_000 };
    rig.send(&Command::SetTravelLimit(TravelSetting { limit: Some(limit) }));
    rig.play(&[(2, 0.2, 0.1)], 16_000, 50);
    // Two periods of 50 Hz are 16 000 samples.
    let refusal = rig.refused(&hold(&[(2, codes(0.1))]));
    assert_eq!(refusal, Refusal::OutOfRange { field: Field::WindowBlocks, min: 238, max: 62_488, got: 40 });
    rig.accepted(&Command::Hold(HoldSetting { blocks: 238, ..setting(&[(2, codes(0.1))]) }));
}

#[test]
fn a_comb_keeps_its_exact_tones_beyond_the_table_too() {
    let (mut rig, finger) = touched(Options::default());
    // No multiple of the base frequency is one of the table's ends, 20 and 60 kHz.
    let tones: [(u16, f64, f64); 3] = [(3, 0.1, 0.0), (512, 0.1, 0.25), (1220, 0.1, 0.5)];
    rig.accepted(&Command::Comb(comb(39, &tones)));
    rig.live_ms(10);
    rig.accepted(&hold(&[(0, codes(0.1)), (1, codes(0.1)), (2, codes(0.1))]));
    finger.put(Touch::Part(0.5));
    live(&mut rig, 24);
    let report = held(&mut rig);
    assert!(
        report.tones.iter().all(|tone| tone.state == HoldState::Held && (decibels(tone) - 6.02).abs() < 0.1),
        "{report:?}"
    );
    // Nothing is corrected any more where the levels are right to the last bit, or the hold has ended.
    rig.accepted(&OFF);
    rig.live_blocks(PERIOD);
    rig.record();
    rig.live_blocks(78);
    let codes = &rig.recording.codes;
    assert!(codes[..39 * 128] == codes[39 * 128..], "it repeats");
    assert!(codes.iter().any(|&code| code.abs_diff(MID) > 300));
}

#[test]
fn a_chord_that_only_its_proof_allows_is_not_corrected() {
    // Sixteen tones of a low crest factor: their sum is above full scale.
    let (mut rig, finger) = touched(Options::default());
    let tones: Vec<(u16, f64, f64)> =
        (0..16u16).map(|i| (860 + 20 * i, 0.1, -f64::from(i * i) / 32.0)).collect();
    rig.accepted(&Command::Chord(chord(14, &tones)));
    rig.live_ms(20);
    rig.accepted(&hold(&[(3, codes(0.1))]));
    finger.put(Touch::Part(0.5));
    rig.live_blocks(8 * PERIOD);
    let report = held(&mut rig);
    assert_eq!(states(&report), [(3, HoldState::AtLimit(HoldLimit::Headroom))]);
    assert_eq!((report.tones[0].correction.0, rig.status().counters.clips), (0, 0));
}

/// An emergency stop that comes at any block of the hold's work begins as soon as in a device that holds nothing.
#[test]
fn an_emergency_stop_is_as_fast_as_without_a_hold() {
    let delay = |is_holding: bool, blocks: u64, block_waits: bool| -> (SampleIndex, SampleIndex) {
        let options = Options { block_waits, ..Options::default() };
        let (mut rig, finger) = touched(options);
        rig.accepted(&sounds(&[(2, 0.1), (5, 0.2)]));
        rig.live_ms(10);
        let begin = if is_holding {
            rig.accepted(&hold(&[(2, codes(0.1)), (5, codes(0.2))]))
        } else {
            rig.device.now()
        };
        finger.put(Touch::Part(0.5));
        rig.live_blocks((begin - rig.device.now()) / BLOCK + blocks);
        rig.record();
        let now = rig.device.now();
        let at = rig.accepted(&Command::EmergencyStop);
        rig.live_ms(10);
        (at - now, rig.recording.end_of_sound().expect("it has sounded") - now)
    };
    for block_waits in [false, true] {
        let (began, ended) = delay(false, 60, block_waits);
        // Around the end of the first window and the tick after it.
        for blocks in (38..64).chain([200, 201]) {
            let (begins, ends) = delay(true, blocks, block_waits);
            assert_eq!(begins, began, "{blocks} blocks");
            // The last codes of a louder tone are not mid-scale for a little longer.
            assert!(ends.abs_diff(ended) <= 40, "{blocks} blocks: {ends} for {ended}");
        }
    }
}
