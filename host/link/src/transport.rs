//! The byte stream between link and device, and its opening.

use crate::error::LinkError;
use crate::port::{Port, PortInfo};
use std::io;
use std::sync::Arc;

/// A byte stream to a device. Reads and writes may block for a few milliseconds at most.
pub trait Transport: Send {
    /// Reads the received bytes. `Ok(0)` means that the other end has closed; an error of kind `WouldBlock`,
    /// `TimedOut` or `Interrupted` that no bytes have arrived.
    ///
    /// # Errors
    /// As above, or a system error.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Writes as many bytes as the other end accepts now. `Ok(0)` and errors mean the same as in
    /// [`Transport::read`].
    ///
    /// # Errors
    /// As above, or a system error.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// Whether the port is open. A browser answers later than it is asked: until then nothing is written, and
    /// [`Transport::read`] has no bytes or the error of the opening. Such a transport wakes its worker when that changes.
    fn is_open(&self) -> bool {
        true
    }
}

impl<T: Transport + ?Sized> Transport for Box<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        (**self).read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (**self).write(bytes)
    }

    fn is_open(&self) -> bool {
        (**self).is_open()
    }
}

/// Reads from the bytes that a transport has received already, as [`Transport::read`] does.
///
/// # Errors
/// `WouldBlock` if there are none.
pub fn read_received(received: &mut Vec<u8>, buffer: &mut [u8]) -> io::Result<usize> {
    if received.is_empty() {
        return Err(io::ErrorKind::WouldBlock.into());
    }
    let count = buffer.len().min(received.len());
    for (to, from) in buffer.iter_mut().zip(received.drain(..count)) {
        *to = from;
    }
    Ok(count)
}

/// Wakes the worker from its wait. Clones wake the same worker.
#[derive(Clone)]
pub struct Waker(Arc<dyn Fn() + Send + Sync>);

impl Waker {
    /// A waker that calls `wake`.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self(Arc::new(wake))
    }

    /// Wakes the worker.
    pub fn wake(&self) {
        (self.0)();
    }
}

/// Lists and opens ports. The worker has one for this computer's ports; tests and the simulation supply their
/// own.
pub trait Opener: Send {
    /// An open port.
    type Transport: Transport;

    /// The ports that exist now.
    fn list(&mut self) -> Vec<PortInfo>;

    /// Opens a port. A transport that cannot be registered with a poll calls `waker` when bytes arrive.
    ///
    /// # Errors
    /// Why the port cannot be opened.
    fn open(&mut self, port: &Port, waker: &Waker) -> Result<Self::Transport, LinkError>;
}
