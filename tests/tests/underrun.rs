//! Blocks that come too late, and an amplifier that has muted itself.

use slipline_app::safety::fade::{FADE_STEP, fade};
use slipline_link::mirror::Mirror;
use slipline_protocol::event::{Fault, State};
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::measure::largest_step;
use slipline_tests::rig::{BLOCK, MID, RATE_HZ, Rig, Table, drive};

/// Sounds one tone of 20 kHz at full scale, recorded.
fn driving() -> Rig {
    let mut rig = Rig::driving(&[(0, 1.0, 1.0)], 2000, 20);
    rig.record();
    rig.live_blocks(1);
    rig
}

#[test]
fn a_late_block_is_not_played_and_one_line_ends_the_sound() {
    //
    let mut rig = driving();
    rig.device.inject_underrun();
    let dry = rig.device.now();
    rig.live_ms(60);
    let last = rig.recording.codes[(dry - rig.recording.first) as usize - 1];
    assert!(last.abs_diff(MID) > 100, "it sounds up to there: {last}");
    let fall = rig.recording.from(dry);
    let line: Vec<u16> = fade(last).take(fall.len()).collect();
    assert_eq!(fall, line);
    let end = rig.recording.end_of_sound().unwrap();
    assert!(end <= dry + 512, "{}", end - dry);
    // 20 kHz at full scale moves by 643 codes a sample.
    assert!(largest_step(rig.recording.from(dry - BLOCK)) <= 643 + FADE_STEP);
    assert!(rig.recording.was_muted(dry + 8 * BLOCK), "no ramp comes after the fault");
    assert!(!rig.recording.was_muted(dry + 511), "the line is over before the amplifier is switched");
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::Underrun)));
    assert!(status.first_fault_at.abs_diff(dry) <= BLOCK);
    assert_eq!((status.counters.underruns, status.sum_per_mille), (1, 0));

    assert!(matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. }));
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    rig.play(&[(0, 1.0, 1.0)], 2000, 10);
    assert_eq!(rig.status().state, State::Driving);
}

#[test]
fn successive_late_blocks_are_all_counted_and_the_line_still_ends() {
    //
    let mut rig = driving();
    let dry = rig.device.now();
    for _ in 0..200 {
        rig.device.inject_underrun();
        rig.silent_blocks(1);
    }
    let end = rig.recording.end_of_sound().unwrap();
    assert!(end <= dry + 512, "{}", end - dry);
    assert_eq!(rig.status().counters.underruns, 200);
}

#[test]
fn after_a_late_block_the_device_plays_what_the_mirror_plays_at_the_same_indices() {
    // the late block took up its time.
    let mut rig = Rig::greeted();
    let table = Table::usual();
    rig.upload(&table);
    rig.arm();
    rig.play(&[(0, 1.0, 1.0), (3, 0.2, 0.0)], 2000, 20);
    rig.device.inject_underrun();
    rig.live_ms(20);
    let mut mirror = Mirror::new(RATE_HZ, rig.device.now());
    mirror.acknowledge_table(table.knots.as_slice().into(), mirror.now()).unwrap();
    rig.record();
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    let again = drive(&[(0, 0.3, 0.4), (1, 0.9, 0.6)], 2700);
    let at = rig.accepted(&Command::Drive(again.clone()));
    mirror.acknowledge_play(again, at).unwrap();
    rig.live_ms(30);
    let mut replayed = Vec::new();
    mirror.render(rig.device.now(), |_, codes| replayed.extend_from_slice(codes));
    assert!(rig.recording.end_of_sound().is_some());
    assert_eq!(rig.recording.codes, replayed);
}

#[test]
fn an_amplifier_that_has_muted_itself_stays_muted_until_the_device_is_armed_again() {
    for sounds in [true, false] {
        let mut rig = Rig::armed();
        if sounds {
            rig.accepted(&Command::Drive(drive(&[(0, 1.0, 1.0)], 2000)));
        }
        rig.live_ms(20);
        rig.record();
        rig.device.inject_mute();
        let muted = rig.device.now();
        rig.live_ms(60);
        assert!(rig.recording.was_muted(muted + BLOCK) && rig.device.is_muted());
        assert!(
            rig.recording.from(muted + 2 * BLOCK).iter().all(|&code| code == MID),
            "and nothing is played"
        );
        let status = rig.status();
        assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::Underrun)));
        assert_eq!(status.counters.underruns, 1);
        rig.accepted(&Command::ClearFaults);
        rig.arm();
        rig.live_ms(10);
        assert!(!rig.device.is_muted());
        rig.play(&[(0, 1.0, 1.0)], 2000, 10);
        assert_eq!(rig.status().state, State::Driving);
    }
}

#[test]
fn an_amplifier_that_mutes_itself_after_a_disarm_is_no_fault() {
    let mut rig = Rig::armed();
    rig.live_ms(20);
    rig.accepted(&Command::Disarm);
    rig.device.inject_mute();
    rig.live_ms(20);
    let status = rig.status();
    assert_eq!((status.state, status.first_fault, status.counters.underruns), (State::Idle, None, 0));
}
