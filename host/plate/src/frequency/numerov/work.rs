//! Counts the solutions of this thread, so that a test can limit the cost of a computation without a clock.

use std::cell::Cell;

/// Work of the solver up to now.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Work {
    /// Grids that were set up.
    pub(crate) grids: usize,
    /// Sweeps of eight frequencies.
    pub(crate) sweeps: usize,
    /// Sweeps of one frequency.
    pub(crate) single: usize,
}

thread_local! {
    static DONE: Cell<Work> = const { Cell::new(Work { grids: 0, sweeps: 0, single: 0 }) };
}

/// Work of this thread since it began.
pub(crate) fn done() -> Work {
    DONE.get()
}

pub(super) fn count(add: impl FnOnce(&mut Work)) {
    let mut work = DONE.get();
    add(&mut work);
    DONE.set(work);
}
