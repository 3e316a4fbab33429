//! A Unix domain socket as a transport: an emulator's serial line.

use super::watch::{Wakes, Watch};
use crate::error::LinkError;
use crate::port::Port;
use crate::transport::Transport;
use mio::net::UnixStream;
use std::io::{self, Read, Write};
use std::path::Path;

/// A connected socket.
pub struct Socket(UnixStream);

/// Connects to the socket at `path`.
///
/// # Errors
/// [`LinkError`]: no program listens there, no permission, or another system error.
pub fn open(path: &Path) -> Result<Socket, LinkError> {
    UnixStream::connect(path)
        .map(Socket)
        .map_err(|error| LinkError::opening(&Port::Unix(path.to_owned()), &error))
}

impl From<std::os::unix::net::UnixStream> for Socket {
    /// One end of a connected pair; it must not block.
    fn from(stream: std::os::unix::net::UnixStream) -> Self {
        Self(UnixStream::from_std(stream))
    }
}

impl Transport for Socket {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }
}

impl Watch for Socket {
    fn watch(&mut self, registry: &mio::Registry, token: mio::Token) -> io::Result<Wakes> {
        registry.register(&mut self.0, token, mio::Interest::READABLE)?;
        Ok(Wakes::Itself)
    }
}
