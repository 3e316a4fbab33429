//! A clock that a test turns, for workers on their own threads: no verdict depends on the computer's speed.

use slipline_link::Clock;
use slipline_link::native::Handle;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The limit of a wait, reached only by a hang. No test asserts how long anything took.
pub const HANG: Duration = Duration::from_secs(120);

/// Waits until this is so.
///
/// # Panics
/// If it is not after [`HANG`].
pub fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < HANG, "never {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The time of a test.
#[derive(Clone)]
pub struct TurnedClock(Arc<Time>);

struct Time {
    us: AtomicU64,
    /// Number of times that the link's thread has read it.
    looks: AtomicU64,
}

impl Default for TurnedClock {
    /// It begins at a second: a sign of life at zero would be none.
    fn default() -> Self {
        Self(Arc::new(Time { us: AtomicU64::new(1_000_000), looks: AtomicU64::default() }))
    }
}

impl TurnedClock {
    /// The clock for a worker or a simulated device.
    #[must_use]
    pub fn clock(&self) -> Clock {
        let time = self.clone();
        Arc::new(move || {
            let now = time.now();
            if std::thread::current().name() == Some("link") {
                time.0.looks.fetch_add(1, Ordering::SeqCst);
            }
            now
        })
    }

    /// The time.
    #[must_use]
    pub fn now(&self) -> Duration {
        Duration::from_micros(self.0.us.load(Ordering::SeqCst))
    }

    /// Turns it at once by this time; a worker notices it when it looks next.
    pub fn jump(&self, time: Duration) {
        self.0.us.fetch_add(time.as_micros() as u64, Ordering::SeqCst);
    }

    /// Turns it by this time, step by step; `step_done` is called once the worker has done what is due after each.
    ///
    /// # Panics
    /// If the worker hangs.
    pub fn turn(&self, worker: &Handle, time: Duration, mut step_done: impl FnMut()) {
        // Shorter than the times by which a device is kept alive and a driver is watched.
        const STEP: Duration = Duration::from_millis(50);
        let end = self.now() + time;
        while self.now() < end {
            self.jump(STEP.min(end - self.now()));
            // The worker looks at the clock twice a round: at its begin and before it sleeps. At the fourth look a whole
            // round has passed that began after the jump.
            let looks = self.0.looks.load(Ordering::SeqCst) + 4;
            until("round again", || {
                worker.wake();
                self.0.looks.load(Ordering::SeqCst) >= looks
            });
            step_done();
        }
    }
}
