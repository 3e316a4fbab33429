//! The link on real pseudo-terminals and sockets: what the system does when the other end goes away.
#![cfg(unix)]

use serialport::{SerialPort, TTYPort};
use slipline_link::native::Watch;
use slipline_link::native::Worker;
use slipline_link::native::system_clock;
use slipline_link::native::{serial, socket};
use slipline_link::simulator::realtime::{RealtimeDevice, RealtimeLine};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Opener, Transport, Waker};
use slipline_link::{LinkError, LinkState, Outcome, Port, PortInfo, Request, Snapshot};
use std::io::{Read, Write};
use std::os::unix::net::UnixListener;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Longer than anything here takes; no length is asserted.
const REPLY_TIMEOUT: Duration = Duration::from_secs(20);

type Device = Arc<Mutex<RealtimeDevice>>;

fn device() -> Device {
    Arc::new(Mutex::new(RealtimeDevice::new(SimulatedDevice::new(Options::default()), system_clock())))
}

/// A device behind a byte stream, until it is dropped: then the stream is closed.
struct Cable {
    pulled: Arc<AtomicBool>,
    carrier: Option<JoinHandle<()>>,
}

impl Cable {
    /// `stream` must not wait long in a read.
    fn new(device: Device, mut stream: impl Read + Write + Send + 'static) -> Self {
        let pulled = Arc::new(AtomicBool::new(false));
        let is_pulled = pulled.clone();
        let carrier = thread::spawn(move || {
            let mut line = RealtimeLine::new(device, Waker::new(|| ()));
            let mut buffer = [0; 512];
            while !is_pulled.load(Ordering::Relaxed) {
                // Nothing yet, or nobody at the other end: the cable does not care.
                let count = stream.read(&mut buffer).unwrap_or(0);
                if count == 0 {
                    thread::sleep(Duration::from_millis(1));
                    continue;
                }
                line.write(&buffer[..count]).unwrap();
                while let Ok(count) = line.read(&mut buffer) {
                    if stream.write_all(&buffer[..count]).is_err() {
                        break;
                    }
                }
            }
        });
        Self { pulled, carrier: Some(carrier) }
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        self.pulled.store(true, Ordering::Relaxed);
        self.carrier.take().map(JoinHandle::join).unwrap().unwrap();
    }
}

/// A pseudo-terminal with a device at one end; returns the other end's name.
fn pseudo_terminal(device: &Device) -> (Cable, String) {
    let (mut master, slave) = TTYPort::pair().unwrap();
    master.set_timeout(Duration::from_millis(5)).unwrap();
    let name = slave.name().unwrap();
    // Closed and opened again by its name, as a board's port would be.
    drop(slave);
    (Cable::new(device.clone(), master), name)
}

/// Lists one board, by whatever name it has now; opens it as the program does.
struct Bus(Arc<Mutex<Option<String>>>);

impl Opener for Bus {
    type Transport = Box<dyn Watch>;

    fn list(&mut self) -> Vec<PortInfo> {
        let name = self.0.lock().unwrap().clone();
        name.map(|name| PortInfo {
            port: Port::Serial(name),
            label: "Slipline".to_owned(),
            is_ours: true,
            usb_serial: Some("0001".to_owned()),
        })
        .into_iter()
        .collect()
    }

    fn open(&mut self, port: &Port, _waker: &Waker) -> Result<Box<dyn Watch>, LinkError> {
        match port {
            Port::Serial(name) => Ok(Box::new(serial::open(name)?)),
            Port::Unix(path) => Ok(Box::new(socket::open(path)?)),
            Port::Simulated => Err(LinkError::NoSuchPort(port.clone())),
        }
    }
}

#[test]
fn a_pulled_terminal_is_found_again_under_another_name() {
    //
    let device = device();
    let (cable, first) = pseudo_terminal(&device);
    let bus = Arc::new(Mutex::new(Some(first.clone())));
    let worker = Worker::spawn_with(Bus(bus.clone()), || ()).unwrap();
    let connect = worker.send(Request::Connect(Port::Serial(first)));
    assert!(matches!(worker.wait(connect, REPLY_TIMEOUT), Some(Outcome::Done { .. })));

    *bus.lock().unwrap() = None;
    drop(cable);
    let lost = worker.handle().wait_for(REPLY_TIMEOUT, |snapshot| match &snapshot.link.state {
        LinkState::Reconnecting(trouble) => Some(trouble.clone()),
        _ => None,
    });
    assert_eq!(lost, Some(LinkError::Gone));

    let (_cable, second) = pseudo_terminal(&device);
    *bus.lock().unwrap() = Some(second.clone());
    let port = worker
        .handle()
        .wait_for(REPLY_TIMEOUT, |snapshot| snapshot.is_connected().then(|| snapshot.link.port.clone()));
    assert_eq!(port, Some(Some(Port::Serial(second))));
    let refresh = worker.send(Request::Refresh);
    assert!(matches!(worker.wait(refresh, REPLY_TIMEOUT), Some(Outcome::Done { .. })));
}

#[test]
fn a_socket_that_is_missing_at_the_start_is_connected_to_when_it_appears() {
    let path = std::env::temp_dir().join(format!("slipline-late-{}.sock", std::process::id()));
    let port = Port::Unix(path.clone());
    let worker = Worker::spawn_with(Bus(Arc::default()), || ()).unwrap();
    worker.send(Request::Connect(port.clone()));
    let waits = LinkState::Reconnecting(LinkError::NoSuchPort(port));
    let is_waiting = |snapshot: &Snapshot| (snapshot.link.state == waits).then_some(());
    assert!(
        worker.handle().wait_for(REPLY_TIMEOUT, is_waiting).is_some(),
        "{:?}",
        worker.snapshot().link.state
    );

    let listener = UnixListener::bind(&path).unwrap();
    let (stream, _) = listener.accept().unwrap();
    stream.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
    let _cable = Cable::new(device(), stream);
    let is_there = |snapshot: &Snapshot| snapshot.is_connected().then_some(());
    assert!(
        worker.handle().wait_for(REPLY_TIMEOUT, is_there).is_some(),
        "{:?}",
        worker.snapshot().link.state
    );
    drop(worker);
    std::fs::remove_file(path).unwrap();
}

#[test]
fn a_terminal_that_another_program_holds_is_busy() {
    let (_cable, name) = pseudo_terminal(&device());
    let _holder = serial::open(&name).unwrap();
    assert_eq!(serial::open(&name).err(), Some(LinkError::Busy(Port::Serial(name))));
}

#[test]
fn a_device_behind_a_unix_socket_answers_and_its_end_is_noticed() {
    let path = std::env::temp_dir().join(format!("slipline-{}.sock", std::process::id()));
    let listener = UnixListener::bind(&path).unwrap();
    let worker = Worker::spawn_with(Bus(Arc::default()), || ()).unwrap();
    worker.send(Request::AutoReconnect(false));
    let connect = worker.send(Request::Connect(format!("unix:{}", path.display()).parse().unwrap()));
    let (stream, _) = listener.accept().unwrap();
    stream.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
    let cable = Cable::new(device(), stream);
    assert!(matches!(worker.wait(connect, REPLY_TIMEOUT), Some(Outcome::Done { .. })));
    drop(cable);
    let lost = worker.handle().wait_for(REPLY_TIMEOUT, |snapshot| match &snapshot.link.state {
        LinkState::Lost(trouble) => Some(trouble.clone()),
        _ => None,
    });
    assert_eq!(lost, Some(LinkError::Gone));
    drop(worker);
    std::fs::remove_file(path).unwrap();
}
