//! The byte stream between link and device, and how it is opened.

use crate::error::LinkError;
use crate::port::{Port, PortInfo};
use std::io;
use std::sync::Arc;

/// A byte stream to a device. Neither reading nor writing may wait for more than a few milliseconds.
pub trait Transport: Send {
    /// Reads what has arrived. `Ok(0)` means the other end is gone; an error of kind `WouldBlock`, `TimedOut` or
    /// `Interrupted` that nothing has arrived.
    ///
    /// # Errors
    /// As above, or whatever the system says.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Writes as much as the other end takes now. `Ok(0)` and errors mean the same as in [`Transport::read`].
    ///
    /// # Errors
    /// As above, or whatever the system says.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;
}

impl<T: Transport + ?Sized> Transport for Box<T> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        (**self).read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (**self).write(bytes)
    }
}

/// Reads from what a transport has received already, as [`Transport::read`] does.
///
/// # Errors
/// `WouldBlock` when there is nothing.
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

/// Wakes the worker from its wait. Cloning is cheap.
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

/// Finds ports and opens them. The worker has one for this computer's ports; tests and the simulation bring their own.
pub trait Opener: Send {
    /// An open port.
    type Transport: Transport;

    /// The ports that exist now.
    fn list(&mut self) -> Vec<PortInfo>;

    /// Opens one. A transport that no poll can watch calls `waker` when bytes arrive.
    ///
    /// # Errors
    /// Why it cannot be opened.
    fn open(&mut self, port: &Port, waker: &Waker) -> Result<Self::Transport, LinkError>;
}
