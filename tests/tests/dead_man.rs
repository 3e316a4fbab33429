//! The dead-man: when the host is gone the drive ends.

use proptest::prelude::*;
use slipline_link::simulator::Options;
use slipline_protocol::command::KeepAlive;
use slipline_protocol::event::{Event, Fault, State};
use slipline_protocol::limits::{DEAD_MAN_MS, DEAD_MAN_RAMP_MS, KEEP_ALIVE_PERIOD_MS};
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::measure::{envelope, largest_step};
use slipline_tests::rig::{BLOCK, MID, Rig, Table, drive};
use slipline_tests::source_tree::{files, root};

/// Sounds one tone of 20 kHz at full scale.
fn driving() -> Rig {
    Rig::driving(&[(0, 1.0, 1.0)], 2000, 10)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn a_host_that_dies_at_any_moment_is_followed_by_silence_in_time(blocks in 0u64..2000) {
        // the link stays "connected" all the while, the missing beats are the only sign.
        let mut rig = driving();
        rig.live_blocks(blocks);
        rig.keep_alive();
        rig.record();
        let last_beat = rig.device.now();
        rig.silent_ms(DEAD_MAN_MS + 2 * DEAD_MAN_RAMP_MS);
        let (dead, ramp) = (rig.samples(DEAD_MAN_MS), rig.samples(DEAD_MAN_RAMP_MS));
        let end = rig.recording.end_of_sound().unwrap();
        prop_assert!(end > last_beat + dead + ramp * 8 / 10, "it sounds until then, and falls no faster than it may");
        prop_assert!(end <= last_beat + dead + ramp + 2 * BLOCK, "{}", end - last_beat);

        // 20 kHz is a period of 20 samples: the peaks of five periods each fall and never rise, without a jump.
        let fall = rig.recording.from(last_beat + dead - BLOCK);
        let peaks = envelope(fall, 100);
        prop_assert!(peaks.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{peaks:?}");
        let slew = 2047.0 * (2.0 * std::f64::consts::PI * 0.05 + 0.001) + 1.0;
        prop_assert!(f64::from(largest_step(fall)) <= slew);

        let muted_from = end + 8 * BLOCK;
        prop_assert!(!rig.recording.was_muted(end - 1), "the amplifier is muted after the ramp");
        prop_assert!(rig.recording.was_muted(muted_from));
        let status = rig.status();
        prop_assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::HostLost)));
        prop_assert!(status.first_fault_at.abs_diff(last_beat + dead) <= 2 * BLOCK);
    }

    #[test]
    fn three_lost_keep_alives_in_a_row_and_any_jitter_never_trip_it(
        beats in prop::collection::vec((0u32..=3, 0u32..100), 1..12),
    ) {
        //
        let mut rig = driving();
        for (lost, jitter_ms) in beats {
            rig.keep_alive();
            rig.silent_ms((lost + 1) * KEEP_ALIVE_PERIOD_MS + jitter_ms);
            prop_assert_eq!(rig.status().state, State::Driving);
        }
    }
}

#[test]
fn the_dead_mans_times_match_the_safety_page() {
    // the other tests follow the constants, whatever they are.
    assert_eq!((KEEP_ALIVE_PERIOD_MS, DEAD_MAN_MS, DEAD_MAN_RAMP_MS), (200, 1000, 50));
    let page = std::fs::read_to_string(root().join("firmware/SAFETY.md")).unwrap();
    assert!(page.contains("| 1.0 s and a ramp of 50 ms |"));
}

#[test]
fn after_the_dead_man_nothing_sounds_until_the_fault_is_cleared_and_the_device_is_armed_again() {
    //
    let mut rig = driving();
    rig.silent_ms(2 * DEAD_MAN_MS);
    let again = Command::Drive(drive(&[(0, 1.0, 1.0)], 2000));
    rig.keep_alive();
    assert!(matches!(rig.refused(&again), Refusal::Faulted { .. }));
    assert!(matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. }));
    rig.accepted(&Command::ClearFaults);
    assert_eq!(rig.refused(&again), Refusal::NotArmed);
    assert!(rig.device.is_muted());
    rig.arm();
    rig.accepted(&again);
    rig.live_ms(10);
    assert_eq!(rig.status().state, State::Driving);
}

#[test]
fn nothing_but_a_new_keep_alive_feeds_the_dead_man() {
    // not drives, not questions, not a beat that was received before, even the last.
    let mut rig = driving();
    let beat = rig.beat();
    let heard = [1, beat].map(|beat| rig.frame(&Command::KeepAlive(KeepAlive { beat })));
    for step in 0..120u32 {
        let command = Command::Drive(drive(&[(0, 0.5 + f64::from(step % 2) * 0.1, 0.5)], 2000));
        rig.send(&command);
        for beat in &heard {
            rig.exchange(beat);
        }
        rig.status();
        rig.silent_ms(10);
    }
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::HostLost)));
}

#[test]
fn a_silent_device_disarms_without_a_fault_when_its_host_dies() {
    let mut rig = Rig::armed();
    rig.silent_ms(DEAD_MAN_MS + 10);
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Idle, None));
    assert!(rig.device.is_muted());
}

#[test]
fn a_drive_that_was_to_begin_later_does_not_begin_when_the_host_is_gone() {
    //
    let mut rig = Rig::armed();
    let mut later = drive(&[(0, 1.0, 1.0)], 2000);
    later.apply = slipline_protocol::command::Apply::At(rig.device.now() + rig.samples(3000));
    rig.accepted(&Command::Drive(later));
    rig.record();
    rig.silent_ms(4000);
    assert_eq!(rig.recording.first_sound(rig.recording.first), None);
    assert!(rig.device.is_muted());
}

#[test]
fn a_host_that_wakes_after_an_hour_connects_cleanly() {
    // R-25, at 8 kS/s, so that the hour is few blocks; `reconnecting.rs` has it with the host's own link.
    let rate = 8000;
    let table = Table::usual().at_rate(rate);
    let mut rig = Rig::greeted_with(Options { sample_rate_hz: rate, ..Options::default() });
    rig.upload(&table);
    rig.arm();
    rig.play(&[(0, 1.0, 1.0)], 200, 100);
    assert_eq!(rig.status().state, State::Driving);
    let end = rig.device.now() + rig.samples(DEAD_MAN_MS + DEAD_MAN_RAMP_MS) + 2 * BLOCK;
    let muted_from = end + 8 * BLOCK;
    rig.device.advance(rig.samples(3_600_000) / BLOCK, |block| {
        assert!(block.first < end || block.codes.iter().all(|&code| code == MID), "at {}", block.first);
        assert!(block.first < muted_from || block.muted, "at {}", block.first);
    });
    let reply = rig.hello();
    assert!(matches!(reply.event, Event::Hello(_)));
    assert_eq!(rig.status().first_fault, Some(Fault::HostLost));
    rig.accepted(&Command::ClearFaults);
    rig.upload(&table);
    rig.arm();
    rig.play(&[(0, 0.5, 0.5)], 200, 100);
    assert_eq!(rig.status().state, State::Driving);
}

#[test]
fn no_safety_depends_on_what_the_port_says_about_a_connection() {
    // the application does not even have the words.
    let sources = files(&root().join("firmware/app/src"), &[".rs"]);
    assert!(sources.len() > 20);
    for path in sources {
        let text = std::fs::read_to_string(&path).unwrap().to_lowercase();
        for word in ["dtr", "wait_connection", "vbus", "is_connected"] {
            assert!(!text.contains(word), "{word} in {}", path.display());
        }
    }
}
