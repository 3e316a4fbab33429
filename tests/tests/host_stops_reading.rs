//! A host that stops reading.

use slipline_protocol::Command;
use slipline_protocol::event::{Event, State};
use slipline_protocol::limits::TRANSMIT_TIMEOUT_MS;
use slipline_tests::client::Client;
use slipline_tests::rig::{Rig, drive};

fn drag(stalled: bool) -> Rig {
    let mut rig = Rig::armed();
    rig.record();
    rig.device.stall_transmit(stalled);
    for step in 0..60u32 {
        let command = Command::Drive(drive(&[(0, f64::from(step) / 60.0, 0.7)], 2000));
        let frame = rig.frame(&command);
        rig.device.feed(&frame);
        rig.live_ms(5);
    }
    rig
}

#[test]
fn a_host_that_stops_reading_changes_no_code_and_its_commands_are_still_done() {
    //
    let reading = drag(false);
    let mut stalled = drag(true);
    assert_eq!(reading.recording.codes, stalled.recording.codes);

    stalled.device.stall_transmit(false);
    stalled.collect();
    stalled.replies.clear();
    let status = stalled.status();
    assert_eq!(status.state, State::Driving);
    assert!(status.counters.dropped > 20, "{:?}", status.counters);
}

#[test]
fn a_reply_that_the_host_does_not_take_in_time_is_dropped_and_counted() {
    //
    let mut rig = Rig::armed();
    rig.device.stall_transmit(true);
    let frame = rig.frame(&Command::ClearFaults);
    rig.device.feed(&frame);
    rig.silent_ms(TRANSMIT_TIMEOUT_MS / 2);
    rig.device.stall_transmit(false);
    rig.collect();
    assert_eq!(rig.replies.len(), 1, "half the time-out is in time");
    rig.replies.clear();

    rig.device.stall_transmit(true);
    let frame = rig.frame(&Command::ClearFaults);
    rig.device.feed(&frame);
    rig.silent_ms(TRANSMIT_TIMEOUT_MS + 5);
    rig.device.stall_transmit(false);
    rig.collect();
    assert!(rig.replies.is_empty(), "{:?}", rig.replies);
    assert_eq!(rig.status().counters.dropped, 1);
    // The host repeats the command and gets the answer it missed.
    assert!(matches!(rig.exchange(&frame).unwrap().event, Event::Accepted(_)));
    assert_eq!(rig.status().counters.duplicates, 1);
}
