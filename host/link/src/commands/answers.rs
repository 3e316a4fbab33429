//! What a device's answers mean for the talk.

use super::{BUSY_TRIES, Current, Dialogue, Job, Stage, Task, Verdict};
use crate::channel::{Answer, KEEP_ALIVE_PERIOD, Reply};
use crate::error::LinkError;
use crate::foldback::FoldbackSteps;
use crate::journal::Record;
use crate::log::Severity;
use crate::request::Outcome;
use crate::snapshot::{Change, LinkState};
use slipline_app::Timing;
use slipline_protocol::event::{Digest, Identity, State, Status};
use slipline_protocol::refusal::Busy;
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Event, Refusal};
use std::sync::Arc;
use std::time::Duration;

/// A drive that came before the device took up the last one is said again after so long: three blocks of 128 codes
/// at 400 kS/s.
const DRIVE_PAUSE: Duration = Duration::from_millis(1);
/// A digest is asked for this often until its window is over.
const DIGEST_PAUSE: Duration = Duration::from_millis(20);
/// A numbered command is given a new number so often before the device counts as lost.
const RENUMBERINGS: u32 = 3;

impl Dialogue {
    /// Takes one answer.
    pub(super) fn understand(&mut self, answer: Answer, record: &mut Record, now: Duration) -> Verdict {
        let Answer { command, reply, .. } = answer;
        let event = match reply {
            Reply::Hello(version, identity) => {
                if self.stage == Stage::Greeting {
                    self.greeted(version, identity, record, now);
                }
                return Verdict::GoOn;
            }
            Reply::Event(event) => *event,
        };
        if event == Event::Refused(Refusal::StaleSession) {
            return Verdict::Lose(LinkError::SessionEnded);
        }
        match command {
            Command::Stop | Command::EmergencyStop => {
                self.stopped(&command, &event, record);
                Verdict::GoOn
            }
            Command::KeepAlive(_) | Command::Status => {
                if let Event::Status(status) = event {
                    self.take_status(status, record);
                }
                Verdict::GoOn
            }
            command => self.numbered(command, event, record, now),
        }
    }

    fn greeted(
        &mut self,
        version: Version,
        identity: Option<Box<Identity>>,
        record: &mut Record,
        now: Duration,
    ) {
        let compatibility = Version::OURS.judge_device(version);
        record.view.compatibility = Some(compatibility);
        if let Some(identity) = &identity {
            let (major, minor, patch) = identity.firmware;
            record.log(Severity::Info, format!("{} with firmware {major}.{minor}.{patch}.", identity.board));
            if !identity.crash.is_empty() {
                record.log(Severity::Error, format!("Before its last reset it crashed: {}", identity.crash));
            }
        }
        record.view.identity = identity.map(|identity| Arc::new(*identity));
        if compatibility.may_drive() && record.view.identity.is_some() {
            self.stage = Stage::Reading;
            self.keep_alive_due = now + KEEP_ALIVE_PERIOD;
            self.talk.keep_alive(now);
            self.tasks.push_front(Task::new(None, Job::FirstReadBack));
        } else {
            self.stage = Stage::Limited;
            record.log(Severity::Warning, compatibility.sentence());
            self.connected(0, record);
        }
    }

    /// The device and what it holds is known: the connection stands.
    fn connected(&mut self, at: u64, record: &mut Record) {
        record.view.trouble = None;
        record.link(LinkState::Connected);
        record.finish(self.connect.take(), Outcome::Done { at });
    }

    fn take_status(&mut self, status: Status, record: &mut Record) {
        let is_first = record.view.status.is_none();
        let rate = record.view.identity.as_ref().map_or(0, |identity| identity.sample_rate_hz);
        let before = record.view.status.as_ref();
        record.fold_back(&FoldbackSteps::between(before, &status, &Timing::at(rate)));
        record.status(status);
        // A stop of the user's that is not answered yet may be why.
        if status.state == State::Fault && self.talk.stopping().is_none() {
            record.stopped_by_itself(status.first_fault_at);
        }
        if is_first {
            record.acknowledge(status.now, Change::Session);
        }
        for ticket in std::mem::take(&mut self.status_wanted) {
            record.finish(Some(ticket), Outcome::Done { at: status.now });
        }
    }

    fn stopped(&mut self, command: &Command, event: &Event, record: &mut Record) {
        let Event::Accepted(accepted) = event else { return };
        let change = if *command == Command::Stop { Change::Stop } else { Change::EmergencyStop };
        record.acknowledge(accepted.at, change);
        for ticket in std::mem::take(&mut self.urgent) {
            record.finish(Some(ticket), Outcome::Done { at: accepted.at });
        }
        self.status_stale = true;
    }

    fn numbered(&mut self, command: Command, event: Event, record: &mut Record, now: Duration) -> Verdict {
        let is_overtaken = matches!(&self.current, Some(Current::Task(task)) if task.is_overtaken);
        if matches!(event, Event::Refused(Refusal::BadSequence { .. })) && !is_overtaken {
            self.renumberings += 1;
            if self.renumberings > RENUMBERINGS {
                return Verdict::Lose(LinkError::SessionEnded);
            }
            self.talk.say(command, now);
            return Verdict::GoOn;
        }
        self.renumberings = 0;
        match self.current.take() {
            Some(Current::Upload) => self.uploaded(event, record, now),
            Some(Current::Task(task)) => return self.done(*task, command, event, record, now),
            None => {}
        }
        Verdict::GoOn
    }

    fn done(
        &mut self,
        mut task: Task,
        command: Command,
        event: Event,
        record: &mut Record,
        now: Duration,
    ) -> Verdict {
        let at = match event {
            Event::Accepted(accepted) => accepted.at,
            Event::Refused(_) | Event::Table(_) if task.is_overtaken => {
                // Refused, or lost and something harmless took its place: the stop is what counts.
                record.finish(task.ticket, Outcome::Superseded);
                return Verdict::GoOn;
            }
            Event::Refused(Refusal::Busy(Busy::CommitPending | Busy::DriveActive))
                if matches!(task.job, Job::Drive(_)) && task.tries < BUSY_TRIES =>
            {
                // The last change is being taken up, or a stop ramps out. A newer drive takes this one's place.
                if self.tasks.iter().any(|waiting| matches!(waiting.job, Job::Drive(_))) {
                    record.superseded();
                    record.finish(task.ticket, Outcome::Superseded);
                } else {
                    task.tries += 1;
                    task.not_before = now + DRIVE_PAUSE;
                    self.tasks.push_front(task);
                }
                return Verdict::GoOn;
            }
            Event::Table(report) => {
                record.table(report);
                let now_at = record.view.status.map_or(0, |status| status.now);
                match task.job {
                    Job::FirstReadBack => {
                        self.stage = Stage::Connected;
                        self.connected(now_at, record);
                        self.arm_simulated(record);
                    }
                    _ => record.finish(task.ticket, Outcome::Done { at: now_at }),
                }
                return Verdict::GoOn;
            }
            Event::Digest(digest) => {
                self.digested(task, digest, record, now);
                return Verdict::GoOn;
            }
            #[cfg(slipline_next)]
            Event::CoilMeasured(report) => {
                record.finish(task.ticket, Outcome::Done { at: report.milliohms.into() });
                return Verdict::GoOn;
            }
            Event::BootloaderToken(token) => {
                let enter = Job::Say(Command::BootloaderEnter(token));
                self.tasks.push_front(Task::new(task.ticket, enter));
                return Verdict::GoOn;
            }
            event => {
                if self.farewell.is_some() && command == Command::Disarm {
                    return Verdict::Close;
                }
                record.finish(task.ticket, Outcome::Refused(sentence(&event)));
                self.status_stale = true;
                return Verdict::GoOn;
            }
        };
        match command {
            Command::Arm => record.acknowledge(at, Change::Armed),
            Command::Disarm => {
                record.acknowledge(at, Change::Disarmed);
                if self.farewell.is_some() {
                    return Verdict::Close;
                }
            }
            Command::Drive(drive) => {
                record.acknowledge(at, Change::Drive(Arc::new(drive)));
                if task.is_overtaken {
                    record.stop_again(at);
                }
            }
            Command::ClearFaults => self.arm_simulated(record),
            Command::DigestStart(_) => {
                let mut read = Task::new(task.ticket, Job::DigestRead);
                read.not_before = now + DIGEST_PAUSE;
                self.tasks.push_back(read);
                return Verdict::GoOn;
            }
            Command::BootloaderEnter(_) => {
                record.log(Severity::Info, "The device restarts into its bootloader.");
                record.finish(task.ticket, Outcome::Done { at });
                return Verdict::Close;
            }
            _ => {}
        }
        record.finish(task.ticket, Outcome::Done { at });
        // A drag changes the status little: the keep-alives tell it soon enough.
        let is_dragging = record.view.status.is_some_and(|status| status.state == State::Driving);
        self.status_stale |= !(is_dragging && matches!(task.job, Job::Drive(_)));
        Verdict::GoOn
    }

    fn digested(&mut self, mut task: Task, digest: Digest, record: &mut Record, now: Duration) {
        if digest.crc.is_some() {
            return record.finish(task.ticket, Outcome::Digest(digest));
        }
        task.not_before = now + DIGEST_PAUSE;
        self.tasks.push_back(task);
    }

    /// No real plate hangs on a simulated device, so it needs no leave.
    fn arm_simulated(&mut self, record: &Record) {
        if record.view.identity.as_ref().is_some_and(|identity| identity.simulated) {
            self.tasks.push_front(Task::new(None, Job::Say(Command::Arm)));
        }
    }
}

/// What to tell the user of an answer that was not hoped for.
pub(super) fn sentence(event: &Event) -> String {
    match event {
        Event::Refused(refusal) => refusal.to_string(),
        _ => "the device gave an answer that does not fit the question".to_owned(),
    }
}
