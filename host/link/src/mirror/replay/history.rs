//! A device's past as known by the link: the input of a [`Replay`](super::Replay).

use crate::journal::Acknowledged;
use crate::snapshot::Snapshot;
use crate::table::DeviceTable;
use slipline_protocol::units::SampleIndex;
use std::collections::VecDeque;
use std::sync::Arc;

/// A device's past as known by the link.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct DeviceHistory {
    /// The device's samples per second, in Hz.
    pub sample_rate_hz: u32,
    /// The commands that it has accepted.
    pub journal: Arc<VecDeque<Arc<Acknowledged>>>,
    /// The table that it is known to hold.
    pub table: Option<Arc<DeviceTable>>,
    /// The device has rendered up to here. The journal contains all earlier changes, except a stop in the
    /// last block.
    pub now: SampleIndex,
    /// The thermal fold-back's factor of all amplitudes at `now`, per mille.
    pub foldback_per_mille: u16,
}

impl DeviceHistory {
    /// The history of the device in a snapshot; `None` while no device has reported its status.
    #[must_use]
    pub fn of(snapshot: &Snapshot) -> Option<Self> {
        let status = snapshot.drive.settled?;
        Some(Self {
            sample_rate_hz: snapshot.device.identity.as_ref()?.sample_rate_hz,
            journal: Arc::clone(&snapshot.record.journal),
            table: snapshot.table.confirmed.clone(),
            now: status.now,
            foldback_per_mille: status.foldback_per_mille,
        })
    }
}
