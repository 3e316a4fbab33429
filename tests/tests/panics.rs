//! a panic in the program that drives. The hook is of the whole process, so this test has one of its own.

use slipline_link::native::{Worker, stop_on_panic};
use slipline_link::{Change, Outcome, Port, Request};
use slipline_protocol::Command;
use slipline_tests::faulty_ports::{PortsOpener, lock};
use slipline_tests::link_rig::LinkRig;
use slipline_tests::turned_clock::{HANG, TurnedClock, until};

#[test]
fn a_panic_anywhere_in_the_program_stops_the_drive() {
    let rig = LinkRig::new();
    // The worker's clock stands still: the stop waits for nothing that would be due later.
    let clock = TurnedClock::default();
    let ports = PortsOpener(rig.ports.clone());
    let worker = Worker::spawn_in_time_of(clock.clock(), ports, || ()).unwrap();
    let connect = worker.send(Request::Connect(Port::Serial("A".to_owned())));
    assert!(matches!(worker.handle().wait(connect, HANG), Some(Outcome::Done { .. })));
    stop_on_panic(worker.handle());
    let stops = || lock(&rig.ports).commands.iter().filter(|(_, command)| *command == Command::Stop).count();
    for panics in 1..=5 {
        let painted = std::thread::spawn(|| panic!("a mistake while painting"));
        assert!(painted.join().is_err());
        until("a stop", || stops() >= panics);
    }
    let stopped = worker.handle().wait_for(HANG, |snapshot| {
        snapshot.record.journal.iter().any(|entry| entry.change == Change::Stop).then_some(())
    });
    assert_eq!(stopped, Some(()));
}
