//! Devices of another major version, R-23. Those of another minor stand in minor_versions.rs and transcripts.rs.

use slipline_link::{LinkState, Outcome, Port, Refusal, Request};
use slipline_protocol::Command;
use slipline_protocol::version::Compatibility;
use slipline_tests::faulty_ports::{Rewrite, identified};
use slipline_tests::link_rig::{LinkRig, drive};

#[test]
fn a_device_of_another_version_can_be_identified_and_stopped_and_no_more() {
    //
    let foreign: [(Rewrite, Compatibility); 3] = [
        (|event| identified(event, |it| it.version.major += 1), Compatibility::UpdateHost),
        (|event| identified(event, |it| it.version.major = 0), Compatibility::FlashDevice),
        (|event| identified(event, |it| it.version.schema[0] ^= 1), Compatibility::FlashDevice),
    ];
    for (rewrite, want) in foreign {
        let mut rig = LinkRig::new();
        rig.ports().rewrite = rewrite;
        rig.ask_and_pass(Request::Connect(Port::Serial("A".to_owned())), 2000);
        assert_eq!(rig.view().link.state, LinkState::Connected);
        assert_eq!(rig.view().device.compatibility, Some(want));
        assert!(rig.view().device.identity.is_some(), "identified");
        for request in [Request::Arm, drive(0.05), Request::Store, Request::ClearFaults] {
            let ticket = rig.ask(request);
            assert_eq!(rig.outcome(ticket), Some(Outcome::Refused(Refusal::Incompatible(want))));
        }
        rig.done(Request::Stop, 50);
        assert!(rig.ports().commands.iter().all(|(_, c)| matches!(c, Command::Hello(_) | Command::Stop)));
    }
}
