//! How long a program may leave an armed device alone.
//!
//! The time counts from the end of the latest call; while a call runs, the program is at the device.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The calls of a program.
pub(super) struct Attention {
    limit: Duration,
    latest: Mutex<Instant>,
    running: AtomicU32,
    is_over: AtomicBool,
}

/// A call under way.
pub(super) struct Call<'a>(&'a Attention);

impl Attention {
    pub(super) fn new(limit: Duration) -> Self {
        Self {
            limit,
            latest: Mutex::new(Instant::now()),
            running: AtomicU32::new(0),
            is_over: AtomicBool::new(false),
        }
    }

    pub(super) const fn limit(&self) -> Duration {
        self.limit
    }

    /// A call begins; `None` if none came for too long before it. Calls after that one start afresh.
    pub(super) fn begin(&self) -> Option<Call<'_>> {
        self.running.fetch_add(1, Ordering::SeqCst);
        let call = Call(self);
        (!self.is_over.swap(false, Ordering::SeqCst)).then_some(call)
    }

    /// Whether no call has come for too long; the next one is then refused.
    pub(super) fn ends(&self) -> bool {
        let ends = self.running.load(Ordering::SeqCst) == 0 && self.latest().elapsed() > self.limit;
        self.is_over.fetch_or(ends, Ordering::SeqCst);
        ends
    }

    fn latest(&self) -> Instant {
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Call<'_> {
    fn drop(&mut self) {
        *self.0.latest.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
        self.0.running.fetch_sub(1, Ordering::SeqCst);
    }
}
