//! A proxy between a host program and a device: a Unix socket that passes frames on and can change the commands.
//!
//! ```text
//! host program --Unix socket--> CommandProxy --alter(command)--> device
//!              <---------------       <-----------------
//! ```

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use slipline_link::native::system_clock;
use slipline_link::simulator::realtime::{RealtimeDevice, RealtimeLine};
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_link::transport::{Transport, Waker};
use slipline_protocol::version::Minor;
use slipline_protocol::{Command, Decoder};

/// Changes a command on its way to the device.
pub type Alter = fn(&mut Command);

/// Leaves every command as it is.
pub const fn unaltered(_: &mut Command) {}

/// How long the proxy waits for the host's bytes before it looks for the device's.
const POLL_TIMEOUT: Duration = Duration::from_millis(2);

/// A running proxy; dropping it ends it.
pub struct CommandProxy {
    path: PathBuf,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl CommandProxy {
    /// A proxy for a simulated device, in real time. It serves one host at a time.
    ///
    /// # Panics
    /// If no socket can be made.
    #[must_use]
    pub fn for_simulated(options: Options, alter: Alter) -> Self {
        let device = Arc::new(Mutex::new(RealtimeDevice::new(SimulatedDevice::new(options), system_clock())));
        let mut device = RealtimeLine::new(device, Waker::new(|| ()));
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let number = STARTED.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("slipline-{}-{number}.proxy", std::process::id()));
        let listener = UnixListener::bind(&path).expect("a socket can be made");
        listener.set_nonblocking(true).expect("a socket need not wait");
        let ended = Arc::new(AtomicBool::new(false));
        let is_ended = ended.clone();
        let thread = thread::spawn(move || {
            while !is_ended.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((host, _)) => forward(host, &mut device, alter, &is_ended),
                    Err(_) => thread::sleep(POLL_TIMEOUT),
                }
            }
        });
        Self { path, ended, thread: Some(thread) }
    }

    /// The port's name as `--port` takes it.
    #[must_use]
    pub fn port(&self) -> String {
        format!("unix:{}", self.path.display())
    }
}

impl Drop for CommandProxy {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        // A thread that panicked has printed why; a socket that is gone need not be removed.
        let _carried = self.thread.take().map(JoinHandle::join);
        let _removed = std::fs::remove_file(&self.path);
    }
}

/// Passes bytes in both directions until the host closes the socket.
fn forward(mut host: UnixStream, device: &mut dyn Transport, alter: Alter, ended: &AtomicBool) {
    host.set_nonblocking(false).expect("a socket may wait");
    host.set_read_timeout(Some(POLL_TIMEOUT)).expect("a time-out can be set");
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
                        command.frame_for(Minor::OURS, frame.header.session, frame.header.sequence).ok()
                    });
                    if let Some(frame) = frame.flatten() {
                        write_all(device, &frame);
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

fn write_all(device: &mut dyn Transport, mut bytes: &[u8]) {
    while !bytes.is_empty() {
        match device.write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if is_waiting(error.kind()) => thread::sleep(POLL_TIMEOUT),
            Err(error) => panic!("the device is gone: {error}"),
        }
    }
}

fn is_waiting(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
