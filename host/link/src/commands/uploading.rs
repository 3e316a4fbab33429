//! A table's way onto the device: recognised or sent step by step, and known once the device's own word names it.

use super::answers::sentence;
use super::upload::{BUSY_PAUSE, BUSY_TRIES, Step, Upload};
use super::{Current, Dialogue};
use crate::journal::Record;
use crate::log::Severity;
use crate::request::{Outcome, Ticket};
use crate::snapshot::Change;
use slipline_protocol::event::State;
use slipline_protocol::{Command, Event, Refusal};
use std::time::Duration;

impl Dialogue {
    /// Begins an upload, in the place of one that is under way, unless the device needs none.
    pub(super) fn begin_upload(&mut self, upload: &Upload, record: &mut Record) {
        // Whatever is under way replaces what the device holds.
        if self.upload.is_none() && recognise(upload, record) {
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
                // In the same breath: a drive in between would go to the places of the table before.
                let read_back = upload.command();
                self.talk.say(read_back, now);
                self.current = Some(Current::Upload);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::DeviceTable;
    use slipline_protocol::event::{Accepted, Status, TableReport};
    use std::sync::Arc;

    fn upload(number: u64, hz: f64) -> Upload {
        let table = DeviceTable::from_knots((0.1, 0.2), 400e3, [(2.0 * hz, 1.0), (hz, 1.0)], 1e-6).unwrap();
        Upload::new(Ticket(number), Arc::new(table))
    }

    /// A silent device that holds this upload's table from before.
    fn holding(upload: &Upload) -> (Dialogue, Record) {
        let mut record = Record::default();
        record.status(Status::default());
        record.table(TableReport { active: Some(upload.table.header()), staged: 0 });
        (Dialogue::begin(*b"test", None, Duration::ZERO), record)
    }

    #[test]
    fn a_held_table_is_recognised_only_while_no_other_is_on_its_way() {
        let (held, other) = (upload(2, 20e3), upload(1, 21e3));
        let (mut dialogue, mut record) = holding(&held);
        dialogue.begin_upload(&other, &mut record);
        dialogue.begin_upload(&held, &mut record);
        assert_eq!(record.view.outcome(other.ticket), Some(&Outcome::Superseded));
        assert_eq!(record.view.outcome(held.ticket), None);
        assert!(record.view.confirmed_table.is_none());

        let (mut dialogue, mut record) = holding(&held);
        dialogue.begin_upload(&held, &mut record);
        assert_eq!(record.view.outcome(held.ticket), Some(&Outcome::Done { at: 0 }));
        assert_eq!(record.view.confirmed_table, Some(held.table));
    }

    #[test]
    fn a_table_that_comes_into_force_is_read_back_before_anything_else_is_said() {
        let (held, mut sent) = (upload(1, 20e3), upload(2, 21e3));
        let (mut dialogue, mut record) = holding(&held);
        sent.step = Step::Commit;
        dialogue.upload = Some(sent.clone());
        dialogue.uploaded(Event::Accepted(Accepted { at: 128 }), &mut record, Duration::ZERO);
        assert!(!dialogue.talk.is_free(), "nothing replaces or cancels it meanwhile");
        let report = TableReport { active: Some(sent.table.header()), staged: 0 };
        dialogue.uploaded(Event::Table(report), &mut record, Duration::ZERO);
        assert_eq!(record.view.confirmed_table, Some(sent.table));
        assert_eq!(dialogue.cancel_upload(Some(Ticket(3)), &mut record), None);

        dialogue.upload = Some(upload(4, 22e3));
        assert_eq!(dialogue.cancel_upload(Some(Ticket(5)), &mut record), Some(Command::TableAbort));
        assert_eq!(record.view.outcome(Ticket(4)), Some(&Outcome::Superseded));
    }
}
