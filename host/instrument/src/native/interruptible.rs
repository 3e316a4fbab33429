//! A link whose waits its user can interrupt, as by Ctrl-C.

use super::client::{BlockingLink, Client, GLANCE, wired};
use super::error::ClientError;
use crate::Link;
use crate::rig::PreparedRig;
use slipline_link::native::{Handle, Worker};
use slipline_link::{Outcome, Request, Snapshot, Ticket};
use std::cell::Cell;
use std::sync::Arc;
use std::time::{Duration, Instant};

thread_local! {
    /// The user has interrupted this thread, and the call under way has not ended yet.
    static INTERRUPTED: Cell<bool> = const { Cell::new(false) };
}

/// The link's thread, with waits in which the user is asked every 50 ms whether he interrupts. Then the drive is stopped at
/// once, and the call ends with [`ClientError::Interrupted`].
pub struct InterruptibleLink {
    worker: Worker,
    is_interrupted: Box<dyn Fn() -> bool + Send + Sync>,
}

impl Client<InterruptibleLink> {
    /// As [`Client::new`]; `is_interrupted` returns whether the user interrupts the calling thread.
    ///
    /// # Errors
    /// [`ClientError::Thread`].
    pub fn interruptible(
        rig: Option<&PreparedRig>,
        is_interrupted: impl Fn() -> bool + Send + Sync + 'static,
    ) -> Result<Self, ClientError> {
        let worker = wired(rig)?;
        Ok(Self::over(InterruptibleLink { worker, is_interrupted: Box::new(is_interrupted) }))
    }

    /// A handle of the link, for another thread.
    #[must_use]
    pub fn handle(&self) -> Handle {
        self.link().worker.handle()
    }
}

impl InterruptibleLink {
    /// Gives a sign of life, and asks the user; returns whether he interrupts.
    fn look(&self) -> bool {
        Handle::sign_of_life(&self.worker);
        if (self.is_interrupted)() {
            Handle::send(&self.worker, Request::Stop);
            INTERRUPTED.set(true);
        }
        INTERRUPTED.get()
    }

    /// Calls `wait` with parts of this time until it returns a result, the time is over, or the user interrupts.
    fn in_looks<T>(&self, time: Duration, mut wait: impl FnMut(Duration) -> Option<T>) -> Option<T> {
        let end = Instant::now() + time;
        loop {
            if self.look() {
                return None;
            }
            let left = end.saturating_duration_since(Instant::now());
            let found = wait(left.min(GLANCE));
            if found.is_some() || left.is_zero() {
                return found;
            }
        }
    }
}

impl Link for InterruptibleLink {
    fn send(&self, request: Request) -> Ticket {
        Handle::send(&self.worker, request)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Handle::snapshot(&self.worker)
    }
}

impl BlockingLink for InterruptibleLink {
    fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        self.in_looks(patience, |slice| Handle::wait(&self.worker, ticket, slice))
    }

    fn pause(&self, time: Duration) {
        let _: Option<()> = self.in_looks(time, |slice| {
            std::thread::sleep(slice);
            None
        });
    }

    fn sign_of_life(&self) {
        self.look();
    }

    fn send_awaited(&self, request: Request) -> Ticket {
        Handle::send_awaited(&self.worker, request)
    }

    fn release(&self, ticket: Ticket) {
        Handle::release(&self.worker, ticket);
    }

    fn take_interruption(&self) -> bool {
        INTERRUPTED.take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_link::protocol::event::State;
    use slipline_link::{DeviceTable, DriveRequest, Port, Sounding};
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn an_interruption_stops_the_drive_and_ends_the_call_that_waits() {
        let interrupts = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&interrupts);
        let client = Client::interruptible(None, move || asked.swap(false, Ordering::Relaxed)).unwrap();
        client.observe(&Port::Simulated).unwrap();
        let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
        let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
        client.use_table(Arc::new(table)).unwrap();
        client.arm().unwrap();
        let drive = || client.play(Sounding::Drive(DriveRequest::at(&[(0.05, 0.5)])));
        let state_after_the_ramp = || {
            client.wait_until(client.refresh().unwrap() + 100_000, || true).unwrap();
            client.snapshot().drive.status.unwrap().state
        };
        let at = drive().unwrap();

        interrupts.store(true, Ordering::Relaxed);
        let waited = client.wait_until(u64::MAX, || true);
        assert!(matches!(waited, Err(ClientError::Interrupted)), "{waited:?}");
        assert_eq!(state_after_the_ramp(), State::Armed);
        // A pause ends, and the drive after it does not begin.
        interrupts.store(true, Ordering::Relaxed);
        client.pause(Duration::from_secs(60));
        assert!(matches!(drive(), Err(ClientError::Interrupted)));
        assert_eq!(state_after_the_ramp(), State::Armed);
        // Each call was interrupted once.
        drive().unwrap();
        assert!(client.wait_until(at, || true).unwrap());
    }
}
