//! The level hold: what it measures, what it proposes, and how it gives up.
extern crate std;

mod plant;
mod stability;

use super::*;
use crate::ports::INPUTS;
use core::f64::consts::TAU;
use slipline_dds::bank::{BLOCK, ToneBlock};
use slipline_dds::lock_in::{History, LockIn, Shape, Span, Window};

/// 10 ms at 400 kS/s, the shortest period.
const PERIOD: u32 = 4000;
const MIN_GLIDE: u32 = 2000;
const SET_CODES: f64 = 200.0;
const ROOMY: Room = Room { rise: Octaves::MAX, limit: Limit::Headroom };
const SPAN: Span = Span { lowest: 1000, highest: 3000 };

fn setting(tau: u32) -> LoopSetting {
    LoopSetting { period: PERIOD, tau, max_rise: Octaves(4 << 16), at_rise: u32::MAX, slew: Octaves::ONE }
}

/// A hundredth of full scale.
fn tone(slot: u8) -> ToneToHold {
    let level = Gain(Gain::FULL.0 / 100);
    ToneToHold { slot, amplitude: (SET_CODES * 256.0) as u32, level, sounding: level }
}

fn hold(slots: &[u8]) -> Hold {
    let tones: std::vec::Vec<_> = slots.iter().map(|slot| tone(*slot)).collect();
    Hold::new(&setting(0), &tones, MIN_GLIDE).expect("it can be held")
}

/// Answers of slots, in parts of the set amplitude.
fn answers(parts: &[(usize, f64)]) -> Answers {
    let mut amplitudes = [None; TONES];
    for (slot, part) in parts {
        amplitudes[*slot] = Some((part * SET_CODES * 256.0) as u32);
    }
    Answers { span: SPAN, amplitudes }
}

/// Takes a window; what is to be published is accepted. Returns the levels in parts of the table's.
fn take(hold: &mut Hold, answers: Option<&Answers>, room: Room) -> [f64; TONES] {
    if let HoldAction::Publish(_) = hold.take(answers, room) {
        hold.accepted();
    }
    core::array::from_fn(|slot| (f64::from(hold.correction(slot).unwrap_or_default().0) / 65_536.0).exp2())
}

fn parts(step: HoldAction, slots: [usize; 2]) -> [f64; 2] {
    let HoldAction::Publish(levels) = step else { panic!("something is to be published") };
    slots.map(|slot| f64::from(levels[slot].expect("held").0) / f64::from(Gain::FULL.0 / 100))
}

#[test]
fn an_amplitude_matches_the_lock_ins_measurement() {
    const STEP: u64 = 0x0123_4567_89AB_CDEF;
    for codes in [40.5, 333.0, 1500.0] {
        let (mut lock_in, mut history) = (LockIn::<INPUTS>::new(), History::new());
        lock_in
            .start(Window { begin: 0, blocks: 31, shape: Shape::Hann, slots: 1 << 5, input: None }, 0)
            .expect("it can be measured");
        for index in (0..31 * BLOCK as u64).step_by(BLOCK) {
            let mut phases = [0; TONES];
            phases[5] = STEP.wrapping_mul(index);
            let mut tones = [ToneBlock::steady(0, 0); TONES];
            tones[5] = ToneBlock::steady(STEP, 1 << 20);
            history.record(index, &phases, &tones);
            let input: [u16; BLOCK] = core::array::from_fn(|n| {
                let turns = STEP.wrapping_mul(index + n as u64) as f64 / 2_f64.powi(64) + 0.3;
                (2060.0 + codes * (TAU * turns).sin()).round() as u16
            });
            lock_in.take_block(index, &[input], history.at(index));
        }
        let answers = Answers::of(lock_in.reading(), 0).expect("there is an input");
        let got = f64::from(answers.amplitudes[5].expect("followed")) / 256.0;
        // Whole codes without noise give an amplitude to a tenth of a code.
        assert!((got - codes).abs() < 0.1, "{codes}: {got}");
        assert!(answers.amplitudes.iter().filter(|amplitude| amplitude.is_some()).count() == 1);
        assert_eq!(Answers::of(lock_in.reading(), 1), None);
    }
    let longest = slipline_dds::lock_in::InPhaseQuadrature { in_phase: i64::MIN, quadrature: i64::MIN };
    assert_eq!((amplitude(longest, 1), amplitude(longest, 0)), (Some(u32::MAX), None));
}

#[test]
fn a_tone_that_is_right_is_left_alone() {
    let mut hold = hold(&[0, 15]);
    assert_eq!(hold.take(Some(&answers(&[(0, 1.0), (15, 1.0)])), ROOMY), HoldAction::Keep);
    assert_eq!(
        (hold.state(0), hold.state(15), hold.state(1)),
        (Some(LoopState::Held), Some(LoopState::Held), None)
    );
    assert_eq!((hold.correction(1), hold.glide()), (None, PERIOD / 2));
}

#[test]
fn a_bad_reading_loses_every_tone_and_an_interrupted_slot_only_itself() {
    let clipped = |span| Answers { span, ..answers(&[(1, 1.0), (2, 1.0)]) };
    let cases = [
        (None, Loss::Broken),
        (Some(clipped(Span { lowest: 0, highest: 3000 })), Loss::Clipped),
        (Some(clipped(Span { lowest: 1000, highest: 4095 })), Loss::Clipped),
        (Some(clipped(Span { lowest: 0, highest: 0 })), Loss::Stuck),
        (Some(clipped(Span { lowest: 2048, highest: 2048 })), Loss::Stuck),
    ];
    for (case, loss) in cases {
        let mut hold = hold(&[1, 2]);
        for _ in 0..4 {
            take(&mut hold, Some(&answers(&[(1, 0.8), (2, 1.2)])), ROOMY);
        }
        assert!(!hold.is_over());
        let step = hold.take(case.as_ref(), ROOMY);
        assert_eq!(parts(step, [1, 2]), [1.0, 1.0], "{loss:?}");
        hold.accepted();
        assert_eq!([hold.state(1), hold.state(2)], [Some(LoopState::Lost(loss)); 2]);
        assert!(hold.is_over());
        // For good.
        assert_eq!(hold.take(Some(&answers(&[(1, 0.8), (2, 1.2)])), ROOMY), HoldAction::Keep);
    }
    let mut hold = hold(&[1, 2]);
    take(&mut hold, Some(&answers(&[(1, 0.8), (2, 0.8)])), ROOMY);
    let parts = take(&mut hold, Some(&answers(&[(2, 0.8)])), ROOMY);
    assert_eq!((hold.state(1), parts[1]), (Some(LoopState::Lost(Loss::NotFollowed)), 1.0));
    assert!(parts[2] > 1.1 && hold.state(2) == Some(LoopState::Settling));
}

#[test]
fn an_unplugged_sensor_does_not_raise_the_level() {
    for tau in [0, 10 * PERIOD] {
        let mut hold = Hold::new(&setting(tau), &[tone(7)], MIN_GLIDE).expect("it can be held");
        let (mut level, mut part) = (1.0, 0.5);
        for _ in 0..150 {
            part += (0.5 * level - part) / f64::from(tau / PERIOD + 1);
            level = take(&mut hold, Some(&answers(&[(7, part)])), ROOMY)[7];
        }
        assert!((level - 2.0).abs() < 0.05 && hold.state(7) == Some(LoopState::Held), "{tau}: {level}");
        // What is left is noise. The correction may rise by four octaves, three more than it has.
        let patience = tau / PERIOD + 3;
        for window in 0..patience {
            let now = take(&mut hold, Some(&answers(&[(7, 0.01)])), ROOMY)[7];
            assert!(now <= level, "{window}: {now}");
            assert_eq!(hold.state(7), Some(LoopState::Settling));
        }
        assert_eq!(take(&mut hold, Some(&answers(&[(7, 0.01)])), ROOMY)[7], 1.0);
        assert_eq!(hold.state(7), Some(LoopState::Lost(Loss::TooWeak)));
    }
}

#[test]
fn a_refusal_keeps_the_levels_lets_falling_ones_fall_and_is_not_repeated_at_once() {
    let mut hold = hold(&[3, 4]);
    let measured = answers(&[(3, 0.5), (4, 2.0)]);
    let wanted = parts(hold.take(Some(&measured), ROOMY), [3, 4]);
    assert!(wanted[0] > 1.2 && wanted[1] < 0.8, "{wanted:?}");
    let rest = parts(hold.refused(Limit::Travel), [3, 4]);
    assert_eq!(rest, [1.0, wanted[1]]);
    assert_eq!(hold.state(3), Some(LoopState::AtLimit(Limit::Travel)));
    hold.accepted();
    for window in 1..tone::RETRY_WINDOWS {
        assert_eq!(take(&mut hold, Some(&measured), ROOMY)[3], 1.0, "{window}");
        assert_eq!(hold.state(3), Some(LoopState::AtLimit(Limit::Travel)), "{window}");
    }
    // The rise is proposed again, and the integral has not wound up meanwhile.
    let again = parts(hold.take(Some(&measured), ROOMY), [3, 4])[0];
    assert_eq!(again, wanted[0]);
    hold.refused(Limit::Travel);
    // A tone that needs to rise no more is free at once.
    let fallen = take(&mut hold, Some(&answers(&[(3, 1.1), (4, 1.0)])), ROOMY)[3];
    assert!(take(&mut hold, Some(&answers(&[(3, 0.9), (4, 1.0)])), ROOMY)[3] > fallen + 0.01);
    assert_eq!(hold.state(3), Some(LoopState::Held));
}

#[test]
fn a_refusal_of_falling_levels_changes_nothing() {
    let mut hold = hold(&[3]);
    assert!(matches!(hold.take(Some(&answers(&[(3, 2.0)])), ROOMY), HoldAction::Publish(_)));
    assert_eq!(hold.refused(Limit::Headroom), HoldAction::Keep);
    assert_eq!(hold.correction(3), Some(Octaves::NONE));
    // Nor does a proposal that nobody answers.
    let first = hold.take(Some(&answers(&[(3, 2.0)])), ROOMY);
    assert_eq!(hold.take(Some(&answers(&[(3, 2.0)])), ROOMY), first);
}

#[test]
fn nothing_rises_without_room_and_every_limit_is_named() {
    let no_room = Room { rise: Octaves::NONE, limit: Limit::Thermal };
    let mut hold = hold(&[0]);
    for _ in 0..30 {
        assert_eq!(take(&mut hold, Some(&answers(&[(0, 0.5)])), no_room)[0], 1.0);
        assert_eq!(hold.state(0), Some(LoopState::AtLimit(Limit::Thermal)));
    }
    // No integral has been wound up meanwhile.
    let parts = take(&mut hold, Some(&answers(&[(0, 1.0)])), ROOMY);
    assert!((parts[0] - 1.0).abs() < 1e-3, "{parts:?}");

    let level = Gain(Gain::FULL.0 / 2);
    let loud = ToneToHold { level, sounding: level, ..tone(9) };
    let gentle = LoopSetting { max_rise: Octaves(1 << 15), ..setting(0) };
    for (setting, ends, limit) in [(setting(0), 2.0, Limit::Level), (gentle, 2_f64.sqrt(), Limit::Rise)] {
        let mut hold = Hold::new(&setting, &[loud], MIN_GLIDE).expect("it can be held");
        let mut level = 1.0;
        for _ in 0..20 {
            level = take(&mut hold, Some(&answers(&[(9, 0.3)])), ROOMY)[9];
        }
        assert!((level - ends).abs() < 1e-4 && level <= ends, "{level}");
        assert_eq!(hold.state(9), Some(LoopState::AtLimit(limit)));
    }
}

#[test]
fn a_tone_that_stays_at_its_largest_rise_is_lost() {
    // the sensor slips, a tenth of its answer at a time.
    let at_rise = 10 * PERIOD;
    let setting = LoopSetting { max_rise: Octaves(2 << 16), at_rise, ..setting(0) };
    let mut hold = Hold::new(&setting, &[tone(7)], MIN_GLIDE).expect("it can be held");
    let (mut level, mut answer, mut stood) = (1.0, 1.0, 0);
    while hold.state(7) != Some(LoopState::Lost(Loss::AtRise)) {
        assert!(level <= 4.0 && stood <= at_rise / PERIOD, "{level} for {stood} windows");
        if answer > 0.2 {
            answer *= 0.9;
        }
        level = take(&mut hold, Some(&answers(&[(7, answer * level)])), ROOMY)[7];
        if hold.state(7) == Some(LoopState::AtLimit(Limit::Rise)) {
            stood += 1;
        }
    }
    assert_eq!((level, stood), (1.0, at_rise / PERIOD));
    // A finger that leaves in time is none.
    let mut hold = Hold::new(&setting, &[tone(7)], MIN_GLIDE).expect("it can be held");
    let mut level = 1.0;
    for window in 0..100 {
        let answer = if window % 12 < 6 { 0.2 } else { 0.5 };
        level = take(&mut hold, Some(&answers(&[(7, answer * level)])), ROOMY)[7];
    }
    assert!(!hold.is_over());
}

#[test]
fn a_tone_at_the_floor_reports_that_limit() {
    let mut hold = hold(&[0]);
    for _ in 0..40 {
        take(&mut hold, Some(&answers(&[(0, 4.0)])), ROOMY);
    }
    assert_eq!(hold.state(0), Some(LoopState::AtLimit(Limit::Fall)));
    assert_eq!(hold.correction(0), Some(Octaves(-Octaves::MAX.0)));
}

#[test]
fn the_room_in_the_headroom_fills_full_scale_and_no_more() {
    let full = 1_u64 << 31;
    for held in [1_u64, 1000, 123_456_789, full - 50, full, 4 * full] {
        for others in [0, 77, full / 3, full - 1, full, 3 * full] {
            let room = Room::in_headroom(held, others);
            let raised = held as f64 * (f64::from(room.rise.0) / 65_536.0).exp2();
            let left = full.saturating_sub(others).max(held) as f64;
            assert!(raised <= left && raised > left * 0.9999, "{held} {others}: {raised}");
        }
    }
}

#[test]
fn a_setting_out_of_range_is_refused_by_its_field() {
    let good = setting(0);
    let refused = |setting: LoopSetting, tones: &[ToneToHold]| Hold::new(&setting, tones, MIN_GLIDE).err();
    assert_eq!(refused(good, &[tone(0)]), None);
    let shortest = 2 * MIN_GLIDE;
    assert_eq!(refused(LoopSetting { period: 3999, ..good }, &[]), Some(SettingError::Period { shortest }));
    for max_rise in [Octaves(-1), Octaves(Octaves::MAX.0 + 1)] {
        assert_eq!(refused(LoopSetting { max_rise, ..good }, &[]), Some(SettingError::MaxRise));
    }
    for slew in [Octaves::NONE, Octaves(Octaves::MAX.0 + 1)] {
        assert_eq!(refused(LoopSetting { slew, ..good }, &[]), Some(SettingError::Slew));
    }
    assert_eq!(refused(good, &[tone(16)]), Some(SettingError::Slot { slot: 16 }));
    assert_eq!(refused(good, &[tone(2), tone(2)]), Some(SettingError::SlotTwice { slot: 2 }));
    for amplitude in [MIN_AMPLITUDE - 1, MAX_AMPLITUDE + 1] {
        let tone = ToneToHold { amplitude, ..tone(2) };
        assert_eq!(refused(good, &[tone]), Some(SettingError::Amplitude { slot: 2, amplitude }));
    }
    for level in [Gain(0), Gain(Gain::FULL.0 + 1)] {
        assert_eq!(refused(good, &[ToneToHold { level, ..tone(2) }]), Some(SettingError::Level { slot: 2 }));
    }
}
