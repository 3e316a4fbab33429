//! How bands on different threads leave rows to each other.

use super::block::Slant;
use super::record::Extract;
use super::vector::Line;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Turns of waiting before a thread lets others have its core.
const SPINS: u32 = 4096;

/// The seams between neighbouring bands.
#[derive(Debug)]
pub(super) struct Exchange {
    seams: Vec<Seam>,
    /// Whether a band has panicked: nobody may wait for it for ever.
    is_broken: AtomicBool,
}

/// Held by a band while it runs, so that the others hear of its panic.
#[must_use]
pub(super) struct Presence<'a>(&'a Exchange);

impl Drop for Presence<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.is_broken.store(true, Ordering::Release);
        }
    }
}

/// One seam: what goes down over it in rising blocks, and up in falling ones.
#[derive(Debug, Default)]
struct Seam {
    down: Slot,
    up: Slot,
}

/// Room for one parcel, and how often one was left in it and taken out.
#[derive(Debug, Default)]
struct Slot {
    parcel: Mutex<Parcel>,
    left: AtomicUsize,
    taken: AtomicUsize,
}

/// Rows on their way, both fields and what is recorded of them.
#[derive(Debug, Default)]
pub(super) struct Parcel {
    pub(super) newest: Vec<Line>,
    pub(super) older: Vec<Line>,
    pub(super) record: Extract,
}

impl Exchange {
    pub(super) fn new(bands: usize) -> Self {
        Self { seams: (1..bands).map(|_| Seam::default()).collect(), is_broken: AtomicBool::new(false) }
    }

    pub(super) fn join(&self) -> Presence<'_> {
        Presence(self)
    }

    /// Leaves to the neighbour, over the seam where the block begins, what `pack` packs, when the parcel before it was
    /// taken.
    pub(super) fn leave(&self, band: usize, slant: Slant, pack: impl FnOnce(&mut Parcel)) {
        let slot = match slant {
            Slant::Rising => &self.seams[band].down,
            Slant::Falling => &self.seams[band - 1].up,
        };
        self.wait_until(|| slot.taken.load(Ordering::Acquire) == slot.left.load(Ordering::Relaxed));
        // A poisoned parcel is only numbers.
        pack(&mut slot.parcel.lock().unwrap_or_else(PoisonError::into_inner));
        slot.left.fetch_add(1, Ordering::Release);
    }

    /// Takes what the neighbour left over the seam where the block ends, when it has.
    pub(super) fn take(&self, band: usize, slant: Slant, unpack: impl FnOnce(&Parcel)) {
        let slot = match slant {
            Slant::Rising => &self.seams[band - 1].down,
            Slant::Falling => &self.seams[band].up,
        };
        self.wait_until(|| slot.left.load(Ordering::Acquire) > slot.taken.load(Ordering::Relaxed));
        unpack(&slot.parcel.lock().unwrap_or_else(PoisonError::into_inner));
        slot.taken.fetch_add(1, Ordering::Release);
    }

    /// Blocks are tens of microseconds long, so it spins before it yields.
    fn wait_until(&self, is_so: impl Fn() -> bool) {
        let mut spins = 0;
        while !is_so() {
            assert!(!self.is_broken.load(Ordering::Acquire), "another band of the sheet has panicked");
            if spins < SPINS {
                spins += 1;
                std::hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    #[test]
    fn nobody_waits_for_a_band_that_has_panicked() {
        let exchange = Exchange::new(2);
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| exchange.take(1, Slant::Rising, |_| {}));
            let panicking = scope.spawn(|| {
                catch_unwind(|| {
                    let _presence = exchange.join();
                    panic!("as a bug would");
                })
            });
            assert!(panicking.join().expect("it was caught").is_err());
            assert!(waiting.join().is_err(), "what it waits for never comes");
        });
    }
}
