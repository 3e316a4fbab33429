//! Host and device of different minors, R-23: one of the two is this build, the other names a minor beside it. Hosts and devices
//! of released minors talk to this build in transcripts.rs; what stands in for an addition: shared/tests/golden.rs.

use slipline_link::{Outcome, Request};
use slipline_protocol::command::Command;
use slipline_protocol::event::{Event, State};
use slipline_protocol::version::{Compatibility, MINOR};
use slipline_tests::client::Client;
use slipline_tests::commands::every_command;
use slipline_tests::faulty_ports::{Rewrite, as_real, identified};
use slipline_tests::link_rig::{LinkRig, drive};
use slipline_tests::rig::{self, Rig, Table};

/// The hello's answer, with this minor in the place of the device's.
fn of_minor(event: Event, minor: u8) -> Event {
    identified(event, |identity| identity.version.minor = minor)
}

/// This build's link with a device that names another minor: it uploads a table, arms, drives and stops.
fn driven(rewrite: Rewrite) -> LinkRig {
    let rig = LinkRig::new();
    rig.ports().rewrite = rewrite;
    let mut rig = rig.connect().arm();
    for request in [drive(0.05), Request::Refresh, Request::Stop, Request::Disarm] {
        rig.done(request, 300);
    }
    rig
}

#[test]
fn a_device_of_a_newer_minor_is_asked_what_one_of_this_minor_is_asked() {
    let newer = driven(|event| of_minor(event, MINOR + 1));
    assert_eq!(newer.view().device.compatibility, Some(Compatibility::DeviceNewer));
    let same = driven(as_real);
    assert_eq!(same.view().device.compatibility, Some(Compatibility::Same));
    assert_eq!(newer.ports().commands, same.ports().commands);
}

#[test]
fn a_device_of_an_older_minor_is_driven_and_not_asked_for_what_it_lacks() {
    let mut rig = driven(|event| of_minor(event, MINOR - 1));
    assert_eq!(rig.view().device.compatibility, Some(Compatibility::DeviceOlder));
    let ticket = rig.ask(Request::WriteProfile(Box::new(None)));
    rig.pass_ms(300);
    assert_eq!(rig.outcome(ticket), Some(Outcome::DeviceTooOld));
    assert!(rig.ports().commands.iter().all(|(_, command)| command.since() < MINOR), "nothing newer is sent");
}

#[test]
fn a_host_of_a_newer_minor_is_answered_as_one_of_this_minor() {
    let answers = |minor: u8| {
        let mut rig = Rig::default();
        rig.hello_of_minor(minor);
        rig.upload(&Table::usual());
        rig.arm();
        rig.accepted(&Command::Drive(rig::drive(&[(0, 0.3, 0.4)], 2000)));
        rig.live_ms(20);
        assert_eq!(rig.status().state, State::Driving);
        rig.accepted(&Command::Stop);
        rig.live_ms(100);
        let commands = every_command().into_iter().filter(|command| !matches!(command, Command::Hello(_)));
        let answers: Vec<Event> = commands.map(|command| rig.send(&command)).collect();
        (answers, rig.recording.codes)
    };
    assert_eq!(answers(MINOR + 1), answers(MINOR));
}
