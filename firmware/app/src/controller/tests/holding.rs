//! The level hold with interrupts of the renderer at any moment, stops, and inputs that fail. Each test sets the readings.

use slipline_dds::bank::TONES;
use slipline_dds::lock_in::{BASIS_ONE, InPhaseQuadrature, Reading, Span, State as LockInState};
use slipline_protocol::hold::{Held, HoldLoss, HoldProgress, HoldSetting, HoldState, HoldTone};

use super::*;
use crate::mailbox::Inputs;
use crate::ports::INPUTS;

/// More locks than a turn of the hold takes.
const LOCKS: u32 = 80;
/// The amplitude to hold, in 1/256 code.
const SET: u32 = 1000 << 8;
const BLOCKS: u16 = 4;
/// The ramp of an emergency stop, 16 samples, ends in the block in which it begins.
const RAMP_BLOCKS: u64 = 1;

/// A device that holds two tones of a quarter of full scale each.
fn holding() -> Rig {
    let mut rig = Rig::armed();
    rig.mailbox.set_inputs(Inputs { count: 1, lock_ins: TONES, delay_ns: 0, lost_blocks: 0 });
    let tone = |slot| Tone { slot, position: Position(0), level: Level(u16::MAX / 4), phase: Phase(0) };
    let tones = [tone(0), tone(3)].into_iter().collect();
    let drive = Drive { tones, master: CentiDecibel(0), glide: 200, apply: Apply::Next };
    rig.accepted(&Command::Drive(drive));
    rig.render(8);
    let tone = |slot| HoldTone { slot, amplitude: SET };
    rig.accepted(&Command::Hold(HoldSetting {
        input: 0,
        time_constant: 0,
        blocks: BLOCKS,
        max_rise: CentiDecibel(1200),
        slew: CentiDecibel(602),
        tones: [tone(0), tone(3)].into_iter().collect(),
    }));
    rig
}

/// The inputs have measured this share of what is to be held.
fn measured(rig: &Rig, share: f64) {
    rig.mailbox.take_listen_orders();
    let weight = 1 << 15;
    // The amplitude's equation, solved for the sum.
    let sum = (f64::from(SET) * share * f64::from(BASIS_ONE) * f64::from(weight) / 8.0) as i64;
    let answer = InPhaseQuadrature { in_phase: sum, quadrature: 0 };
    let nothing = [InPhaseQuadrature::default(); TONES];
    let reading = Reading {
        sums: core::array::from_fn(|input| if input == 0 { [answer; TONES] } else { nothing }),
        constant: nothing,
        codes: [0; INPUTS],
        weight,
        blocks: BLOCKS,
        followed: u16::MAX,
        spans: core::array::from_fn(|input| (input == 0).then_some(Span { lowest: 1000, highest: 3000 })),
    };
    rig.mailbox.set_reading(LockInState::Finished, rig.mailbox.measurement().begin, &reading);
}

fn tick(rig: &mut Rig) {
    rig.controller.tick(&mut || false, &rig.mailbox);
}

fn read_hold(rig: &mut Rig) -> Held {
    match rig.execute(&Command::HoldRead) {
        Ok(Event::Held(held)) => held,
        other => panic!("{other:?}"),
    }
}

/// The sum of the amplitudes, of full scale.
fn sum(rig: &Rig) -> f64 {
    rig.mailbox.view().report.sum as f64 / f64::from(Gain::FULL.0)
}

#[test]
fn a_window_that_is_over_is_taken_by_the_next_tick_and_its_levels_glide() {
    let mut rig = holding();
    let before = sum(&rig);
    measured(&rig, 0.8);
    tick(&mut rig);
    rig.render(30);
    let rise = 20.0 * (sum(&rig) / before).log10();
    // Two fifths of the 1.9 dB that are missing.
    assert!((rise - 0.4 * 1.94).abs() < 0.02, "{rise} dB");
    assert_eq!(read_hold(&mut rig).windows, 1);
    // The next one is under way.
    tick(&mut rig);
    assert_eq!(read_hold(&mut rig).windows, 1);
}

#[test]
fn what_a_hold_publishes_is_no_act_of_the_user() {
    //
    let mut rig = holding();
    let max_drive = rig.controller.timing().max_drive;
    let began = rig.mailbox.now();
    let mut shares = [0.8, 1.2].into_iter().cycle();
    while rig.faults().is_empty() {
        measured(&rig, shares.next().unwrap_or(1.0));
        tick(&mut rig);
        rig.render(16);
        assert!(rig.mailbox.now() - began < max_drive + 100 * BLOCK as u64);
    }
    assert_eq!(rig.faults(), Faults::NONE.with(Fault::DriveTime));
    assert!(rig.mailbox.now() - began > max_drive - 100 * BLOCK as u64);
    assert_eq!(read_hold(&mut rig).progress, HoldProgress::Ended);
}

#[test]
fn a_drive_takes_the_place_of_levels_that_have_not_begun() {
    //
    let mut rig = holding();
    measured(&rig, 0.8);
    tick(&mut rig);
    let pending = rig.mailbox.view().pending;
    assert!(pending.is_some_and(|levels| levels.yields));
    // One that is refused changes nothing.
    let too_loud = Command::Drive(Drive {
        tones: Default::default(),
        master: CentiDecibel(1),
        glide: 200,
        apply: Apply::Next,
    });
    assert!(rig.execute(&too_loud).is_err());
    assert_eq!((rig.mailbox.view().pending, read_hold(&mut rig).progress), (pending, HoldProgress::On));
    rig.accepted(&full_scale(Apply::Next));
    assert_eq!(read_hold(&mut rig).progress, HoldProgress::Ended);
    rig.render(30);
    assert!((sum(&rig) - 1.0).abs() < 1e-3, "{}", sum(&rig));
    // Nothing may replace it: another one must wait.
    rig.accepted(&full_scale(Apply::At(rig.mailbox.now() + 4096)));
    assert_eq!(rig.execute(&full_scale(Apply::Next)), Err(Refusal::Busy(Busy::CommitPending)));
}

#[test]
fn a_stop_that_comes_while_levels_are_planned_keeps_them_from_starting() {
    //
    for look in 0.. {
        let mut rig = holding();
        measured(&rig, 0.5);
        let mailbox = Rc::clone(&rig.mailbox);
        let looks = Cell::new(0);
        rig.controller.tick(&mut stop_after(look, &looks, Stop::Emergency, &mailbox), &mailbox);
        let looks = looks.get();
        if looks == look {
            assert!(looks >= TONES as u32 + 6, "{looks} looks at sixteen answers and tones");
            assert!(mailbox.view().pending.is_some());
            break;
        }
        assert!(mailbox.view().pending.is_none(), "at look {look}");
        rig.render(RAMP_BLOCKS);
        assert!(!rig.render(100), "at look {look}");
        tick(&mut rig);
        assert_eq!(read_hold(&mut rig).progress, HoldProgress::Ended);
    }
}

#[test]
fn an_emergency_stop_between_any_two_steps_of_a_turn_is_as_quick_as_without_a_hold() {
    //
    let mut interrupted = 0;
    for locks in 0..LOCKS {
        let mut rig = holding();
        measured(&rig, 0.5);
        let mailbox = Rc::clone(&rig.mailbox);
        INTERRUPT.set(Some((
            locks,
            Box::new(move || {
                mailbox.fault(Fault::EmergencyStop, Stop::Emergency);
            }),
        )));
        tick(&mut rig);
        if INTERRUPT.take().is_some() {
            rig.mailbox.fault(Fault::EmergencyStop, Stop::Emergency);
        } else {
            interrupted += 1;
        }
        rig.render(RAMP_BLOCKS);
        assert!(!rig.render(100), "before lock {locks}");
        assert!(rig.renderer.borrow().is_muted());
        tick(&mut rig);
        assert_eq!(read_hold(&mut rig).progress, HoldProgress::Ended, "before lock {locks}");
    }
    assert!(interrupted > 20 && interrupted < LOCKS, "{interrupted}");
}

#[test]
fn blocks_between_any_two_steps_of_a_turn_leave_a_hold_that_is_right_or_over() {
    // Three blocks are rendered, the last ones before the dead man acts, or the host is lost in them.
    for (locks, is_lost) in (0..LOCKS).flat_map(|locks| [(locks, false), (locks, true)]) {
        let mut rig = holding();
        if is_lost {
            // Up to the last block in which the device is armed.
            for _ in 0..rig.controller.timing().dead_man / BLOCK as u64 {
                render(&rig.renderer, &rig.mailbox);
            }
            assert!(rig.mailbox.view().armed);
        }
        measured(&rig, 0.5);
        let (renderer, mailbox) = (rig.renderer.clone(), rig.mailbox.clone());
        let blocks = move || {
            for _ in 0..3 {
                render(&renderer, &mailbox);
            }
        };
        INTERRUPT.set(Some((locks, Box::new(blocks))));
        tick(&mut rig);
        let came = INTERRUPT.take().is_none();
        if is_lost {
            for _ in 0..8 {
                render(&rig.renderer, &rig.mailbox);
            }
            assert!(!rig.render(100), "before lock {locks}");
            tick(&mut rig);
            assert_eq!(read_hold(&mut rig).progress, HoldProgress::Ended, "before lock {locks}");
        } else {
            for _ in 0..12 {
                rig.render(16);
                measured(&rig, 1.0);
                tick(&mut rig);
            }
            let hold = read_hold(&mut rig);
            assert_eq!(hold.progress, HoldProgress::On, "before lock {locks}, {came}");
            // The correction that the hold reports is in force.
            let level = 10_f64.powf(f64::from(hold.tones[0].correction.0) / 2000.0) * 0.25;
            rig.render(40);
            assert!((sum(&rig) / 2.0 / level - 1.0).abs() < 1e-3, "before lock {locks}: {}", sum(&rig));
        }
    }
}

#[test]
fn inputs_that_stop_are_noticed() {
    //
    let mut rig = holding();
    measured(&rig, 0.5);
    tick(&mut rig);
    rig.render(30);
    assert!(sum(&rig) > 0.6);
    for _ in 0..8 {
        rig.render(16);
        tick(&mut rig);
    }
    let hold = read_hold(&mut rig);
    assert_eq!(hold.progress, HoldProgress::Lost);
    assert_eq!(hold.tones[0].state, HoldState::Lost(HoldLoss::Broken));
    assert!((sum(&rig) - 0.5).abs() < 1e-3, "{}", sum(&rig));
}
