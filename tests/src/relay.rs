//! A port for a host program, with a device behind it and a hand on the commands in between.
//!
//! ```text
//! host program --Unix socket--> Relay --alter(command)--> device
//!              <---------------       <-----------------
//! ```

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use slipline::link::pace::{PacedDevice, PacedLine};
use slipline::link::simulated::{Options, SimulatedDevice};
use slipline::link::transport::{Transport, Waker};
use slipline_protocol::{Command, Decoder};

/// What becomes of every command on its way.
pub type Alter = fn(&mut Command);

/// Nothing becomes of it.
pub const fn unaltered(_: &mut Command) {}

/// How long it waits for the host's bytes before it looks for the device's.
const GLANCE: Duration = Duration::from_millis(2);

/// A relay; it ends with this value.
pub struct Relay {
    path: PathBuf,
    ended: Arc<AtomicBool>,
    carrier: Option<JoinHandle<()>>,
}

impl Relay {
    /// A port with this device behind it: one host at a time, one after the other.
    ///
    /// # Panics
    /// If no socket can be made.
    #[must_use]
    pub fn to(mut device: Box<dyn Transport>, alter: Alter) -> Self {
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("slipline-{}-{number}.relay", std::process::id()));
        let listener = UnixListener::bind(&path).expect("a socket can be made");
        listener.set_nonblocking(true).expect("a socket need not wait");
        let ended = Arc::new(AtomicBool::new(false));
        let is_ended = ended.clone();
        let carrier = thread::spawn(move || {
            while !is_ended.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((host, _)) => carry(host, device.as_mut(), alter, &is_ended),
                    Err(_) => thread::sleep(GLANCE),
                }
            }
        });
        Self { path, ended, carrier: Some(carrier) }
    }

    /// A port with a simulated device behind it, in real time.
    #[must_use]
    pub fn to_simulated(options: Options, alter: Alter) -> Self {
        let device = Arc::new(Mutex::new(PacedDevice::new(SimulatedDevice::new(options))));
        Self::to(Box::new(PacedLine::new(device, Waker::new(|| ()))), alter)
    }

    /// The port's name, as the command line takes it.
    #[must_use]
    pub fn port(&self) -> String {
        format!("unix:{}", self.path.display())
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        // A carrier that has panicked has said so; a socket that is gone need not be removed.
        let _carried = self.carrier.take().map(JoinHandle::join);
        let _removed = std::fs::remove_file(&self.path);
    }
}

/// Until the host goes away.
fn carry(mut host: UnixStream, device: &mut dyn Transport, alter: Alter, ended: &AtomicBool) {
    host.set_nonblocking(false).expect("a socket may wait");
    host.set_read_timeout(Some(GLANCE)).expect("a time-out can be set");
    let mut decoder = Decoder::new();
    let mut bytes = [0; 512];
    while !ended.load(Ordering::Relaxed) {
        match host.read(&mut bytes) {
            Ok(0) => return,
            Ok(count) => {
                for &byte in &bytes[..count] {
                    let frame = decoder.push(byte, |frame| {
                        let mut command = Command::decode(frame.header.id, frame.body).ok()?;
                        alter(&mut command);
                        command.frame(frame.header.session, frame.header.sequence).ok()
                    });
                    if let Some(frame) = frame.flatten() {
                        hand_over(device, &frame);
                    }
                }
            }
            Err(error) if is_waiting(error.kind()) => {}
            Err(_) => return,
        }
        while let Ok(count @ 1..) = device.read(&mut bytes) {
            if host.write_all(&bytes[..count]).is_err() {
                return;
            }
        }
    }
}

fn hand_over(device: &mut dyn Transport, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        match device.write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if is_waiting(error.kind()) => thread::sleep(GLANCE),
            Err(error) => panic!("the device is gone: {error}"),
        }
    }
}

fn is_waiting(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
