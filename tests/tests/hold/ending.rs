//! What ends a hold, and what the tones do then.

use super::*;

#[test]
fn an_answer_that_cannot_be_trusted_ends_in_the_levels_of_the_drive() {
    for (loss, touch) in [
        (HoldLoss::TooWeak, Touch::Unplugged),
        (HoldLoss::Stuck, Touch::Stuck),
        (HoldLoss::Clipped, Touch::Clipped),
        (HoldLoss::Broken, Touch::Part(0.7)),
    ] {
        let (mut rig, finger) = holding(Options::default(), &[(2, 0.3), (5, 0.2)]);
        finger.put(Touch::Part(0.7));
        let raised = live(&mut rig, 10);
        assert!((705..=720).contains(&raised), "{raised}");
        finger.put(touch);
        if loss == HoldLoss::Broken {
            rig.device.inject_overrun(1);
        }
        for _ in 0..10 {
            // It never rises meanwhile.
            assert!(live(&mut rig, 1) <= raised + 2, "{loss:?}");
        }
        let report = held(&mut rig);
        assert_eq!(report.progress, HoldProgress::Lost, "{loss:?}: {report:?}");
        let lost = HoldState::Lost(loss);
        assert_eq!(states(&report), [(2, lost), (5, lost)]);
        assert_eq!(report.tones.iter().map(|tone| tone.correction.0).collect::<Vec<_>>(), [0, 0]);
        assert_eq!(rig.status().sum_per_mille, 501, "{loss:?}");
        // The lock-ins are free again, and so is the way for another hold.
        finger.put(Touch::Part(1.0));
        rig.accepted(&Command::Listen(window()));
        rig.accepted(&hold(&[(2, codes(0.3))]));
        live(&mut rig, 4);
        assert_eq!(states(&held(&mut rig)), [(2, HoldState::Held)]);
    }
}

#[test]
fn a_sensor_that_slips_is_given_up_at_the_largest_rise() {
    // its answer falls in steps. To 3 %: too weak at once; to 10 %: the tones stay at the largest rise for 10 s.
    for (lowest, loss) in [(0.03, HoldLoss::TooWeak), (0.1, HoldLoss::AtRise)] {
        let tones = [(2, codes(0.05)), (5, codes(0.02))];
        let (mut rig, finger) = touched(Options::default());
        rig.accepted(&sounds(&[(2, 0.05), (5, 0.02)]));
        rig.live_ms(20);
        rig.accepted(&Command::Hold(HoldSetting { max_rise: CentiDecibel(1200), ..setting(&tones) }));
        live(&mut rig, 3);
        // Four times the levels are 12 dB.
        let (mut step, mut at_rise) = (0, 0);
        while held(&mut rig).progress == HoldProgress::On {
            step += 1;
            finger.put(Touch::Part(f64::max(lowest, 0.85_f64.powi(step))));
            assert!(live(&mut rig, 12) <= 4 * 71, "{lowest}");
            at_rise += u64::from(held(&mut rig).tones[0].state == HoldState::AtLimit(HoldLimit::Rise));
        }
        let lost = HoldState::Lost(loss);
        assert_eq!(states(&held(&mut rig)), [(2, lost), (5, lost)]);
        assert_eq!(live(&mut rig, 4), 71);
        let seconds = (at_rise * 12 * PERIOD * BLOCK) as f64 / 400_000.0;
        assert!(loss == HoldLoss::TooWeak || (seconds - 10.0).abs() < 0.25, "{seconds}");
    }
}

fn window() -> ListenWindow {
    ListenWindow { from: None, blocks: 4, shape: WindowShape::Hann, slots: 1, input: Some(0) }
}

#[test]
fn any_change_of_the_tones_ends_the_hold_and_the_codes_match_a_device_without_one() {
    let levels = [(2, 0.1), (5, 0.2)];
    let other = || sounds(&[(2, 0.3), (7, 0.1)]);
    let later = Command::Drive(slipline_protocol::command::Drive {
        apply: Apply::At(2_000_000),
        ..drive(&[(2, 0.2, 0.3)], 2000)
    });
    for command in [
        other(),
        later,
        Command::Stop,
        Command::EmergencyStop,
        Command::Disarm,
        Command::Drive(drive(&[], 2000)),
    ] {
        let (mut rig, finger) = holding(Options::default(), &levels);
        finger.put(Touch::Part(0.5));
        live(&mut rig, 10);
        rig.accepted(&command);
        let report = held(&mut rig);
        assert_eq!(report.progress, HoldProgress::Ended, "{command:?}");
        assert_eq!(report.tones.len(), 2);
        finger.put(Touch::Part(0.1));
        let windows = report.windows;
        rig.live_blocks(3 * PERIOD);
        assert_eq!(held(&mut rig).windows, windows, "{command:?}");
        rig.accepted(&Command::Listen(window()));
        match command {
            Command::Drive(ref drive) if drive.tones.len() == 2 => {
                assert_eq!(rig.status().sum_per_mille, 401);
            }
            Command::Drive(ref drive) if drive.tones.len() == 1 => {
                assert!(rig.status().sum_per_mille.abs_diff(600) <= 4, "as it stood");
            }
            _ => assert_eq!(rig.status().sum_per_mille, 0, "{command:?}"),
        }
    }
}

#[test]
fn a_table_a_lost_host_a_fault_and_a_new_session_end_the_hold() {
    let levels = [(2, 0.1), (5, 0.2)];
    let (mut rig, _) = holding(Options::default(), &levels);
    rig.upload(&Table::line(65, 60_000.0, 20_000.0, |_| 0.5));
    assert_eq!(held(&mut rig).progress, HoldProgress::Ended);

    let (mut rig, _) = holding(Options::default(), &levels);
    rig.device.advance(1100 * 400 / 128 + 100, |_| ());
    assert!(rig.status().faults.contains(Fault::HostLost));
    assert_eq!((held(&mut rig).progress, rig.status().state), (HoldProgress::Ended, State::Fault));

    let (mut rig, _) = holding(Options::default(), &levels);
    rig.device.inject_underrun();
    rig.live_ms(10);
    assert!(rig.status().faults.contains(Fault::Underrun));
    assert_eq!(held(&mut rig).progress, HoldProgress::Ended);

    let (mut rig, _) = holding(Options::default(), &levels);
    rig.hello();
    assert_eq!(held(&mut rig), Held::default());
    rig.live_ms(60);
    assert_eq!(rig.status().sum_per_mille, 0);
}

#[test]
fn the_lock_ins_belong_to_the_hold_while_it_runs() {
    let (mut rig, _) = touched(Options::default());
    rig.accepted(&sounds(&[(2, 0.1)]));
    rig.live_ms(10);
    // It takes the place of a measurement.
    rig.accepted(&Command::Listen(ListenWindow { blocks: 5000, ..window() }));
    let begin = rig.accepted(&hold(&[(2, codes(0.1))]));
    for command in [Command::Listen(window()), Command::ListenStop, hold(&[(2, codes(0.1))])] {
        assert_eq!(rig.refused(&command), Refusal::Busy(Busy::Holding));
    }
    let part = Command::ListenRead(ListenPart { input: 0, first_slot: 0 });
    let reading = answer!(rig, part, Listened);
    assert_eq!((reading.progress, reading.begin), (Progress::Running, begin));
    rig.accepted(&OFF);
    let reading = answer!(rig, part, Listened);
    assert_eq!(reading.progress, Progress::Idle);
    rig.accepted(&Command::ListenStop);
    rig.accepted(&OFF);
}
