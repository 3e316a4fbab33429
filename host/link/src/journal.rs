//! The journal: what the device has agreed to, in order; what the mirror replays.

use crate::played::Played;
use crate::table::DeviceTable;
use slipline_protocol::units::SampleIndex;
use std::collections::VecDeque;
use std::sync::Arc;

/// Something the device has agreed to, at a sample index: what the mirror replays.
#[derive(Clone, Debug, PartialEq)]
pub struct Acknowledged {
    /// Rises by one with each entry; a gap means that entries have been dropped: the oldest, or thermal limits.
    pub number: u64,
    /// The index from which it shows in the samples.
    pub at: SampleIndex,
    /// The change.
    pub change: Change,
    /// Whether `at` is the exact index. It is not for a stop of the device's own (dead-man, fault): the device tells of it
    /// only afterwards, and not where its ramp began, so its codes are unknown until the next silence. Nor is it for
    /// a step of the thermal fold-back after which others were missed.
    pub is_exact: bool,
}

/// A change of what the device sounds.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A session began: the device is silent and disarmed from here.
    Session,
    /// It was armed.
    Armed,
    /// It was disarmed: a ramp to silence.
    Disarmed,
    /// A drive, a chord or a comb.
    Play(Played),
    /// A level hold began, so the levels follow what the device measures: the codes are unknown until the next silence.
    Hold,
    /// A stop: a ramp to silence.
    Stop,
    /// An emergency stop: a fast ramp to silence.
    EmergencyStop,
    /// This table was swapped in.
    Table(Arc<DeviceTable>),
    /// What the thermal fold-back leaves of every amplitude from here on, per mille.
    Limit(u16),
}

/// Acknowledged changes that are kept for the mirror.
pub const JOURNAL_ENTRIES: usize = 128;
/// How many of them may be thermal limits: some ten seconds of the fastest change.
pub(crate) const JOURNAL_LIMITS: usize = 32;

/// Drops the oldest step of the thermal fold-back if there are too many. A warm coil's limit changes some times a second
/// for minutes; without this the steps would push out the drive that warms it.
pub(crate) fn drop_oldest_limit(journal: &mut VecDeque<Arc<Acknowledged>>) {
    let is_limit = |entry: &Arc<Acknowledged>| matches!(entry.change, Change::Limit(_));
    if journal.iter().filter(|entry| is_limit(entry)).count() >= JOURNAL_LIMITS
        && let Some(oldest) = journal.iter().position(is_limit)
    {
        journal.remove(oldest);
    }
}
