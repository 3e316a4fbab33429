//! The turning-point table of the setup's plate for the device's rate: requested once, and kept until another is finished.

use slipline_link::protocol::event::Identity;
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::table::{TableJob, TableMade, TableState};
use slipline_plate::Plate;
use std::sync::Arc;

/// The table of the setup's plate.
pub(super) struct Table {
    plate: Arc<Plate>,
    state: TableState,
    /// The rate for which it was requested.
    asked_hz: Option<u32>,
    /// The table that was finished last: it is restored when the computation of another one is cancelled.
    kept: Option<Arc<TableMade>>,
    queue: JobQueue<TableJob, TableState>,
}

impl Table {
    pub(super) const fn of(plate: Arc<Plate>, queue: JobQueue<TableJob, TableState>) -> Self {
        Self { plate, state: TableState::Waiting, asked_hz: None, kept: None, queue }
    }

    pub(super) const fn state(&self) -> &TableState {
        &self.state
    }

    /// The table of the plate, once it is finished.
    pub(super) fn made(&self) -> Option<&Arc<TableMade>> {
        self.state.made().filter(|made| Arc::ptr_eq(&made.plate, &self.plate))
    }

    /// The share of the computation that is done, 0..=1, while it is under way.
    pub(super) fn progress(&self) -> Option<f32> {
        self.queue.progress()
    }

    /// Another plate is in the setup.
    pub(super) fn use_plate(&mut self, plate: &Arc<Plate>) {
        self.plate = Arc::clone(plate);
        self.forget_request();
    }

    /// Has the next [`ask`](Self::ask) request the table again.
    pub(super) const fn forget_request(&mut self) {
        self.asked_hz = None;
    }

    /// Requests the table for this device, unless that was done already.
    pub(super) fn ask(&mut self, identity: &Identity) {
        let rate_hz = identity.sample_rate_hz;
        if self.asked_hz.replace(rate_hz) != Some(rate_hz) {
            self.state = TableState::Making;
            self.queue.ask(TableJob {
                plate: Arc::clone(&self.plate),
                sample_rate_hz: f64::from(rate_hz),
                max_knots: usize::from(identity.max_knots),
            });
        }
    }

    /// Stores a finished table, unless the setup has another plate by now; returns whether there is one.
    pub(super) fn take(&mut self) -> bool {
        let Some(table) = self.queue.take() else { return false };
        let made = table.made().cloned();
        let is_current = made.as_ref().is_none_or(|made| Arc::ptr_eq(&made.plate, &self.plate));
        if is_current {
            self.kept = made.or(self.kept.take());
            self.state = table;
        }
        is_current
    }

    /// Cancels the computation; returns the table from before if it is that of another plate.
    pub(super) fn cancel(&mut self) -> Option<Arc<TableMade>> {
        self.queue.cancel();
        self.state = TableState::Cancelled;
        self.kept.clone().filter(|kept| !Arc::ptr_eq(&kept.plate, &self.plate))
    }

    /// Restores a table whose plate is in the setup again.
    pub(super) fn restore(&mut self, kept: Arc<TableMade>) {
        self.queue.cancel();
        self.state = TableState::Ready(kept);
    }
}
