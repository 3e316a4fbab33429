//! The DAC runs dry.

use slipline_protocol::event::{Fault, State};
use slipline_protocol::limits::STOP_RAMP_MS;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::measure::{envelope, largest_step};
use slipline_tests::rig::{BLOCK, Rig, drive};

#[test]
fn an_underrun_while_driving_is_counted_and_ends_in_one_ramp_to_silence() {
    //
    let mut rig = Rig::armed();
    rig.accepted(&Command::Drive(drive(&[(0, 1.0, 1.0)], 2000)));
    rig.live_ms(20);
    rig.record();
    rig.device.inject_underrun();
    let dry = rig.device.now();
    rig.live_ms(60);
    let end = rig.recording.end_of_sound().unwrap();
    let ramp = rig.samples(STOP_RAMP_MS);
    assert!(end <= dry + ramp + 3 * BLOCK, "{}", end - dry);
    let fall = rig.recording.from(dry);
    let peaks = envelope(fall, 100);
    assert!(peaks.windows(2).all(|pair| pair[1] <= pair[0] + 1), "{peaks:?}");
    // 20 kHz at full scale moves by 643 codes a sample.
    assert!(largest_step(fall) <= 648);
    assert!(rig.device.is_muted());
    let status = rig.status();
    assert_eq!((status.state, status.first_fault), (State::Fault, Some(Fault::Underrun)));
    assert_eq!(status.counters.underruns, 1);

    assert!(matches!(rig.refused(&Command::Arm), Refusal::Faulted { .. }));
    rig.accepted(&Command::ClearFaults);
    rig.arm();
    rig.accepted(&Command::Drive(drive(&[(0, 1.0, 1.0)], 2000)));
    rig.live_ms(10);
    assert_eq!(rig.status().state, State::Driving);
}

#[test]
fn underruns_one_after_the_other_are_all_counted_and_the_ramp_still_ends() {
    //
    let mut rig = Rig::armed();
    rig.accepted(&Command::Drive(drive(&[(0, 1.0, 1.0)], 2000)));
    rig.live_ms(20);
    rig.record();
    let dry = rig.device.now();
    for _ in 0..200 {
        rig.device.inject_underrun();
        rig.silent_blocks(1);
    }
    let end = rig.recording.end_of_sound().unwrap();
    assert!(end <= dry + rig.samples(STOP_RAMP_MS) + 3 * BLOCK, "{}", end - dry);
    assert_eq!(rig.status().counters.underruns, 200);
}
