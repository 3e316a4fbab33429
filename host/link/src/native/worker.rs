//! The thread that owns the port.
//!
//! It sleeps until a request is sent, bytes arrive or a step is due. [`Handle::send`] and
//! [`Handle::snapshot`] only take a lock that is held for a copy. When the worker is dropped, it stops and
//! disarms the device first. If the program panics, [`stop_on_panic`] sends a stop; if that fails, too, the
//! device's dead-man ends the drive. If the program hangs, it gives no sign of life
//! ([`Handle::sign_of_life`]), and this thread stops and disarms the device. If this thread panics, the
//! snapshot reports it ([`LinkError::Crashed`]), and no later request is carried out.

use super::handle::{Handle, Shared, lock};
use super::opener::{SystemOpener, system_clock};
use super::watch::{Wakes, Watch};
use crate::clock::Clock;
use crate::connection::{Connection, Nonces};
use crate::driver_watch::SIGN_PERIOD;
use crate::error::LinkError;
use crate::log::Severity;
use crate::recorder::Recorder;
use crate::request::{Outcome, Request, Ticket};
use crate::snapshot::{LinkState, Snapshot};
use crate::transport::{Opener, Waker};
use std::io;
use std::ops::Deref;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Time between two reads of a port that cannot wake the worker.
const READ_PERIOD: Duration = Duration::from_millis(2);
/// Time that the device has to acknowledge stop and disarm when the worker is dropped.
const QUIT_PATIENCE: Duration = Duration::from_millis(500);
/// Time after which a thread that hangs in the system's port is abandoned: the program ends without it.
const HANG_PATIENCE: Duration = Duration::from_millis(1000);

const WAKE: mio::Token = mio::Token(0);
const PORT: mio::Token = mio::Token(1);

/// The thread that owns the port; it dereferences to a [`Handle`].
pub struct Worker {
    handle: Handle,
    clock: Clock,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the worker on this computer's ports. `wake` is called on the worker's thread after every change
    /// that is worth a repaint.
    ///
    /// # Errors
    /// The system's error if it cannot create the thread or the poll.
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
        Self::spawn_in_time_of(system_clock(), opener, wake)
    }

    /// Starts the worker on other ports and with another clock, which it reads whenever it is woken
    /// ([`Handle::wake`]).
    ///
    /// # Errors
    /// As [`Worker::spawn`].
    pub fn spawn_in_time_of<O>(clock: Clock, opener: O, wake: impl Fn() + Send + 'static) -> io::Result<Self>
    where
        O: Opener<Transport: Watch> + 'static,
    {
        let poll = mio::Poll::new()?;
        let shared = Arc::new(Shared::new(mio::Waker::new(poll.registry(), WAKE)?, clock.clone()));
        let of_ports = shared.clone();
        let waker = Waker::new(move || {
            let _ = of_ports.waker.wake();
        });
        let mut connection = Connection::new(opener, waker, random_nonces());
        connection.keep_frames();
        connection.watch_driver();
        connection.keep_awaited(shared.awaited.clone());
        let of_thread = shared.clone();
        let thread = thread::Builder::new().name("link".to_owned()).spawn(move || {
            // After a panic the connection is dropped, in whatever state it is.
            let run = AssertUnwindSafe(|| run(connection, poll, &of_thread, &wake));
            if catch_unwind(run).is_err() {
                publish_crash(&of_thread);
                wake();
            }
        })?;
        Ok(Self { handle: Handle::of(shared), clock, thread: Some(thread) })
    }

    /// Waits for a request's outcome; the caller controls the device and gives signs of life meanwhile. Not
    /// for a thread that draws.
    #[must_use]
    pub fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        self.alive(patience, |slice| self.handle.wait(ticket, slice))
    }

    /// Sleeps; the caller controls the device and gives signs of life meanwhile.
    pub fn pause(&self, time: Duration) {
        let _: Option<()> = self.alive(time, |slice| {
            thread::sleep(slice);
            None
        });
    }

    /// Calls `wait` until it returns a result or this time is over by the worker's clock. Each call may wait
    /// at most [`SIGN_PERIOD`]; before each the caller gives a sign of life.
    fn alive<T>(&self, time: Duration, mut wait: impl FnMut(Duration) -> Option<T>) -> Option<T> {
        let end = (self.clock)().saturating_add(time);
        loop {
            self.handle.sign_of_life();
            let left = end.saturating_sub((self.clock)());
            let found = wait(left.min(SIGN_PERIOD));
            if found.is_some() || left.is_zero() {
                return found;
            }
        }
    }

    /// A handle for another thread.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.handle.clone()
    }
}

impl Deref for Worker {
    type Target = Handle;

    fn deref(&self) -> &Handle {
        &self.handle
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.handle.quit();
        if let Some(thread) = self.thread.take() {
            let by = (self.clock)() + HANG_PATIENCE;
            while !thread.is_finished() && (self.clock)() < by {
                thread::sleep(Duration::from_millis(1));
            }
        }
    }
}

/// Sends a stop when any thread of this program panics, then calls the previous panic hook.
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
    let clock = &shared.clock;
    let mut events = mio::Events::with_capacity(8);
    let mut quit_by: Option<Duration> = None;
    let mut read_period: Option<Duration> = None;
    loop {
        let now = clock();
        let (requests, quit) = {
            let mut inbox = lock(&shared.inbox);
            (std::mem::take(&mut inbox.requests), inbox.quit)
        };
        for (ticket, request) in requests {
            connection.request(ticket, request, now);
        }
        if quit && quit_by.is_none() {
            quit_by = Some(now + QUIT_PATIENCE);
            // Tickets are numbered from 1, so this one is awaited by no caller.
            connection.request(Ticket(0), Request::Disconnect, now);
        }
        connection.sign_of_life(shared.latest_sign());
        connection.step(now);
        if connection.take_sign_wanted() {
            lock(&shared.ask)();
        }
        if let Some(transport) = connection.take_new_transport() {
            let wakes = transport.watch(poll.registry(), PORT);
            read_period = (wakes.ok() != Some(Wakes::Itself)).then_some(READ_PERIOD);
        }
        let (is_changed, is_loud) = connection.take_changes();
        if is_changed {
            shared.publish(connection.view());
        }
        if is_loud {
            wake();
        }
        if quit_by.is_some_and(|by| !connection.is_open() || now >= by) {
            return;
        }
        let read_again = read_period.filter(|_| connection.is_open()).map(|period| now + period);
        let deadline = [connection.deadline(now), read_again, quit_by].into_iter().flatten().min();
        let timeout = deadline.map(|deadline| deadline.saturating_sub(clock()));
        match poll.poll(&mut events, timeout) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            // The system's poll has failed: continue by reading periodically.
            Err(_) => thread::sleep(READ_PERIOD),
        }
    }
}

/// Publishes the crash, so that the last snapshot before it is not taken for the present one.
fn publish_crash(shared: &Shared) {
    let mut recorder = Recorder::default();
    recorder.view = Snapshot::clone(&lock(&shared.snapshot));
    recorder.set_time(recorder.view.drive.status_time);
    recorder.forget_device(Some(LinkError::Crashed));
    recorder.link(LinkState::Lost(LinkError::Crashed));
    recorder.log(Severity::Error, format!("Connection lost: {}.", LinkError::Crashed));
    recorder.take_changes();
    shared.publish(&recorder.view);
}

/// Nonces from the system's random numbers.
fn random_nonces() -> Nonces {
    let mut drawn = 0u32;
    Box::new(move || {
        let mut nonce = [0; 4];
        if getrandom::fill(&mut nonce).is_err() {
            // A system without random numbers: the sessions of this process still differ.
            drawn = drawn.wrapping_add(1);
            nonce = (std::process::id().rotate_left(16) ^ drawn).to_le_bytes();
        }
        nonce
    })
}
