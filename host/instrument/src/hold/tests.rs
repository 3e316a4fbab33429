use super::*;
use slipline_plate::preset;

const RATE_HZ: f64 = 400e3;

fn plan(name: &str, tones: &[(u8, f64)]) -> Result<HoldPlan, HoldError> {
    HoldPlan::new(&preset(name).unwrap(), tones, RATE_HZ, 16, 12.0)
}

fn heard(answers: &[(usize, f64)]) -> Listened {
    let mut listened =
        Listened { begin: 0, blocks: 300, answers: [None; MAX_TONES], lowest: 900, highest: 3000 };
    for &(slot, codes) in answers {
        listened.answers[slot] = Some((0.6 * codes, 0.8 * codes));
    }
    listened
}

#[test]
fn the_window_has_two_periods_and_separates_the_nearest_tones() {
    // 24 pauses of 12 blocks.
    let short = plan("al-bending", &[(0, 21e3), (3, 25e3)]).unwrap();
    assert_eq!((short.blocks, short.listen(None).slots), (288, 0b1001));
    // 2 / (loss factor * angular frequency) of the lowest tone.
    assert!((short.time_constant_s - 2.0 / (0.002 * TAU * 21e3)).abs() < 1e-9);
    assert!((short.recovery_s() - 5.0 * 288.0 * 128.0 / RATE_HZ).abs() < 1e-9);
    let low = plan("membrane", &[(0, 10.0)]).unwrap();
    assert_eq!(low.blocks, (0.2 * RATE_HZ / 128.0) as u16);
    let close = plan("membrane", &[(0, 100.0), (1, 104.0)]).unwrap();
    assert_eq!(close.blocks, (0.5_f64 * RATE_HZ / 128.0).ceil() as u16);
    // Two bins between two tones: a window of 0.5 s, five times.
    assert!((close.recovery_s() - 2.5).abs() < 1e-3);
    // The first window waits for the plate: six time constants.
    let from = close.listen(Some(1000)).from.unwrap();
    assert_eq!(from, 1000 + (6.0 * close.time_constant_s * RATE_HZ).ceil() as u64);
}

#[test]
fn what_cannot_be_held_is_refused_with_its_reason() {
    let plate = preset("membrane").unwrap();
    let refused =
        |tones: &[(u8, f64)], lock_ins| HoldPlan::new(&plate, tones, RATE_HZ, lock_ins, 12.0).unwrap_err();
    assert_eq!(refused(&[(0, 100.0)], 0), HoldError::NoInputs);
    assert_eq!(refused(&[], 16), HoldError::NoTones);
    assert_eq!(refused(&[(0, 100.0), (1, 120.0)], 1), HoldError::TooMany { tones: 2, lock_ins: 1 });
    assert!(matches!(refused(&[(0, 0.3)], 16), HoldError::TooLow { .. }));
    assert!(matches!(refused(&[(0, 100.0), (1, 100.1)], 16), HoldError::TooClose { .. }));
    assert!(matches!(refused(&[(0, 100.0), (1, 100.0)], 16), HoldError::TooClose { .. }));
    let plan = plan("membrane", &[(2, 100.0), (5, 150.0)]).unwrap();
    let stuck = Listened { lowest: 7, highest: 7, ..heard(&[(2, 100.0), (5, 50.0)]) };
    assert_eq!(plan.hold(&stuck), Err(HoldError::Stuck));
    let clipped = Listened { highest: 4095, ..heard(&[(2, 100.0), (5, 50.0)]) };
    assert_eq!(plan.hold(&clipped), Err(HoldError::Clipped));
    assert_eq!(plan.hold(&heard(&[(2, 100.0)])), Err(HoldError::NotFollowed { slot: 5 }));
    let weak = plan.hold(&heard(&[(2, 0.5), (5, 50.0)])).unwrap_err();
    assert!(
        weak.to_string().contains("only 0.50 codes of the tone in slot 2; at least 1 are needed"),
        "{weak}"
    );
}

#[test]
fn the_measured_levels_are_held() {
    let plan = plan("membrane", &[(2, 100.0), (5, 150.0)]).unwrap();
    let request = plan.hold(&heard(&[(2, 100.0), (5, 50.0)])).unwrap();
    let held: Vec<(u8, f64)> = request.tones.iter().map(|tone| (tone.slot, tone.amplitude_codes)).collect();
    assert_eq!(held, [(2, 100.0), (5, 50.0)]);
    assert_eq!((request.blocks, request.max_rise_db), (plan.blocks, 12.0));
}

#[test]
fn the_worst_of_several_tones_is_reported() {
    use slipline_link::protocol::hold::{Held, HeldTone};
    use slipline_link::protocol::units::CentiDecibel;
    use slipline_link::{HoldLimit, HoldLoss, HoldState};
    let states = [
        HoldState::Held,
        HoldState::Settling,
        HoldState::AtLimit(HoldLimit::Headroom),
        HoldState::Lost(HoldLoss::Stuck),
    ];
    let message: Vec<String> = (1..=4)
        .map(|count| {
            // The worst is neither the first nor the last.
            let held = [HoldState::Held];
            let tones = held.iter().chain(states[..count].iter().rev()).chain(&held).zip(0..);
            let tone = |(&state, slot)| HeldTone { slot, state, correction: CentiDecibel(0), amplitude: 0 };
            let held = Held { tones: tones.map(tone).collect(), ..Held::default() };
            Standing::Holding(Some(&held)).to_string()
        })
        .collect();
    let wanted = [
        "Holding: the plate may be touched",
        "Holding, on the way",
        "Holding, at a limit",
        "Holding, but not every tone",
    ];
    assert_eq!(message, wanted);
}
