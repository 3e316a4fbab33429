//! Errors of a port, R-26: each is reported once as a loss with its reason, and none makes a busy loop.

use std::io::{self, ErrorKind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use slipline_link::native::Watch;
use slipline_link::native::Worker;
use slipline_link::transport::{Opener, Transport, Waker};
use slipline_link::{LinkError, LinkState, Outcome, Port, PortInfo, Request};
use slipline_tests::faulty_ports::{Line, PortsOpener, board};
use slipline_tests::link_rig::{LOST_AFTER_MS, LinkRig};
use slipline_tests::turned_clock::{HANG, TurnedClock, until};

#[test]
fn a_device_that_never_answers_is_given_up_with_a_reason() {
    let mut rig = LinkRig::new();
    rig.ports().drop_replies = u32::MAX;
    let ticket = rig.ask(Request::Connect(Port::Serial("A".to_owned())));
    rig.pass_ms(LOST_AFTER_MS + 10);
    assert_eq!(rig.view().link.state, LinkState::Disconnected);
    assert_eq!(rig.view().link.error, Some(LinkError::NoAnswer(Port::Serial("A".to_owned()))));
    assert!(matches!(rig.outcome(ticket), Some(Outcome::Refused(_))));
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
        let mut rig = LinkRig::connected();
        rig.ask(Request::AutoReconnect(false));
        rig.states.clear();
        rig.ports().error = Some(kind);
        let (steps, reads) = (rig.steps, rig.ports().reads);
        rig.pass_ms(10_000);
        assert_eq!(rig.states.len(), 1, "{kind:?}: {:?}", rig.states);
        assert!(matches!(rig.states[0], LinkState::Lost(_)), "{kind:?}");
        assert!(rig.steps - steps <= 2, "{kind:?}: {} steps", rig.steps - steps);
        assert!(rig.ports().reads - reads <= 2, "{kind:?}");
        assert!(rig.view().link.error.is_some());
    }
}

#[test]
fn a_port_that_would_only_block_is_polled_slowly_and_lost_as_silent() {
    //
    for kind in [ErrorKind::TimedOut, ErrorKind::WouldBlock] {
        let mut rig = LinkRig::connected();
        rig.ask(Request::AutoReconnect(false));
        rig.ports().error = Some(kind);
        let steps = rig.steps;
        rig.pass_ms(LOST_AFTER_MS + 250);
        assert_eq!(rig.view().link.state, LinkState::Lost(LinkError::Silent), "{kind:?}");
        // A write that does not go through is tried every millisecond.
        assert!(rig.steps - steps <= LOST_AFTER_MS + 260);
    }
}

#[test]
fn a_port_that_cannot_be_opened_says_why_and_is_not_tried_again() {
    let port = Port::Serial("A".to_owned());
    // A missing port is waited for if that is switched on: reconnecting.rs.
    for (trouble, reconnects) in [
        (LinkError::Busy(port.clone()), true),
        (LinkError::NoPermission(port.clone()), true),
        (LinkError::NotSerial(port.clone()), true),
        (LinkError::NoSuchPort(port.clone()), false),
    ] {
        let mut rig = LinkRig::new();
        rig.ask(Request::AutoReconnect(reconnects));
        rig.ports().open_error = Some(trouble.clone());
        let ticket = rig.ask(Request::Connect(port.clone()));
        assert_eq!(rig.outcome(ticket), Some(Outcome::Refused(trouble.clone().into())));
        rig.pass_ms(5000);
        assert_eq!(rig.view().link.state, LinkState::Disconnected);
        assert_eq!(rig.view().link.error, Some(trouble));
        assert_eq!(rig.ports().opened.len(), 1);
    }
}

#[test]
fn a_panic_in_the_link_is_reported_and_leaves_no_request_unanswered() {
    struct FailsSecond(PortsOpener, u32);
    impl Opener for FailsSecond {
        type Transport = Line;
        fn list(&mut self) -> Vec<PortInfo> {
            self.0.list()
        }
        fn open(&mut self, port: &Port, waker: &Waker) -> Result<Line, LinkError> {
            self.1 += 1;
            assert!(self.1 < 2, "a mistake in the link");
            self.0.open(port, waker)
        }
    }
    let worker = Worker::spawn_with(FailsSecond(PortsOpener(LinkRig::new().ports), 0), || ()).unwrap();
    let connect = worker.send(Request::Connect(Port::Serial("A".to_owned())));
    assert!(matches!(worker.wait(connect, HANG), Some(Outcome::Done { .. })));
    let again = worker.send(Request::Connect(Port::Serial("A".to_owned())));
    assert_eq!(worker.wait(again, HANG), Some(Outcome::NotConnected), "under way");
    let later = worker.send(Request::Refresh);
    assert_eq!(worker.wait(later, HANG), Some(Outcome::NotConnected));
    let view = worker.snapshot();
    assert_eq!(view.link.state, LinkState::Lost(LinkError::Crashed));
    assert!(
        view.drive.status.is_none()
            && view.record.log.back().is_some_and(|line| line.text.contains("start Slipline again"))
    );
}

#[test]
fn a_port_that_never_comes_back_from_a_write_does_not_keep_the_program_from_ending() {
    #[derive(Clone)]
    struct Hangs {
        begun: Sender<()>,
        held: Arc<Mutex<Receiver<()>>>,
    }
    impl Watch for Hangs {}
    impl Opener for Hangs {
        type Transport = Self;
        fn list(&mut self) -> Vec<PortInfo> {
            vec![board("A")]
        }
        fn open(&mut self, _port: &Port, _waker: &Waker) -> Result<Self, LinkError> {
            Ok(self.clone())
        }
    }
    impl Transport for Hangs {
        fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
            Err(ErrorKind::WouldBlock.into())
        }
        fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
            let _ = self.begun.send(());
            // Until the test lets go of it.
            let _ = self.held.lock().unwrap().recv();
            Err(ErrorKind::TimedOut.into())
        }
    }
    let (begun, has_begun) = channel();
    let (release, held) = channel();
    let clock = TurnedClock::default();
    let hangs = Hangs { begun, held: Arc::new(Mutex::new(held)) };
    let worker = Worker::spawn_in_time_of(clock.clock(), hangs, || ()).unwrap();
    worker.send(Request::Connect(Port::Serial("A".to_owned())));
    has_begun.recv_timeout(HANG).expect("it is written to");
    let ending = std::thread::spawn(move || drop(worker));
    // It waits for the thread by the worker's clock, which goes on.
    until("ended", || {
        clock.jump(Duration::from_millis(100));
        ending.is_finished()
    });
    assert!(release.send(()).is_ok(), "the write hangs to this moment");
}

#[test]
#[cfg(unix)]
fn a_socket_whose_path_is_typed_as_a_port_says_how_a_socket_is_written() {
    let path = std::env::temp_dir().join(format!("slipline-typed-{}.sock", std::process::id()));
    let served = std::os::unix::net::UnixListener::bind(&path).unwrap();
    let name = path.to_str().unwrap();
    let error = slipline_link::native::serial::open(name).err().unwrap();
    drop(served);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(error, LinkError::NotSerial(Port::Serial(name.to_owned())));
    assert!(error.to_string().ends_with("the socket of a served device is written unix:PATH"), "{error}");
}

#[test]
fn a_file_or_a_folder_is_refused_as_no_serial_port() {
    for path in [concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"), env!("CARGO_MANIFEST_DIR")] {
        let error = slipline_link::native::serial::open(path).err();
        assert_eq!(error, Some(LinkError::NotSerial(Port::Serial(path.to_owned()))));
    }
}
