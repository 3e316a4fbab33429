//! The thread that owns the port.
//!
//! It sleeps until a request comes, bytes arrive or something is due. [`Worker::send`] and [`Worker::snapshot`] only
//! take a lock that is held for a copy. When the worker is dropped, it stops and disarms the device first. If the
//! program panics, [`stop_on_panic`] sends a stop; if that fails, too, the device's dead-man ends the drive. If this
//! thread panics, the snapshot says so ([`LinkError::Crashed`]), and no later request is done.

use super::opener::SystemOpener;
use super::watch::{Wakes, Watch};
use crate::connection::{Connection, Nonces};
use crate::error::LinkError;
use crate::log::Severity;
use crate::recorder::Recorder;
use crate::request::{Outcome, Request, Ticket};
use crate::snapshot::{LinkState, Snapshot};
use crate::transport::{Opener, Waker};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// A port that cannot wake the worker is read this often.
const READ_PERIOD: Duration = Duration::from_millis(2);
/// When the worker is dropped, the device has so long to acknowledge stop and disarm.
const QUIT_PATIENCE: Duration = Duration::from_millis(500);
/// A thread that hangs in the system's port is left behind after so long: the program ends without it.
const HANG_PATIENCE: Duration = Duration::from_millis(1000);

const WAKE: mio::Token = mio::Token(0);
const PORT: mio::Token = mio::Token(1);

#[derive(Default)]
struct Inbox {
    requests: Vec<(Ticket, Request)>,
    last: Ticket,
    quit: bool,
}

struct Shared {
    inbox: Mutex<Inbox>,
    snapshot: Mutex<Arc<Snapshot>>,
    published: Condvar,
    waker: mio::Waker,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Each value under these locks is complete at any time, even after a panic.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sends requests and looks at snapshots. Cloning is cheap; any thread may hold one.
#[derive(Clone)]
pub struct Handle(Arc<Shared>);

impl Handle {
    /// Hands a request over and returns at once.
    pub fn send(&self, request: Request) -> Ticket {
        let mut inbox = lock(&self.0.inbox);
        inbox.last.0 += 1;
        let ticket = inbox.last;
        inbox.requests.push((ticket, request));
        drop(inbox);
        // A poll that cannot be woken comes round by itself for the next keep-alive.
        let _ = self.0.waker.wake();
        ticket
    }

    /// The newest picture of link and device.
    #[must_use]
    pub fn snapshot(&self) -> Arc<Snapshot> {
        lock(&self.0.snapshot).clone()
    }

    /// Waits until a snapshot fits, or `patience` is over.
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

    /// Waits for a request's end. Not for a thread that paints.
    #[must_use]
    pub fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        self.wait_for(patience, |snapshot| snapshot.outcome(ticket).cloned())
    }
}

/// The thread that owns the port.
pub struct Worker {
    handle: Handle,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the worker on this computer's ports. `wake` is called, on the worker's thread, whenever something worth
    /// a repaint has changed.
    ///
    /// # Errors
    /// What the system says when it gives no thread or no poll.
    pub fn spawn(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        Self::spawn_with(SystemOpener::default(), wake)
    }

    /// Starts the worker on other ports.
    ///
    /// # Errors
    /// As [`Worker::spawn`].
    pub fn spawn_with<O>(opener: O, wake: impl Fn() + Send + 'static) -> io::Result<Self>
    where
        O: Opener<Transport: Watch> + 'static,
    {
        let poll = mio::Poll::new()?;
        let shared = Arc::new(Shared {
            inbox: Mutex::default(),
            snapshot: Mutex::default(),
            published: Condvar::new(),
            waker: mio::Waker::new(poll.registry(), WAKE)?,
        });
        let of_ports = shared.clone();
        let waker = Waker::new(move || {
            let _ = of_ports.waker.wake();
        });
        let mut connection = Connection::new(opener, waker, random_nonces());
        connection.keep_frames();
        let of_thread = shared.clone();
        let thread = thread::Builder::new().name("link".to_owned()).spawn(move || {
            // After a panic the connection is dropped with whatever it left incomplete.
            let run = AssertUnwindSafe(|| run(connection, poll, &of_thread, &wake));
            if catch_unwind(run).is_err() {
                tell_crash(&of_thread);
                wake();
            }
        })?;
        Ok(Self { handle: Handle(shared), thread: Some(thread) })
    }

    /// Hands a request over and returns at once.
    pub fn send(&self, request: Request) -> Ticket {
        self.handle.send(request)
    }

    /// The newest picture of link and device.
    #[must_use]
    pub fn snapshot(&self) -> Arc<Snapshot> {
        self.handle.snapshot()
    }

    /// Waits for a request's end. Not for a thread that paints.
    #[must_use]
    pub fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        self.handle.wait(ticket, patience)
    }

    /// A way to send and look for other threads.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        lock(&self.handle.0.inbox).quit = true;
        let _ = self.handle.0.waker.wake();
        if let Some(thread) = self.thread.take() {
            let by = Instant::now() + HANG_PATIENCE;
            while !thread.is_finished() && Instant::now() < by {
                thread::sleep(Duration::from_millis(1));
            }
        }
    }
}

/// Sends a stop when any thread of this program panics, then does what was done before.
pub fn stop_on_panic(handle: Handle) {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        handle.send(Request::Stop);
        before(info);
    }));
}

fn run<O: Opener<Transport: Watch>>(
    mut connection: Connection<O>,
    mut poll: mio::Poll,
    shared: &Shared,
    wake: &impl Fn(),
) {
    let since = Instant::now();
    let mut events = mio::Events::with_capacity(8);
    let mut quit_by: Option<Duration> = None;
    let mut read_period: Option<Duration> = None;
    loop {
        let now = since.elapsed();
        let (requests, quit) = {
            let mut inbox = lock(&shared.inbox);
            (std::mem::take(&mut inbox.requests), inbox.quit)
        };
        for (ticket, request) in requests {
            connection.request(ticket, request, now);
        }
        if quit && quit_by.is_none() {
            quit_by = Some(now + QUIT_PATIENCE);
            // Tickets are numbered from 1, so nobody waits for this one.
            connection.request(Ticket(0), Request::Disconnect, now);
        }
        connection.step(now);
        if let Some(transport) = connection.take_new_transport() {
            let wakes = transport.watch(poll.registry(), PORT);
            read_period = (wakes.ok() != Some(Wakes::Itself)).then_some(READ_PERIOD);
        }
        let (is_changed, is_loud) = connection.take_changes();
        if is_changed {
            publish(shared, connection.view());
        }
        if is_loud {
            wake();
        }
        if quit_by.is_some_and(|by| !connection.is_open() || now >= by) {
            return;
        }
        let read_again = read_period.filter(|_| connection.is_open()).map(|period| now + period);
        let deadline = [connection.deadline(now), read_again, quit_by].into_iter().flatten().min();
        let timeout = deadline.map(|deadline| deadline.saturating_sub(since.elapsed()));
        match poll.poll(&mut events, timeout) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            // A system that cannot wait any more: go on slowly.
            Err(_) => thread::sleep(READ_PERIOD),
        }
    }
}

fn publish(shared: &Shared, view: &Snapshot) {
    *lock(&shared.snapshot) = Arc::new(view.clone());
    shared.published.notify_all();
}

/// Publishes the crash, so that nobody takes the last snapshot before it for the present one.
fn tell_crash(shared: &Shared) {
    let mut recorder = Recorder::default();
    recorder.view = Snapshot::clone(&lock(&shared.snapshot));
    recorder.set_time(recorder.view.status_time);
    recorder.forget_device(Some(LinkError::Crashed));
    recorder.link(LinkState::Lost(LinkError::Crashed));
    recorder.log(Severity::Error, format!("Connection lost: {}.", LinkError::Crashed));
    recorder.take_changes();
    publish(shared, &recorder.view);
}

/// Nonces from the system's random numbers.
fn random_nonces() -> Nonces {
    let mut drawn = 0u32;
    Box::new(move || {
        let mut nonce = [0; 4];
        if getrandom::fill(&mut nonce).is_err() {
            // A system without random numbers: the sessions of this process differ all the same.
            drawn = drawn.wrapping_add(1);
            nonce = (std::process::id().rotate_left(16) ^ drawn).to_le_bytes();
        }
        nonce
    })
}
