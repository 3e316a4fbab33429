//! The drive, without a device: what is sent, and what the notices say.

use super::*;
use crate::instrument::shell::{Attention, Output, Page};
use crate::instrument::tests::StillLink;
use slipline_link::LinkState;
use slipline_link::protocol::event::{Fault, Faults, Identity, Status};
use slipline_link::simulator::loopback::Loopback;
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::table;

fn setup() -> Setup {
    Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()))
}

/// A drive of this setup that has taken this snapshot, and the requests that it sends.
fn drive(setup: &Setup, snapshot: Snapshot) -> (Drive, StillLink) {
    let link = StillLink::with(snapshot);
    let mut drive = Drive::new(Box::new(link.clone()), &setup.plate, &mut Jobs::inline());
    drive.take_snapshot();
    (drive, link)
}

/// The snapshot of a device that is idle.
fn idle(simulated: bool) -> Snapshot {
    let loopback = Loopback::connect(400_000).unwrap();
    let identity = loopback.view().device.identity.as_deref().cloned().unwrap();
    let mut snapshot = Snapshot { revision: 1, ..loopback.view().clone() };
    snapshot.device.identity = Some(Arc::new(Identity { simulated, ..identity }));
    snapshot.drive.status = Some(Status { state: State::Idle, ..Status::default() });
    snapshot
}

#[test]
fn a_drive_that_cannot_begin_states_the_obstacle_and_sends_nothing() {
    let setup = setup();
    let mut connecting = Snapshot::default();
    connecting.link.state = LinkState::Connecting;
    for (snapshot, part, opens) in [
        (Snapshot::default(), "press Connect first", false),
        (connecting, "has not answered yet", false),
        (idle(false), "arm it first", true),
    ] {
        let (mut drive, link) = drive(&setup, snapshot);
        let mut out = Outbox::default();
        drive.start(&setup, &Attention::default(), &mut out);
        let notices: Vec<&str> = out.notices().map(|notice| notice.text.as_str()).collect();
        assert!(notices.len() == 1 && notices[0].contains(part), "{notices:?}");
        assert_eq!(matches!(out.take_outputs()[..], [Output::Open(Page::Arm)]), opens, "{part}");
        assert!(link.sent.take().is_empty() && !drive.is_wanted(), "{part}");
    }
}

#[test]
fn a_simulated_device_is_armed_by_drive_and_a_stop_ends_what_the_user_wants() {
    let setup = setup();
    let (mut drive, link) = drive(&setup, idle(true));
    drive.start(&setup, &Attention::default(), &mut Outbox::default());
    assert!(matches!(link.sent.take()[..], [Request::Arm]) && drive.is_wanted());
    assert!(!drive.is_known_to_be_silent(0.0));
    drive.end(Request::Stop);
    drive.disarm_real();
    assert!(matches!(link.sent.take()[..], [Request::Stop]), "a simulated device stays armed");
    assert!(!drive.is_wanted() && drive.is_known_to_be_silent(0.0));
}

#[test]
fn a_fault_is_reported_before_all_else_until_it_is_cleared() {
    let setup = setup();
    let mut faulty = idle(false);
    let status =
        Status { state: State::Fault, faults: Faults::NONE.with(Fault::DriveTime), ..Status::default() };
    faulty.drive.status = Some(status);
    let mut out = Outbox::default();
    let changed = Changes { state: true, faults: true, ..Changes::default() };
    let first = |out: &Outbox| out.notices().next().map(|notice| notice.text.clone());
    let (mut stopped, _) = drive(&setup, faulty);
    out.post("Saved".to_owned());
    stopped.report(&changed, &setup, |_| false, &mut out);
    let said = first(&out).unwrap();
    assert!(said.starts_with("Stopped: ") && said.contains("Clear the fault"), "{said}");
    out.fail("Not opened".to_owned());
    assert_eq!(first(&out), Some(said), "no other message hides it");
    let (mut cleared, _) = drive(&setup, idle(false));
    cleared.report(&changed, &setup, |_| false, &mut out);
    assert_eq!(first(&out), Some("Not opened".to_owned()));
}

#[test]
fn a_table_is_requested_once_for_each_plate_and_a_cancelled_one_gives_the_one_before_back() {
    let identity = idle(true).device.identity.unwrap();
    let plates = ["membrane", "membrane-heavy"].map(|name| Arc::new(slipline_plate::preset(name).unwrap()));
    let mut table = Table::of(Arc::clone(&plates[0]), JobQueue::inline(table::make));
    table.ask(&identity);
    assert!(table.take() && table.made().is_some());
    table.ask(&identity);
    assert!(!table.take(), "nothing was requested");
    assert!(table.cancel().is_none(), "the table before is that of this plate");
    table.use_plate(&plates[1]);
    table.ask(&identity);
    let kept = table.cancel().unwrap();
    assert!(Arc::ptr_eq(&kept.plate, &plates[0]) && table.made().is_none());
    assert!(!table.take(), "the cancelled table is dropped");
}
