//! Tables, lights and calibrations of the tests' windows: computed once, as many windows ask for the same few.

use slipline_instrument::jobs::calibrate::{self, CalibrateDone, CalibrateJob};
use slipline_model::jobs::check::{self, CheckJob, Checked};
use slipline_model::jobs::table::{self, TableMade};
use slipline_model::jobs::{JobQueue, Task};
use slipline_window::app::{TableJob, TableState};
use std::sync::{Arc, Mutex, PoisonError};

/// A queue that does each job at once, or knows its result. The window knows a result by its own job, which `of` puts in.
fn knowing<Job: Clone + Send + 'static, Done: Clone + Send + 'static>(
    results: &'static Mutex<Vec<(Job, Done)>>,
    is_same: fn(&Job, &Job) -> bool,
    mut work: impl FnMut(Job, &Task) -> Option<Done> + 'static,
    of: fn(Job, Done) -> Done,
) -> JobQueue<Job, Done> {
    let known = || results.lock().unwrap_or_else(PoisonError::into_inner);
    JobQueue::inline(move |job: Job, task: &_| {
        let found = known().iter().find(|(other, _)| is_same(other, &job)).map(|(_, done)| done.clone());
        if let Some(done) = found {
            return Some(of(job, done));
        }
        let done = work(job.clone(), task)?;
        known().push((job, done.clone()));
        Some(done)
    })
}

/// The tables of plates.
pub(crate) fn tables() -> JobQueue<TableJob, TableState> {
    static KNOWN: Mutex<Vec<(TableJob, TableState)>> = Mutex::new(Vec::new());
    let is_same = |a: &TableJob, b: &TableJob| {
        (a.sample_rate_hz, a.max_knots) == (b.sample_rate_hz, b.max_knots) && a.plate == b.plate
    };
    // The window knows its plate by the one that it has asked for.
    let of = |job: TableJob, done: TableState| {
        let TableState::Ready(made) = &done else { return done };
        TableState::Ready(Arc::new(TableMade { plate: job.plate, ..TableMade::clone(made) }))
    };
    knowing(&KNOWN, is_same, table::make, of)
}

/// The lights of plates and boundaries.
pub(crate) fn checks() -> JobQueue<CheckJob, Checked> {
    static KNOWN: Mutex<Vec<(CheckJob, Checked)>> = Mutex::new(Vec::new());
    let is_same = |a: &CheckJob, b: &CheckJob| {
        (a.boundary_m, &a.conditions) == (b.boundary_m, &b.conditions) && a.plate == b.plate
    };
    knowing(&KNOWN, is_same, check::work(), |job, done| Checked { job, ..done })
}

/// Calibrated plates.
pub(crate) fn calibrations() -> JobQueue<CalibrateJob, CalibrateDone> {
    static KNOWN: Mutex<Vec<(CalibrateJob, CalibrateDone)>> = Mutex::new(Vec::new());
    let is_same = |a: &CalibrateJob, b: &CalibrateJob| {
        let known =
            |job: &CalibrateJob| (job.calipers, job.sensors.clone(), job.check.clone(), job.sample_rate_hz);
        known(a) == known(b) && a.plate == b.plate
    };
    knowing(&KNOWN, is_same, calibrate::work, |_, done| done)
}
