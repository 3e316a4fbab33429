//! The handles of the worker: they send requests, read snapshots and give signs of life. Only the waits block.

use crate::awaited::Awaited;
use crate::clock::Clock;
use crate::request::{Outcome, Request, Ticket};
use crate::snapshot::Snapshot;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

#[derive(Default)]
pub(super) struct Inbox {
    pub(super) requests: Vec<(Ticket, Request)>,
    last: Ticket,
    pub(super) quit: bool,
}

/// State shared by the worker's thread and the handles.
pub(super) struct Shared {
    pub(super) inbox: Mutex<Inbox>,
    pub(super) snapshot: Mutex<Arc<Snapshot>>,
    published: Condvar,
    pub(super) waker: mio::Waker,
    /// The connection's time.
    pub(super) clock: Clock,
    /// When the latest sign of life was given, in microseconds of that clock; 0 before the first.
    sign_us: AtomicU64,
    pub(super) ask: Mutex<Ask>,
    /// The requests whose outcomes are kept for callers that wait.
    pub(super) awaited: Awaited,
}

/// Requests a sign of life from the driver (the loop that uses the device).
type Ask = Box<dyn Fn() + Send>;

impl Shared {
    /// Without requests and state; `waker` wakes the worker's thread, which uses `clock`.
    pub(super) fn new(waker: mio::Waker, clock: Clock) -> Self {
        Self {
            inbox: Mutex::default(),
            snapshot: Mutex::default(),
            published: Condvar::new(),
            waker,
            clock,
            sign_us: AtomicU64::default(),
            ask: Mutex::new(Box::new(|| ())),
            awaited: Awaited::default(),
        }
    }

    /// When the latest sign of life was given.
    pub(super) fn latest_sign(&self) -> Duration {
        Duration::from_micros(self.sign_us.load(Ordering::Relaxed))
    }

    /// Makes this the newest snapshot.
    pub(super) fn publish(&self, view: &Snapshot) {
        *lock(&self.snapshot) = Arc::new(view.clone());
        self.published.notify_all();
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Each value under these locks is complete at any time, even after a panic.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sends requests and reads snapshots. Clones are cheap and can be used on any thread.
#[derive(Clone)]
pub struct Handle(Arc<Shared>);

impl Handle {
    pub(super) const fn of(shared: Arc<Shared>) -> Self {
        Self(shared)
    }

    /// Has the worker stop and disarm the device, and end.
    pub(super) fn quit(&self) {
        lock(&self.0.inbox).quit = true;
        self.wake();
    }

    /// Wakes the worker for the steps that are due by its clock. If that fails, the worker wakes for the next
    /// keep-alive.
    pub fn wake(&self) {
        let _ = self.0.waker.wake();
    }

    /// Queues a request and returns at once. The outcome is kept until that of the 64th later request; a caller that waits on
    /// another thread than those of the other requests uses [`Handle::send_awaited`].
    pub fn send(&self, request: Request) -> Ticket {
        self.queue(request, |_| ())
    }

    /// As [`Handle::send`]; the outcome is kept until [`Handle::release`], however many requests of other threads end
    /// meanwhile.
    pub fn send_awaited(&self, request: Request) -> Ticket {
        self.queue(request, |ticket| self.0.awaited.keep(ticket))
    }

    /// Ends the wait for an outcome.
    pub fn release(&self, ticket: Ticket) {
        self.0.awaited.release(ticket);
    }

    fn queue(&self, request: Request, note: impl FnOnce(Ticket)) -> Ticket {
        let mut inbox = lock(&self.0.inbox);
        inbox.last.0 += 1;
        let ticket = inbox.last;
        note(ticket);
        inbox.requests.push((ticket, request));
        drop(inbox);
        self.wake();
        ticket
    }

    /// Gives a sign of life of the thread that controls the device. Only that thread may call it, from the
    /// loop that also handles the user's stop. While the device is armed it is due every
    /// [`SIGN_PERIOD`](crate::SIGN_PERIOD).
    pub fn sign_of_life(&self) {
        self.0.sign_us.store((self.0.clock)().as_micros() as u64, Ordering::Relaxed);
    }

    /// When the latest sign of life was given, by the worker's clock; zero before the first.
    #[must_use]
    pub fn latest_sign(&self) -> Duration {
        self.0.latest_sign()
    }

    /// Sets the function that requests a sign of life from the controlling thread, if that thread sleeps
    /// until it is woken. The function is called on the worker's thread while the device is armed, every
    /// [`SIGN_PERIOD`](crate::SIGN_PERIOD).
    pub fn ask_for_signs(&self, ask: impl Fn() + Send + 'static) {
        *lock(&self.0.ask) = Box::new(ask);
    }

    /// The newest snapshot of link and device.
    #[must_use]
    pub fn snapshot(&self) -> Arc<Snapshot> {
        lock(&self.0.snapshot).clone()
    }

    /// Waits until `fits` accepts a snapshot, or `patience` is over by the computer's clock.
    #[must_use]
    pub fn wait_for<T>(&self, patience: Duration, mut fits: impl FnMut(&Snapshot) -> Option<T>) -> Option<T> {
        let end = Instant::now() + patience;
        let mut snapshot = lock(&self.0.snapshot);
        loop {
            if let Some(found) = fits(&snapshot) {
                return Some(found);
            }
            let left = end.checked_duration_since(Instant::now())?;
            snapshot = self
                .0
                .published
                .wait_timeout(snapshot, left)
                .map_or_else(|poisoned| poisoned.into_inner().0, |(guard, _)| guard);
        }
    }

    /// Waits for a request's outcome. Not for a thread that draws.
    #[must_use]
    pub fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        self.wait_for(patience, |snapshot| snapshot.outcome(ticket).cloned())
    }
}
