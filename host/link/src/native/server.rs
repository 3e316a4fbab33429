//! Offers a simulated device to other programs, in real time: at a Unix socket or at a pseudo-terminal.
//!
//! ```text
//! other program ==bytes==> socket or terminal --> Server --> simulator::realtime --> the device application
//! ```
//! One program at a time is connected to the device, as with a cable. The device keeps its state between programs.

use crate::simulator::realtime::{RealtimeDevice, RealtimeLine};
use crate::transport::{Transport, Waker};
use serialport::{SerialPort, TTYPort};
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::Duration;

/// Time limit of a read; after it the server checks whether it must end.
const READ_PATIENCE: Duration = Duration::from_millis(20);
/// Time after which the rest is written to a stream that takes no more bytes now.
const WRITE_PAUSE: Duration = Duration::from_millis(1);

/// Why nothing can be offered at a path.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// A file of another kind is there.
    #[error("{0} is there already and is not a socket; it is not replaced")]
    NotASocket(PathBuf),
    /// Another program listens there.
    #[error("another program already serves at {0}")]
    InUse(PathBuf),
    /// Something else the system said.
    #[error("{path}: {error}")]
    Io {
        /// Where.
        path: PathBuf,
        /// What.
        error: io::Error,
    },
}

enum Place {
    Socket(UnixListener),
    Terminal(TTYPort),
}

/// A place at which a simulated device is offered. When it is dropped, a socket's file is removed.
pub struct Server {
    place: Place,
    path: PathBuf,
}

impl Server {
    /// Listens at a socket. One that a program left behind is replaced.
    ///
    /// # Errors
    /// [`ServeError`]: the path belongs to another file or another program, or what the system says.
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

    /// Makes a pseudo-terminal: to other programs it is a serial port.
    ///
    /// # Errors
    /// [`ServeError::Io`]: what the system says.
    pub fn at_terminal() -> Result<Self, ServeError> {
        let failed = |error: serialport::Error| ServeError::Io {
            path: PathBuf::from("pseudo-terminal"),
            error: error.into(),
        };
        let (mut master, slave) = TTYPort::pair().map_err(failed)?;
        master.set_timeout(READ_PATIENCE).map_err(failed)?;
        // It is closed here, so that other programs can open it by its name; it keeps its settings.
        let path = PathBuf::from(slave.name().unwrap_or_default());
        Ok(Self { place: Place::Terminal(master), path })
    }

    /// Where programs find the device: the socket's or the terminal's path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Serves the device until `ended` is set. Other holders of the shared device may set its pins meanwhile.
    ///
    /// # Errors
    /// What the system says when the listening itself fails; a program that goes away is no error.
    pub fn serve(&mut self, device: Arc<Mutex<RealtimeDevice>>, ended: &AtomicBool) -> io::Result<()> {
        // It is read right after it is written.
        let mut line = RealtimeLine::new(device, Waker::new(|| ()));
        while !ended.load(Ordering::Relaxed) {
            match &mut self.place {
                Place::Terminal(master) => {
                    carry(master, &mut line, ended);
                    // Nobody has the terminal open.
                    sleep(READ_PATIENCE);
                }
                Place::Socket(listener) => match listener.accept() {
                    Ok((mut stream, _)) => {
                        stream.set_nonblocking(false)?;
                        stream.set_read_timeout(Some(READ_PATIENCE))?;
                        stream.set_write_timeout(Some(READ_PATIENCE))?;
                        carry(&mut stream, &mut line, ended);
                    }
                    Err(error) if is_not_yet(&error) => sleep(READ_PATIENCE),
                    Err(error) => return Err(error),
                },
            }
        }
        Ok(())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Place::Socket(_) = self.place {
            // One that is gone already need not be removed.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Carries bytes between one program and the device until the program goes away. While it does not take the device's
/// answers, nothing more is read from it.
fn carry(stream: &mut (impl Read + Write), line: &mut RealtimeLine, ended: &AtomicBool) {
    let mut buffer = [0; 1024];
    let mut answers: Vec<u8> = Vec::new();
    while !ended.load(Ordering::Relaxed) {
        if answers.is_empty() {
            let received = match stream.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => buffer.get(..count).unwrap_or_default(),
                Err(error) if is_not_yet(&error) => continue,
                Err(_) => return,
            };
            // A simulated device takes everything.
            let _ = line.write(received);
            while let Ok(count) = line.read(&mut buffer) {
                answers.extend_from_slice(buffer.get(..count).unwrap_or_default());
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
