//! The link's log for Python's `logging`.

use super::{Device, lock};
use slipline_link::Severity;
use std::sync::Arc;

/// The level of Python's `logging`.
const fn level_of(severity: Severity) -> u8 {
    match severity {
        Severity::Detail => 10,
        Severity::Info => 20,
        Severity::Warning => 30,
        Severity::Error => 40,
    }
}

impl Device {
    /// The lines that are new since the last call, each with its level.
    pub(super) fn new_lines(&self) -> Vec<(u8, String)> {
        let log = Arc::clone(&self.client.snapshot().record.log);
        let mut latest = lock(&self.latest_log);
        let seen = latest.as_ref().and_then(|latest| log.iter().rposition(|entry| entry == latest));
        let new = log.iter().skip(seen.map_or(0, |seen| seen + 1));
        let lines = new.map(|entry| (level_of(entry.severity), entry.text.clone())).collect();
        if let Some(entry) = log.back() {
            *latest = Some(entry.clone());
        }
        lines
    }
}
