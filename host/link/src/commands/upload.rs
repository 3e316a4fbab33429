//! The upload of a table: it is sent step by step (begin, chunks, commit), unless the device holds it
//! already. The device's table is considered known once the digest that is read back equals that of this
//! table.

use crate::journal::Change;
use crate::log::Severity;
use crate::recorder::Recorder;
use crate::refusal::Refusal;
use crate::request::{Outcome, Ticket};
use crate::snapshot::UploadProgress;
use crate::table::DeviceTable;
use slipline_protocol::command::TravelSetting;
use slipline_protocol::event::State;
use slipline_protocol::{Command, Event, refusal};
use std::sync::Arc;
use std::time::Duration;

/// Time after which a step is sent again to a busy device: one whose tones still glide to the last table.
pub(super) const BUSY_PAUSE: Duration = Duration::from_millis(5);
/// Most attempts of a step while the device is busy: a glide to a new table takes 20 ms.
pub(super) const BUSY_TRIES: u32 = 200;

/// The plate file limits the travel, but the device's firmware does not support this limit.
const TRAVEL_NOT_LIMITED: &str =
    "The device does not limit the actuator's travel: its firmware is too old for it.";

/// The step that is sent next or awaits its reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The limit of the actuator's travel, before any tone uses the new table.
    Limit,
    Begin,
    Chunk {
        first: u16,
    },
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
    /// Earliest time of the next step.
    pub(super) not_before: Duration,
    /// No other upload was under way when it began, so the table on the device is in force and may be this
    /// one.
    may_be_held: bool,
}

impl Upload {
    pub(super) const fn new(ticket: Ticket, table: Arc<DeviceTable>) -> Self {
        Self { ticket, table, step: Step::Begin, tries: 0, not_before: Duration::ZERO, may_be_held: false }
    }

    /// The command of the present step.
    pub(super) fn command(&self) -> Command {
        match self.step {
            Step::Limit => Command::SetTravelLimit(TravelSetting { limit: self.table.travel_limit() }),
            Step::Begin => Command::TableBegin(self.table.header()),
            // No chunk begins past the end: `advance` proceeds to the commit there.
            Step::Chunk { first } => {
                self.table.chunk(first).map_or(Command::TableCommit, Command::TableChunk)
            }
            Step::Commit => Command::TableCommit,
            Step::Verify => Command::TableDigest,
        }
    }

    /// Moves to the next step after the device has accepted this one.
    pub(super) fn advance(&mut self) {
        let total = self.table.header().knots;
        self.tries = 0;
        self.step = match self.step {
            Step::Limit => Step::Begin,
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
            Step::Limit | Step::Begin => 0,
            Step::Chunk { first } => first,
            Step::Commit | Step::Verify => total,
        };
        UploadProgress { sent, total }
    }
}

/// The upload under way, if any.
#[derive(Debug, Default)]
pub(super) struct Uploads(Option<Upload>);

/// What the queue must do after the reply to a step.
#[derive(Debug, Default, PartialEq)]
pub(super) struct AfterStep {
    /// A command to be sent before anything else.
    pub(super) command: Option<Command>,
    /// Whether the status has changed.
    pub(super) is_status_stale: bool,
}

impl Uploads {
    /// The upload under way.
    pub(super) const fn current(&self) -> Option<&Upload> {
        self.0.as_ref()
    }

    /// Begins an upload, which replaces one under way, unless the device holds the table already.
    pub(super) fn begin(&mut self, upload: &Upload, recorder: &mut Recorder) {
        let needs_limit = !recorder.view.limits_travel_for(&upload.table);
        if upload.table.travel_limit().is_some() && !recorder.view.can_limit_travel() {
            recorder.log(Severity::Warning, TRAVEL_NOT_LIMITED);
        }
        // An upload under way replaces the table that the device holds.
        let may_be_held = self.0.is_none();
        if may_be_held && !needs_limit && recognise(upload, recorder) {
            return;
        }
        let step = if needs_limit { Step::Limit } else { Step::Begin };
        if let Some(older) = self.0.replace(Upload { step, may_be_held, ..upload.clone() }) {
            recorder.finish(Some(older.ticket), Outcome::Superseded);
        }
        recorder.view.table.upload = Some(upload.progress());
        recorder.touch();
    }

    /// Cancels the upload under way; returns the command to be sent for it, if any.
    pub(super) fn cancel(&mut self, ticket: Option<Ticket>, recorder: &mut Recorder) -> Option<Command> {
        let Some(upload) = self.0.take() else {
            recorder.finish(ticket, Outcome::Done { at: 0 });
            return None;
        };
        recorder.view.table.upload = None;
        recorder.finish(Some(upload.ticket), Outcome::Superseded);
        Some(Command::TableAbort)
    }

    /// The session is over: cancels the upload and returns its ticket.
    pub(super) fn end(&mut self) -> Option<Ticket> {
        self.0.take().map(|upload| upload.ticket)
    }

    /// Evaluates the reply to a step.
    pub(super) fn take_reply(&mut self, event: Event, recorder: &mut Recorder, now: Duration) -> AfterStep {
        let mut after = AfterStep::default();
        // Cancelled or replaced while a step was under way.
        let Some(upload) = &mut self.0 else { return after };
        match (event, upload.step) {
            (Event::Refused(refusal::Refusal::Busy(_)), _) if upload.tries < BUSY_TRIES => {
                upload.tries += 1;
                upload.not_before = now + BUSY_PAUSE;
            }
            (Event::Refused(refusal), _) => self.fail(Refusal::Device(refusal), recorder),
            (Event::TravelLimit(setting), Step::Limit) => {
                recorder.travel_limit(setting.limit);
                after.is_status_stale = true;
                if setting.limit != upload.table.travel_limit() {
                    self.fail(Refusal::UnexpectedReply, recorder);
                } else if upload.may_be_held && is_held_already(upload, recorder) {
                    recorder.view.table.upload = None;
                    self.0 = None;
                } else {
                    upload.advance();
                }
            }
            (Event::Accepted(_), Step::Begin | Step::Chunk { .. }) => {
                upload.advance();
                recorder.view.table.upload = Some(upload.progress());
                recorder.touch();
            }
            (Event::Accepted(accepted), Step::Commit) => {
                upload.advance();
                recorder.acknowledge(accepted.at, Change::Table(upload.table.clone()));
                // Before anything else: a drive would still be placed by the span of the previous table.
                after.command = Some(upload.command());
            }
            (Event::Table(report), Step::Verify) => {
                recorder.table(report);
                after.is_status_stale = true;
                if is_held(upload, recorder) {
                    confirm(upload, recorder, "");
                    recorder.view.table.upload = None;
                    self.0 = None;
                } else {
                    self.fail(Refusal::TableDiffers, recorder);
                }
            }
            (Event::Accepted(_), Step::Limit | Step::Verify)
            | (Event::TravelLimit(_), Step::Begin | Step::Chunk { .. } | Step::Commit | Step::Verify)
            | (Event::Table(_), Step::Limit | Step::Begin | Step::Chunk { .. } | Step::Commit)
            | (
                Event::Hello(_)
                | Event::Status(_)
                | Event::Maintenance(_)
                | Event::Board(_)
                | Event::Profile(_)
                | Event::Wear(_)
                | Event::Analogue(_)
                | Event::MutePin(_)
                | Event::Clock(_)
                | Event::BrownOut(_)
                | Event::AcceptedUntil(_)
                | Event::Unchanged(_)
                | Event::Trigger(_)
                | Event::Digest(_)
                | Event::Inputs(_)
                | Event::Listened(_)
                | Event::Captured(_)
                | Event::Held(_)
                | Event::BootloaderToken(_)
                | Event::FaultTrial(_),
                _,
            ) => {
                self.fail(Refusal::UnexpectedReply, recorder);
            }
        }
        after
    }

    fn fail(&mut self, refusal: Refusal, recorder: &mut Recorder) {
        recorder.view.table.upload = None;
        recorder.view.table.upload_verified = Some(false);
        let ticket = self.end();
        recorder.finish(ticket, Outcome::Refused(refusal));
    }
}

/// Whether the digest that was read back last is that of this table.
fn is_held(upload: &Upload, recorder: &Recorder) -> bool {
    recorder.view.table.report.active == Some(upload.table.header())
}

/// Recognizes a table that the device holds from before this session, such as a stored one after a restart;
/// it need not be sent. From now on it is known, so that the mirror can follow; this requires a silent
/// device.
fn recognise(upload: &Upload, recorder: &mut Recorder) -> bool {
    let silent = recorder
        .view
        .drive
        .status
        .filter(|status| !matches!(status.state, State::Driving | State::Waiting | State::Stopping));
    let Some(status) =
        silent.filter(|_| is_held(upload, recorder) && recorder.view.table.confirmed.is_none())
    else {
        return false;
    };
    recorder.acknowledge(status.now, Change::Table(upload.table.clone()));
    confirm(upload, recorder, " already");
    true
}

/// Whether the device holds the table after its travel limit has changed: from before this session, or from
/// an upload that was known already.
fn is_held_already(upload: &Upload, recorder: &mut Recorder) -> bool {
    let known = recorder.view.table.confirmed.as_ref();
    if is_held(upload, recorder) && known.is_some_and(|known| known.crc() == upload.table.crc()) {
        confirm(upload, recorder, " already");
        return true;
    }
    recognise(upload, recorder)
}

/// The device holds this upload's table, and this program knows it.
fn confirm(upload: &Upload, recorder: &mut Recorder, when: &str) {
    recorder.view.table.confirmed = Some(upload.table.clone());
    recorder.view.table.upload_verified = Some(true);
    recorder.log(Severity::Info, format!("Table {:08x} is on the device{when}.", upload.table.crc()));
    let at = recorder.view.drive.status.map_or(0, |status| status.now);
    recorder.finish(Some(upload.ticket), Outcome::Done { at });
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_protocol::command::TravelLimit;
    use slipline_protocol::event::{Accepted, Status, TableReport};

    fn upload(number: u64, hz: f64) -> Upload {
        let table = DeviceTable::from_knots((0.1, 0.2), 400e3, [(2.0 * hz, 1.0), (hz, 1.0)], 1e-6).unwrap();
        Upload::new(Ticket(number), Arc::new(table))
    }

    /// A silent device that already holds this upload's table.
    fn holding(upload: &Upload) -> Recorder {
        let mut recorder = Recorder::default();
        recorder.status(Status::default());
        recorder.table(TableReport { active: Some(upload.table.header()), staged: 0 });
        recorder
    }

    #[test]
    fn a_held_table_is_recognised_only_while_no_other_is_on_its_way() {
        let (held, other) = (upload(2, 20e3), upload(1, 21e3));
        let (mut uploads, mut recorder) = (Uploads::default(), holding(&held));
        uploads.begin(&other, &mut recorder);
        uploads.begin(&held, &mut recorder);
        assert_eq!(recorder.view.outcome(other.ticket), Some(&Outcome::Superseded));
        assert_eq!(recorder.view.outcome(held.ticket), None);
        assert!(recorder.view.table.confirmed.is_none());

        let (mut uploads, mut recorder) = (Uploads::default(), holding(&held));
        uploads.begin(&held, &mut recorder);
        assert_eq!(recorder.view.outcome(held.ticket), Some(&Outcome::Done { at: 0 }));
        assert_eq!(recorder.view.table.confirmed, Some(held.table));
    }

    #[test]
    fn a_table_that_comes_into_force_is_read_back_before_anything_else_is_sent() {
        let (held, mut sent) = (upload(1, 20e3), upload(2, 21e3));
        let mut recorder = holding(&held);
        sent.step = Step::Commit;
        let mut uploads = Uploads(Some(sent.clone()));
        let after = uploads.take_reply(Event::Accepted(Accepted { at: 128 }), &mut recorder, Duration::ZERO);
        assert_eq!(after.command, Some(Command::TableDigest), "nothing replaces or cancels it meanwhile");
        let report = TableReport { active: Some(sent.table.header()), staged: 0 };
        uploads.take_reply(Event::Table(report), &mut recorder, Duration::ZERO);
        assert_eq!(recorder.view.table.confirmed, Some(sent.table));
        assert_eq!(uploads.cancel(Some(Ticket(3)), &mut recorder), None);

        let mut uploads = Uploads(Some(upload(4, 22e3)));
        assert_eq!(uploads.cancel(Some(Ticket(5)), &mut recorder), Some(Command::TableAbort));
        assert_eq!(recorder.view.outcome(Ticket(4)), Some(&Outcome::Superseded));
    }

    #[test]
    fn a_device_that_puts_another_limit_in_force_gets_no_table() {
        let limit = TravelLimit { resonance_uhz: 50_000_000, quality_per_mille: 4000, static_ppm: 2_000_000 };
        let mut wanted = upload(1, 20e3);
        wanted.table = Arc::new(wanted.table.as_ref().clone().with_travel_limit(50.0, 4.0, 2.0).unwrap());
        for (confirmed, is_taken) in [
            (Some(limit), true),
            (None, false),
            (Some(TravelLimit { static_ppm: limit.static_ppm - 1, ..limit }), false),
        ] {
            let mut recorder = Recorder::default();
            let mut uploads = Uploads(Some(Upload { step: Step::Limit, ..wanted.clone() }));
            let reply = Event::TravelLimit(TravelSetting { limit: confirmed });
            uploads.take_reply(reply, &mut recorder, Duration::ZERO);
            assert_eq!(
                uploads.current().map(|upload| upload.step),
                is_taken.then_some(Step::Begin),
                "{confirmed:?}"
            );
            let refused = Outcome::Refused(Refusal::UnexpectedReply);
            assert_eq!(
                recorder.view.outcome(wanted.ticket),
                (!is_taken).then_some(&refused),
                "{confirmed:?}"
            );
        }
    }
}
