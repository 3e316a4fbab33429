//! Devices of another version, R-23.

use slipline::link::{LinkState, Outcome, Port, Request};
use slipline_protocol::version::{Compatibility, Version};
use slipline_protocol::{Command, Event};
use slipline_tests::bench::{Bench, drive};
use slipline_tests::world::{Rewrite, as_real};

fn reversion(event: Event, change: fn(&mut Version)) -> Event {
    match as_real(event) {
        Event::Hello(mut identity) => {
            change(&mut identity.version);
            Event::Hello(identity)
        }
        event => event,
    }
}

#[test]
fn a_device_of_another_version_can_be_identified_and_stopped_and_no_more() {
    //
    let foreign: [(Rewrite, Compatibility); 3] = [
        (|event| reversion(event, |v| v.major += 1), Compatibility::UpdateHost),
        (|event| reversion(event, |v| v.major = 0), Compatibility::FlashDevice),
        (|event| reversion(event, |v| v.schema[0] ^= 1), Compatibility::FlashDevice),
    ];
    for (rewrite, want) in foreign {
        let mut bench = Bench::new();
        bench.world().rewrite = rewrite;
        bench.ask(Request::Connect(Port::Serial("A".to_owned())));
        bench.pass_ms(2000);
        assert_eq!(bench.view().link, LinkState::Connected);
        assert_eq!(bench.view().compatibility, Some(want));
        assert!(bench.view().identity.is_some(), "identified");
        for request in [Request::Arm, drive(0.05), Request::Store, Request::ClearFaults] {
            let ticket = bench.ask(request);
            assert_eq!(bench.outcome(ticket), Some(Outcome::Refused(want.sentence().to_owned())));
        }
        let stop = bench.ask(Request::Stop);
        bench.pass_ms(50);
        assert!(matches!(bench.outcome(stop), Some(Outcome::Done { .. })));
        assert!(bench.world().heard.iter().all(|(_, c)| matches!(c, Command::Hello(_) | Command::Stop)));
    }
}

#[test]
fn a_device_with_a_newer_minor_version_is_driven_all_the_same() {
    let mut bench = Bench::new();
    bench.world().rewrite = |event| reversion(event, |v| v.minor += 1);
    bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(100);
    assert_eq!(bench.view().compatibility, Some(Compatibility::DeviceNewer));
    let arm = bench.ask(Request::Arm);
    bench.pass_ms(50);
    assert!(matches!(bench.outcome(arm), Some(Outcome::Done { .. })));
}
