//! The journal: changes that the device has accepted, in order, which the mirror replays.

use crate::played::Played;
use crate::table::DeviceTable;
use slipline_protocol::units::SampleIndex;
use std::collections::VecDeque;
use std::sync::Arc;

/// A change that the device has accepted, at a sample index; the mirror replays it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Acknowledged {
    /// Increases by one with each entry; a gap means dropped entries: the oldest, or thermal limits.
    pub number: u64,
    /// The index from which it affects the samples.
    pub at: SampleIndex,
    /// The change.
    pub change: Change,
    /// Whether `at` is the exact index. It is not exact for a stop by the device itself (dead-man, fault):
    /// the device reports it only afterwards and without the beginning of its ramp, so its codes are unknown
    /// until the next silence. It is not exact either for a step of the thermal fold-back after which others
    /// were missed.
    pub is_exact: bool,
}

/// A change of the device's output.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Change {
    /// A session began: the device is silent and disarmed from here.
    Session,
    /// It was armed.
    Armed,
    /// It was disarmed: a ramp to silence.
    Disarmed,
    /// A drive, a chord or a comb.
    Play(Played),
    /// A level hold began, so the levels follow the device's measurements: the codes are unknown until the
    /// next silence.
    Hold,
    /// A stop: a ramp to silence.
    Stop,
    /// An emergency stop: a fast ramp to silence.
    EmergencyStop,
    /// This table was swapped in.
    Table(Arc<DeviceTable>),
    /// The thermal fold-back's factor of all amplitudes from here on, per mille.
    Limit(u16),
}

/// Acknowledged changes that are kept for the mirror.
pub(crate) const JOURNAL_ENTRIES: usize = 128;
/// Largest number of thermal limits among them: some ten seconds of the fastest change.
pub(crate) const JOURNAL_LIMITS: usize = 32;

/// Drops the oldest step of the thermal fold-back if there are too many. A warm coil's limit changes several
/// times a second for minutes; without this the steps would displace the drive that warms it.
pub(crate) fn drop_oldest_limit(journal: &mut VecDeque<Arc<Acknowledged>>) {
    let is_limit = |entry: &Arc<Acknowledged>| matches!(entry.change, Change::Limit(_));
    if journal.iter().filter(|entry| is_limit(entry)).count() >= JOURNAL_LIMITS
        && let Some(oldest) = journal.iter().position(is_limit)
    {
        journal.remove(oldest);
    }
}
