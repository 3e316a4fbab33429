//! Halo exchange: bands on different threads send rows to their neighbours.

use super::block::Skew;
use super::record::RecordHalo;
use super::vector::Line;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Number of spins before a waiting thread leaves its core to other threads.
const SPINS: u32 = 4096;
/// Time for which it leaves the core: about a block. On a busy machine a thread that only yields gets its core back
/// immediately, and the band that it waits for does not run.
const PAUSE: Duration = Duration::from_micros(50);

/// The boundaries between neighbouring bands.
#[derive(Debug)]
pub(super) struct HaloExchange {
    boundaries: Vec<BandBoundary>,
    /// Whether a band has panicked; the others must then not wait for it.
    is_broken: AtomicBool,
}

/// Held by a band while it runs; informs the other bands if it panics.
#[must_use]
pub(super) struct PanicGuard<'a>(&'a HaloExchange);

impl Drop for PanicGuard<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.is_broken.store(true, Ordering::Release);
        }
    }
}

/// The boundary between two bands: halos pass down in rising blocks and up in falling ones.
#[derive(Debug, Default)]
struct BandBoundary {
    down: Slot,
    up: Slot,
}

/// A buffer for one halo, and the numbers of halos sent and received through it.
#[derive(Debug, Default)]
struct Slot {
    halo: Mutex<Halo>,
    sent: AtomicUsize,
    received: AtomicUsize,
}

/// Rows sent to a neighbour: both fields and the recorded envelope.
#[derive(Debug, Default)]
pub(super) struct Halo {
    pub(super) newest: Vec<Line>,
    pub(super) older: Vec<Line>,
    pub(super) record: RecordHalo,
}

impl HaloExchange {
    pub(super) fn new(bands: usize) -> Self {
        Self {
            boundaries: (1..bands).map(|_| BandBoundary::default()).collect(),
            is_broken: AtomicBool::new(false),
        }
    }

    pub(super) fn guard(&self) -> PanicGuard<'_> {
        PanicGuard(self)
    }

    /// Sends the rows that `pack` writes to the neighbour at the boundary where the block begins. Waits until the
    /// neighbour has received the previous halo.
    pub(super) fn send(&self, band: usize, skew: Skew, pack: impl FnOnce(&mut Halo)) {
        let slot = match skew {
            Skew::Rising => &self.boundaries[band].down,
            Skew::Falling => &self.boundaries[band - 1].up,
        };
        self.wait_until(|| slot.received.load(Ordering::Acquire) == slot.sent.load(Ordering::Relaxed));
        // A half-written halo of a panicked band is harmless: the grid is not used after a panic.
        pack(&mut slot.halo.lock().unwrap_or_else(PoisonError::into_inner));
        slot.sent.fetch_add(1, Ordering::Release);
    }

    /// Receives the rows of the neighbour at the boundary where the block ends. Waits until they have been sent.
    pub(super) fn receive(&self, band: usize, skew: Skew, unpack: impl FnOnce(&Halo)) {
        let slot = match skew {
            Skew::Rising => &self.boundaries[band - 1].down,
            Skew::Falling => &self.boundaries[band].up,
        };
        self.wait_until(|| slot.sent.load(Ordering::Acquire) > slot.received.load(Ordering::Relaxed));
        unpack(&slot.halo.lock().unwrap_or_else(PoisonError::into_inner));
        slot.received.fetch_add(1, Ordering::Release);
    }

    /// Waits until a condition is true, or panics if another band has panicked. It spins first, because a block takes
    /// only some tens of microseconds.
    #[cfg_attr(
        not(test),
        expect(
            clippy::disallowed_methods,
            reason = "one band waits for another on its thread; on wasm there is one band"
        )
    )]
    fn wait_until(&self, is_so: impl Fn() -> bool) {
        let mut spins = 0;
        while !is_so() {
            assert!(!self.is_broken.load(Ordering::Acquire), "another band of the sheet has panicked");
            if spins < SPINS {
                spins += 1;
                std::hint::spin_loop();
            } else {
                std::thread::sleep(PAUSE);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    #[test]
    fn no_band_waits_for_one_that_has_panicked() {
        let exchange = HaloExchange::new(2);
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| exchange.receive(1, Skew::Rising, |_| {}));
            let panicking = scope.spawn(|| {
                catch_unwind(|| {
                    let _guard = exchange.guard();
                    panic!("as a bug would");
                })
            });
            assert!(panicking.join().expect("it was caught").is_err());
            assert!(waiting.join().is_err(), "what it waits for never comes");
        });
    }
}
