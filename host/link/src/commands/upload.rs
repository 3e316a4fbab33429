//! One upload of a table, step by step: begin, chunks, commit, read the digest back.

use crate::request::Ticket;
use crate::snapshot::UploadProgress;
use crate::table::DeviceTable;
use slipline_protocol::Command;
use std::sync::Arc;
use std::time::Duration;

/// While the last table still glides in, the device is asked again after so long.
pub(super) const BUSY_PAUSE: Duration = Duration::from_millis(5);
/// It is asked again so often: a glide to a new table takes 20 ms.
pub(super) const BUSY_TRIES: u32 = 200;

/// Where it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    Begin,
    Chunk { first: u16 },
    Commit,
    Verify,
}

/// An upload under way.
#[derive(Clone, Debug)]
pub(super) struct Upload {
    pub(super) ticket: Ticket,
    pub(super) table: Arc<DeviceTable>,
    pub(super) step: Step,
    pub(super) tries: u32,
    /// It rests until then.
    pub(super) not_before: Duration,
}

impl Upload {
    pub(super) const fn new(ticket: Ticket, table: Arc<DeviceTable>) -> Self {
        Self { ticket, table, step: Step::Begin, tries: 0, not_before: Duration::ZERO }
    }

    /// What to say next.
    pub(super) fn command(&self) -> Command {
        match self.step {
            Step::Begin => Command::TableBegin(self.table.header()),
            // No chunk begins past the end: `advance` goes on to the commit there.
            Step::Chunk { first } => {
                self.table.chunk(first).map_or(Command::TableCommit, Command::TableChunk)
            }
            Step::Commit => Command::TableCommit,
            Step::Verify => Command::TableDigest,
        }
    }

    /// Goes on after the device agreed.
    pub(super) fn advance(&mut self) {
        let total = self.table.header().knots;
        self.tries = 0;
        self.step = match self.step {
            Step::Begin => Step::Chunk { first: 0 },
            Step::Chunk { first } => {
                let next = first + self.table.chunk(first).map_or(0, |chunk| chunk.knots.len() as u16);
                if next < total { Step::Chunk { first: next } } else { Step::Commit }
            }
            Step::Commit | Step::Verify => Step::Verify,
        };
    }

    pub(super) fn progress(&self) -> UploadProgress {
        let total = self.table.header().knots;
        let sent = match self.step {
            Step::Begin => 0,
            Step::Chunk { first } => first,
            Step::Commit | Step::Verify => total,
        };
        UploadProgress { sent, total }
    }
}
