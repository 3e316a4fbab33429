//! What goes wrong with a port itself, R-26: each is one loss, told with its reason, and no busy loop.

use std::io::{self, ErrorKind};
use std::time::{Duration, Instant};

use slipline::link::transport::{Opener, Transport, Waker};
use slipline::link::worker::Worker;
use slipline::link::{LinkState, Outcome, Port, PortInfo, Request, Trouble};
use slipline_tests::bench::{Bench, LOST_AFTER_MS};
use slipline_tests::world::{Ports, board};

#[test]
fn a_device_that_never_answers_is_given_up_with_a_reason() {
    let mut bench = Bench::new();
    bench.world().deaf_for = u32::MAX;
    let ticket = bench.ask(Request::Connect(Port::Serial("A".to_owned())));
    bench.pass_ms(LOST_AFTER_MS + 10);
    assert_eq!(bench.view().link, LinkState::Disconnected);
    assert_eq!(bench.view().trouble, Some(Trouble::NoAnswer(Port::Serial("A".to_owned()))));
    assert!(matches!(bench.outcome(ticket), Some(Outcome::Refused(_))));
}

#[test]
fn every_error_of_a_port_is_one_loss_and_no_busy_loop() {
    // UnexpectedEof stands for a read of Ok(0) here.
    for kind in [
        ErrorKind::UnexpectedEof,
        ErrorKind::BrokenPipe,
        ErrorKind::ConnectionReset,
        ErrorKind::NotConnected,
        ErrorKind::PermissionDenied,
        ErrorKind::ResourceBusy,
        ErrorKind::Other,
    ] {
        let mut bench = Bench::connected();
        bench.ask(Request::AutoReconnect(false));
        bench.states.clear();
        bench.world().error = Some(kind);
        let (steps, reads) = (bench.steps, bench.world().reads);
        bench.pass_ms(10_000);
        assert_eq!(bench.states.len(), 1, "{kind:?}: {:?}", bench.states);
        assert!(matches!(bench.states[0], LinkState::Lost(_)), "{kind:?}");
        assert!(bench.steps - steps <= 2, "{kind:?}: {} steps", bench.steps - steps);
        assert!(bench.world().reads - reads <= 2, "{kind:?}");
        assert!(bench.view().trouble.is_some());
    }
}

#[test]
fn a_port_that_only_says_not_yet_is_not_hammered_and_lost_for_its_silence() {
    //
    for kind in [ErrorKind::TimedOut, ErrorKind::WouldBlock] {
        let mut bench = Bench::connected();
        bench.ask(Request::AutoReconnect(false));
        bench.world().error = Some(kind);
        let steps = bench.steps;
        bench.pass_ms(LOST_AFTER_MS + 250);
        assert_eq!(bench.view().link, LinkState::Lost(Trouble::Silent), "{kind:?}");
        // A write that does not go through is tried every millisecond.
        assert!(bench.steps - steps <= LOST_AFTER_MS + 260);
    }
}

#[test]
fn a_port_that_cannot_be_opened_says_why_and_is_not_tried_again() {
    let port = Port::Serial("A".to_owned());
    for trouble in
        [Trouble::Busy(port.clone()), Trouble::NoPermission(port.clone()), Trouble::NoSuchPort(port.clone())]
    {
        let mut bench = Bench::new();
        bench.world().open_error = Some(trouble.clone());
        let ticket = bench.ask(Request::Connect(port.clone()));
        assert_eq!(bench.outcome(ticket), Some(Outcome::Refused(trouble.to_string())));
        bench.pass_ms(5000);
        assert_eq!(bench.view().link, LinkState::Disconnected);
        assert_eq!(bench.world().opened.len(), 1);
    }
}

/// Real time; its length is not asserted.
const PATIENCE: Duration = Duration::from_secs(10);

#[test]
fn a_mistake_in_the_link_itself_is_told_and_leaves_no_request_unanswered() {
    struct FailsSecond(Ports, u32);
    impl Opener for FailsSecond {
        fn list(&mut self) -> Vec<PortInfo> {
            self.0.list()
        }
        fn open(&mut self, port: &Port, waker: &Waker) -> Result<Box<dyn Transport>, Trouble> {
            self.1 += 1;
            assert!(self.1 < 2, "a mistake in the link");
            self.0.open(port, waker)
        }
    }
    let worker = Worker::spawn_with(FailsSecond(Ports(Bench::new().world), 0), || ()).unwrap();
    let connect = worker.send(Request::Connect(Port::Serial("A".to_owned())));
    assert!(matches!(worker.wait(connect, PATIENCE), Some(Outcome::Done { .. })));
    let again = worker.send(Request::Connect(Port::Serial("A".to_owned())));
    assert_eq!(worker.wait(again, PATIENCE), Some(Outcome::NotConnected), "under way");
    let later = worker.send(Request::Refresh);
    assert_eq!(worker.wait(later, PATIENCE), Some(Outcome::NotConnected));
    let view = worker.snapshot();
    assert_eq!(view.link, LinkState::Lost(Trouble::Crashed));
    assert!(
        view.status.is_none()
            && view.log.back().is_some_and(|line| line.text.contains("start Slipline again"))
    );
}

#[test]
fn a_port_that_never_comes_back_from_a_write_does_not_keep_the_program_from_ending() {
    struct Hangs;
    impl Opener for Hangs {
        fn list(&mut self) -> Vec<PortInfo> {
            vec![board("A")]
        }
        fn open(&mut self, _port: &Port, _waker: &Waker) -> Result<Box<dyn Transport>, Trouble> {
            Ok(Box::new(Self))
        }
    }
    impl Transport for Hangs {
        fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
            Err(ErrorKind::WouldBlock.into())
        }
        fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
            std::thread::sleep(3 * PATIENCE);
            Err(ErrorKind::TimedOut.into())
        }
    }
    let worker = Worker::spawn_with(Hangs, || ()).unwrap();
    worker.send(Request::Connect(Port::Serial("A".to_owned())));
    std::thread::sleep(Duration::from_millis(50));
    let quit = Instant::now();
    drop(worker);
    assert!(quit.elapsed() < PATIENCE);
}

#[test]
fn a_file_or_a_folder_is_told_to_be_no_serial_port() {
    for path in [concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"), env!("CARGO_MANIFEST_DIR")] {
        let told = slipline::link::serial::open(path).err();
        assert_eq!(told, Some(Trouble::NotSerial(Port::Serial(path.to_owned()))));
    }
}
