//! How bands on different threads meet after each block and swap their halos.

use super::band::Band;
use super::vector::Line;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Turns of waiting before a thread lets others have its core.
const SPINS: u32 = 4096;

/// The seams between neighbouring bands and the count of arrivals.
#[derive(Debug)]
pub(super) struct Exchange {
    bands: usize,
    seams: Vec<Seam>,
    arrived: AtomicUsize,
}

/// Rows on their way over one seam. Even and odd meetings have parcels of their own: a band may already pack for
/// the next meeting while its neighbour still unpacks from this one, and cannot get further ahead than that.
#[derive(Debug, Default)]
struct Seam {
    to_after: [Mutex<Vec<Line>>; 2],
    to_before: [Mutex<Vec<Line>>; 2],
}

/// Number of the last meeting that a thread was at.
#[derive(Debug)]
pub(super) struct Meeting(usize);

impl Exchange {
    pub(super) fn new(bands: usize) -> Self {
        let seams = (1..bands).map(|_| Seam::default()).collect();
        Self { bands, seams, arrived: AtomicUsize::new(0) }
    }

    pub(super) fn meeting(&self) -> Meeting {
        Meeting(0)
    }

    /// Swaps halos of `depth` rows with the neighbours of band `number`; every band must call it equally often.
    pub(super) fn halos(&self, band: &mut Band, number: usize, depth: usize, meeting: &mut Meeting) {
        if self.bands < 2 {
            return;
        }
        meeting.0 += 1;
        let parity = meeting.0 % 2;
        let before = number.checked_sub(1).and_then(|seam| self.seams.get(seam));
        let after = self.seams.get(number);
        if let Some(seam) = before {
            band.pack_for_before(depth, &mut open(&seam.to_before[parity]));
        }
        if let Some(seam) = after {
            band.pack_for_after(depth, &mut open(&seam.to_after[parity]));
        }
        self.meet(meeting);
        if let Some(seam) = before {
            band.unpack_from_before(&open(&seam.to_after[parity]));
        }
        if let Some(seam) = after {
            band.unpack_from_after(&open(&seam.to_before[parity]));
        }
    }

    /// Waits until every band is here. Blocks are tens of microseconds long, so it spins before it yields.
    fn meet(&self, meeting: &Meeting) {
        self.arrived.fetch_add(1, Ordering::AcqRel);
        let mut spins = 0;
        while self.arrived.load(Ordering::Acquire) < meeting.0 * self.bands {
            if spins < SPINS {
                spins += 1;
                std::hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
        }
    }
}

fn open(parcel: &Mutex<Vec<Line>>) -> MutexGuard<'_, Vec<Line>> {
    // A poisoned parcel is only numbers; the thread that panicked is reported by the scope that joins it.
    parcel.lock().unwrap_or_else(PoisonError::into_inner)
}
