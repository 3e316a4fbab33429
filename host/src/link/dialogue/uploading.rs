//! A table's way onto the device: recognised or sent step by step, and known once the device's own word names it.

use super::Dialogue;
use super::answers::sentence;
use crate::link::record::Record;
use crate::link::upload::{BUSY_PAUSE, BUSY_TRIES, Step, Upload};
use crate::link::{Change, Outcome, Severity, Ticket};
use slipline_protocol::event::State;
use slipline_protocol::{Command, Event, Refusal};
use std::time::Duration;

impl Dialogue {
    /// Begins an upload, in the place of one that is under way, unless the device needs none.
    pub(super) fn begin_upload(&mut self, upload: &Upload, record: &mut Record) {
        if recognise(upload, record) {
            return;
        }
        if let Some(older) = self.upload.replace(upload.clone()) {
            record.finish(Some(older.ticket), Outcome::Superseded);
        }
        record.view.upload = Some(upload.progress());
        record.touch();
    }

    /// Gives up the upload under way; what to say for it, if there is one.
    pub(super) fn cancel_upload(&mut self, ticket: Option<Ticket>, record: &mut Record) -> Option<Command> {
        let Some(upload) = self.upload.take() else {
            record.finish(ticket, Outcome::Done { at: 0 });
            return None;
        };
        record.view.upload = None;
        record.finish(Some(upload.ticket), Outcome::Superseded);
        Some(Command::TableAbort)
    }

    /// Takes the answer to a step.
    pub(super) fn uploaded(&mut self, event: Event, record: &mut Record, now: Duration) {
        // Cancelled or replaced while a step was under way.
        let Some(upload) = &mut self.upload else { return };
        match (upload.step, event) {
            (_, Event::Refused(Refusal::Busy(_))) if upload.tries < BUSY_TRIES => {
                upload.tries += 1;
                upload.not_before = now + BUSY_PAUSE;
            }
            (Step::Begin | Step::Chunk { .. }, Event::Accepted(_)) => {
                upload.advance();
                record.view.upload = Some(upload.progress());
                record.touch();
            }
            (Step::Commit, Event::Accepted(accepted)) => {
                upload.advance();
                record.acknowledge(accepted.at, Change::Table(upload.table.clone()));
            }
            (Step::Verify, Event::Table(report)) => {
                record.table(report);
                if is_held(upload, record) {
                    confirm(upload, record, "");
                    record.view.upload = None;
                    self.upload = None;
                } else {
                    self.fail_upload("the table on the device is not the one that was sent", record);
                }
                self.status_stale = true;
            }
            (_, event) => self.fail_upload(&sentence(&event), record),
        }
    }

    fn fail_upload(&mut self, sentence: &str, record: &mut Record) {
        record.view.upload = None;
        record.view.upload_verified = Some(false);
        let ticket = self.upload.take().map(|upload| upload.ticket);
        record.finish(ticket, Outcome::Refused(sentence.to_owned()));
    }
}

/// Whether the device's latest word on its table, read back, names this one.
fn is_held(upload: &Upload, record: &Record) -> bool {
    record.view.table.active == Some(upload.table.header())
}

/// A table that the device holds from before this session, as after a restart with a stored one, need not be sent.
/// From now on it is known, so that the mirror can follow; for this the device has to be silent.
fn recognise(upload: &Upload, record: &mut Record) -> bool {
    let silent =
        record.view.status.filter(|status| !matches!(status.state, State::Driving | State::Stopping));
    let Some(status) = silent.filter(|_| is_held(upload, record) && record.view.confirmed_table.is_none())
    else {
        return false;
    };
    record.acknowledge(status.now, Change::Table(upload.table.clone()));
    confirm(upload, record, " already");
    true
}

/// The device holds this upload's table, and this program knows it.
fn confirm(upload: &Upload, record: &mut Record, when: &str) {
    record.view.confirmed_table = Some(upload.table.clone());
    record.view.upload_verified = Some(true);
    record.log(Severity::Info, format!("Table {:08x} is on the device{when}.", upload.table.crc()));
    let at = record.view.status.map_or(0, |status| status.now);
    record.finish(Some(upload.ticket), Outcome::Done { at });
}
