//! How the worker's poll learns that a transport has bytes to read.

use crate::transport::Transport;
use std::io;

/// A transport that the worker can sleep on.
pub trait Watch: Transport {
    /// Asks for `registry`'s poll to return with `token` when bytes arrive. The default is for a transport that calls
    /// the [`Waker`](crate::transport::Waker) it was opened with.
    ///
    /// # Errors
    /// Whatever the system says.
    fn watch(&mut self, _registry: &mio::Registry, _token: mio::Token) -> io::Result<Wakes> {
        Ok(Wakes::Itself)
    }
}

impl<T: Watch + ?Sized> Watch for Box<T> {
    fn watch(&mut self, registry: &mio::Registry, token: mio::Token) -> io::Result<Wakes> {
        (**self).watch(registry, token)
    }
}

/// Whether a transport signals that bytes have arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wakes {
    /// It does: the poll it is registered with returns, or it calls its waker.
    Itself,
    /// It does not: read it every few milliseconds.
    Never,
}
