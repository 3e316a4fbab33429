//! Offers a simulated device to other programs, in real time: at a Unix socket or at a pseudo-terminal.
//!
//! ```text
//! other program ==bytes==> socket or terminal --> Server --> simulator::realtime --> the device application
//! ```
//! One program at a time has the device, as with a cable: the first one that sends something, until it disconnects. What
//! others at the socket receive meanwhile: `second_program.rs`. The device keeps its state between programs.

use super::second_program::SecondProgram;
use crate::simulator::realtime::{RealtimeDevice, RealtimeLine};
use crate::system_words::system_words;
use crate::transport::Waker;
use serialport::{SerialPort, TTYPort};
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::thread::{self, sleep};
use std::time::Duration;

/// Time limit of a read; afterwards the server checks whether it must end.
const READ_PATIENCE: Duration = Duration::from_millis(20);
/// Time after which the remaining bytes are written to a stream that is full now.
const WRITE_PAUSE: Duration = Duration::from_millis(1);
/// How long a program's command waits for the program before it to be gone: less than a host waits for an answer.
const SEAT_PATIENCE: Duration = Duration::from_millis(150);
const SEAT_PAUSE: Duration = Duration::from_millis(5);

/// Why the device cannot be served at a path.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The path is a file of another kind.
    #[error("{0} exists and is not a socket; it is not replaced")]
    NotASocket(PathBuf),
    /// Another program listens at the path.
    #[error("another program already serves at {0}")]
    InUse(PathBuf),
    /// Another system error.
    #[error("{path}: {}", system_words(.error))]
    Io {
        /// The path.
        path: PathBuf,
        /// The error.
        error: io::Error,
    },
}

enum Place {
    Socket(UnixListener),
    Terminal(TTYPort),
}

/// A path at which a simulated device is served. When it is dropped, a socket's file is removed.
pub struct Server {
    place: Place,
    path: PathBuf,
}

impl Server {
    /// Listens at a socket. A stale socket of an earlier program is replaced.
    ///
    /// # Errors
    /// [`ServeError`]: the path belongs to another file or another program, or another system error.
    pub fn at_socket(path: &Path) -> Result<Self, ServeError> {
        let io = |error| ServeError::Io { path: path.to_owned(), error };
        match std::fs::symlink_metadata(path) {
            Ok(found) if !found.file_type().is_socket() => {
                return Err(ServeError::NotASocket(path.to_owned()));
            }
            Ok(_) if UnixStream::connect(path).is_ok() => return Err(ServeError::InUse(path.to_owned())),
            Ok(_) => std::fs::remove_file(path).map_err(io)?,
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(io(error)),
        }
        let listener = UnixListener::bind(path).map_err(io)?;
        listener.set_nonblocking(true).map_err(io)?;
        Ok(Self { place: Place::Socket(listener), path: path.to_owned() })
    }

    /// Creates a pseudo-terminal: to other programs it is a serial port.
    ///
    /// # Errors
    /// [`ServeError::Io`]: a system error.
    pub fn at_terminal() -> Result<Self, ServeError> {
        let failed = |error: serialport::Error| ServeError::Io {
            path: PathBuf::from("pseudo-terminal"),
            error: error.into(),
        };
        let (mut master, slave) = TTYPort::pair().map_err(failed)?;
        master.set_timeout(READ_PATIENCE).map_err(failed)?;
        // Closed here, so that other programs can open it by its name; it keeps its settings.
        let path = PathBuf::from(slave.name().unwrap_or_default());
        Ok(Self { place: Place::Terminal(master), path })
    }

    /// The path of the socket or the terminal, for other programs.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Serves the device until `ended` is set. Other holders of the shared device may set its pins meanwhile.
    ///
    /// # Errors
    /// The system's error when listening fails, which sets `ended`; a program that disconnects is no error.
    pub fn serve(&mut self, device: Arc<Mutex<RealtimeDevice>>, ended: &AtomicBool) -> io::Result<()> {
        let line = || RealtimeLine::new(Arc::clone(&device), Waker::new(|| ()));
        match &mut self.place {
            Place::Terminal(master) => {
                let mut line = line();
                while !ended.load(Ordering::Relaxed) {
                    carry(master, ended, |bytes, answers| line.exchange(bytes, answers));
                    // No program has the terminal open.
                    sleep(READ_PATIENCE);
                }
                Ok(())
            }
            Place::Socket(listener) => {
                let seat = Mutex::new(());
                thread::scope(|programs| {
                    while !ended.load(Ordering::Relaxed) {
                        let accepted = listener.accept().and_then(|(stream, _)| {
                            stream.set_nonblocking(false)?;
                            stream.set_read_timeout(Some(READ_PATIENCE))?;
                            stream.set_write_timeout(Some(READ_PATIENCE))?;
                            let (line, seat) = (line(), &seat);
                            let attend = move || attend(stream, line, seat, ended);
                            thread::Builder::new().spawn_scoped(programs, attend).map(drop)
                        });
                        match accepted {
                            Ok(()) => {}
                            Err(error) if is_not_yet(&error) => sleep(READ_PATIENCE),
                            Err(error) => {
                                ended.store(true, Ordering::Relaxed);
                                return Err(error);
                            }
                        }
                    }
                    Ok(())
                })
            }
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Place::Socket(_) = self.place {
            // The file may have been removed already.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Answers one program at the socket until it disconnects: for the device while it has the seat, else as a second program.
fn attend(mut stream: UnixStream, mut line: RealtimeLine, seat: &Mutex<()>, ended: &AtomicBool) {
    let mut held = None;
    let mut second = SecondProgram::default();
    carry(&mut stream, ended, |bytes, answers| {
        if held.is_none() {
            second.receive(bytes);
            let patience = if second.stops() { Duration::ZERO } else { SEAT_PATIENCE };
            held = take_seat(seat, patience);
        }
        if held.is_some() {
            line.exchange(bytes, answers);
        } else {
            second.answer(&mut line, answers);
        }
    });
}

/// The seat, if it is free or becomes so within this time.
fn take_seat(seat: &Mutex<()>, patience: Duration) -> Option<MutexGuard<'_, ()>> {
    let mut left = patience;
    loop {
        match seat.try_lock() {
            Ok(guard) => return Some(guard),
            Err(TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) if left.is_zero() => return None,
            Err(TryLockError::WouldBlock) => sleep(SEAT_PAUSE),
        }
        left = left.saturating_sub(SEAT_PAUSE);
    }
}

/// Transfers bytes between one program and whatever answers it, until the program disconnects. While the program does not
/// read the replies, no more bytes are read from it.
fn carry(stream: &mut (impl Read + Write), ended: &AtomicBool, mut answer: impl FnMut(&[u8], &mut Vec<u8>)) {
    let mut buffer = [0; 1024];
    let mut answers: Vec<u8> = Vec::new();
    while !ended.load(Ordering::Relaxed) {
        if answers.is_empty() {
            match stream.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => answer(buffer.get(..count).unwrap_or_default(), &mut answers),
                Err(error) if is_not_yet(&error) => {}
                Err(_) => return,
            }
        } else {
            match stream.write(&answers) {
                Ok(count) => drop(answers.drain(..count.min(answers.len()))),
                Err(error) if is_not_yet(&error) => sleep(WRITE_PAUSE),
                Err(_) => return,
            }
        }
    }
}

fn is_not_yet(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
