//! Registration of transports with the worker's poll, which wakes when bytes arrive.

use crate::transport::Transport;
use std::io;

/// A transport that can wake the worker.
pub trait Watch: Transport {
    /// Registers the transport so that `registry`'s poll returns with `token` when bytes arrive. The default
    /// is for a transport that calls the [`Waker`](crate::transport::Waker) given when it was opened.
    ///
    /// # Errors
    /// A system error.
    fn watch(&mut self, _registry: &mio::Registry, _token: mio::Token) -> io::Result<Wakes> {
        Ok(Wakes::Itself)
    }
}

impl<T: Watch + ?Sized> Watch for Box<T> {
    fn watch(&mut self, registry: &mio::Registry, token: mio::Token) -> io::Result<Wakes> {
        (**self).watch(registry, token)
    }
}

/// Whether a transport signals the arrival of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wakes {
    /// Yes: the poll it is registered with returns, or it calls its waker.
    Itself,
    /// No: it must be read every few milliseconds.
    Never,
}
