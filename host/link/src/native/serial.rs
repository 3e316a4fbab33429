//! A serial port as a transport: native USB (CDC-ACM) or a UART behind a USB bridge.
//!
//! The port is opened exclusively, raw, 8N1, with DTR set, which some bridges need and Slipline does not.
//! Reads and writes do not block (on Windows, only briefly). Where the system can signal the arrival of bytes
//! (all but Windows), the worker sleeps until then; elsewhere it reads every few milliseconds.

use super::watch::{Wakes, Watch};
use crate::error::LinkError;
use crate::port::Port;
use crate::system_words::is_no_terminal;
use crate::transport::Transport;
use serialport::{ErrorKind, SerialPort};
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

/// The baud rate of boards with a UART; native USB ignores it.
pub(crate) const BAUD_RATE: u32 = 921_600;

/// Time limit of a read or a write. On Windows, zero would make a write wait without limit.
const PATIENCE: Duration = Duration::from_millis(if cfg!(windows) { 2 } else { 0 });

#[cfg(unix)]
type Native = serialport::TTYPort;
#[cfg(windows)]
type Native = serialport::COMPort;

/// An open serial port.
pub struct Serial(Native);

/// Opens a serial port by its system name.
///
/// # Errors
/// [`LinkError`]: no such port, in use, no permission, or another system error.
pub fn open(name: &str) -> Result<Serial, LinkError> {
    let port = Port::Serial(name.to_owned());
    let builder = serialport::new(name, BAUD_RATE).dtr_on_open(true).timeout(PATIENCE);
    let path = Path::new(name);
    let native = Native::open(&builder).map_err(|error| {
        if matches!(error.kind, ErrorKind::NoDevice) && path.exists() {
            // The crate reports "no device" also for a port that another program has locked.
            LinkError::Busy(port.clone())
        } else if path.is_file() || path.is_dir() || is_socket(path) || is_no_terminal(&error) {
            LinkError::NotSerial(port.clone())
        } else {
            LinkError::opening(&port, &io::Error::from(error))
        }
    })?;
    // Discards bytes that arrived for the port's previous program.
    native.clear(serialport::ClearBuffer::All).ok();
    Ok(Serial(native))
}

/// Whether it is the socket of a served device, which has another name as a port.
#[cfg(unix)]
fn is_socket(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    path.metadata().is_ok_and(|it| it.file_type().is_socket())
}

#[cfg(not(unix))]
const fn is_socket(_path: &Path) -> bool {
    false
}

impl Transport for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes)? {
            // Windows reports a time-out so; a removed port gives an error.
            0 => Err(io::ErrorKind::TimedOut.into()),
            count => Ok(count),
        }
    }
}

impl Watch for Serial {
    #[cfg(unix)]
    fn watch(&mut self, registry: &mio::Registry, token: mio::Token) -> io::Result<Wakes> {
        use std::os::fd::AsRawFd;
        let descriptor = self.0.as_raw_fd();
        registry.register(&mut mio::unix::SourceFd(&descriptor), token, mio::Interest::READABLE)?;
        Ok(Wakes::Itself)
    }

    #[cfg(not(unix))]
    fn watch(&mut self, _registry: &mio::Registry, _token: mio::Token) -> io::Result<Wakes> {
        Ok(Wakes::Never)
    }
}
