//! What is new in a snapshot, for a program in another worker: the lists of a snapshot (journal, outcomes, log, frames)
//! hold hundreds of entries, and one change adds a few.

use crate::journal::Acknowledged;
use crate::log::LogEntry;
use crate::request::{Outcome, Ticket};
use crate::snapshot::{RecordView, Snapshot};
use crate::table::DeviceTable;
use crate::trace::TracedFrame;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// The difference between two snapshots.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SnapshotUpdate {
    /// The newer snapshot, without its lists and its table.
    values: Snapshot,
    journal: ListUpdate<Arc<Acknowledged>>,
    outcomes: ListUpdate<(Ticket, Outcome)>,
    log: ListUpdate<LogEntry>,
    frames: ListUpdate<Arc<TracedFrame>>,
    confirmed_table: TableUpdate,
}

/// What is new in a list that loses entries, mostly at its beginning, and gains them at its end.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct ListUpdate<T> {
    /// The places of the lost entries in the older list, ascending.
    lost: Vec<u16>,
    gained: Vec<T>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
enum TableUpdate {
    Same,
    Other(Option<Arc<DeviceTable>>),
}

impl<T: Clone> ListUpdate<T> {
    fn between(older: &Arc<VecDeque<T>>, newer: &Arc<VecDeque<T>>, is_same: impl Fn(&T, &T) -> bool) -> Self {
        if Arc::ptr_eq(older, newer) {
            return Self { lost: Vec::new(), gained: Vec::new() };
        }
        let mut rest = newer.iter().peekable();
        let is_lost = |entry: &T| rest.next_if(|next| is_same(entry, next)).is_none();
        let lost =
            (0_u16..).zip(older.iter().map(is_lost)).filter_map(|(place, is_lost)| is_lost.then_some(place));
        let lost = lost.collect();
        Self { lost, gained: rest.cloned().collect() }
    }

    fn apply(self, list: &Arc<VecDeque<T>>) -> Arc<VecDeque<T>> {
        let Self { lost, gained } = self;
        if lost.is_empty() && gained.is_empty() {
            return Arc::clone(list);
        }
        let mut lost = lost.into_iter().peekable();
        let kept = (0_u16..).zip(list.iter()).filter(|(place, _)| lost.next_if_eq(place).is_none());
        Arc::new(kept.map(|(_, entry)| entry.clone()).chain(gained).collect())
    }
}

impl SnapshotUpdate {
    /// What is new in `newer`. Both are of one link, which clones an entry's `Arc` but never remakes an entry.
    #[must_use]
    pub fn between(older: &Snapshot, newer: &Snapshot) -> Self {
        let mut values = newer.clone();
        values.table.confirmed = None;
        values.record = RecordView { last_refusal: values.record.last_refusal, ..RecordView::default() };
        let is_same_table = match (&older.table.confirmed, &newer.table.confirmed) {
            (Some(older), Some(newer)) => Arc::ptr_eq(older, newer),
            (older, newer) => older.is_none() && newer.is_none(),
        };
        Self {
            values,
            journal: ListUpdate::between(&older.record.journal, &newer.record.journal, Arc::ptr_eq),
            outcomes: ListUpdate::between(&older.record.outcomes, &newer.record.outcomes, PartialEq::eq),
            log: ListUpdate::between(&older.record.log, &newer.record.log, PartialEq::eq),
            frames: ListUpdate::between(&older.record.frames, &newer.record.frames, Arc::ptr_eq),
            confirmed_table: if is_same_table {
                TableUpdate::Same
            } else {
                TableUpdate::Other(newer.table.confirmed.clone())
            },
        }
    }

    /// The newer snapshot. `older` is the one that the update was made from, or its copy from earlier updates; their
    /// common entries stay the same `Arc`s.
    #[must_use]
    pub fn apply(self, older: &Snapshot) -> Snapshot {
        let Self { mut values, journal, outcomes, log, frames, confirmed_table } = self;
        values.table.confirmed = match confirmed_table {
            TableUpdate::Same => older.table.confirmed.clone(),
            TableUpdate::Other(table) => table,
        };
        values.record.journal = journal.apply(&older.record.journal);
        values.record.outcomes = outcomes.apply(&older.record.outcomes);
        values.record.log = log.apply(&older.record.log);
        values.record.frames = frames.apply(&older.record.frames);
        values
    }
}

#[cfg(test)]
mod tests;
