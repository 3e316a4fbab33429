//! Evaluation of a device's replies and the commands that follow: the handshake, the status, stops.
//! `numbered` evaluates the replies to tasks and uploads.

use super::queue::{CommandQueue, Next};
use super::task::{Current, Job, Stage, Task};
use crate::channel::{Answer, KEEP_ALIVE_PERIOD, Reply, writes_flash};
use crate::error::LinkError;
use crate::foldback::FoldbackSteps;
use crate::journal::Change;
use crate::log::Severity;
use crate::recorder::Recorder;
use crate::refusal::Refusal;
use crate::request::Outcome;
use crate::snapshot::LinkState;
use slipline_protocol::event::{Identity, State, Status};
use slipline_protocol::timing::Timing;
use slipline_protocol::units::SampleIndex;
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Event, refusal};
use std::sync::Arc;
use std::time::Duration;

impl CommandQueue {
    /// Decodes bytes from the device and evaluates the replies.
    pub(crate) fn receive(&mut self, bytes: &[u8], recorder: &mut Recorder, now: Duration) -> Next {
        for answer in self.channel.receive(bytes, now) {
            // The round trip of a device that is erasing its flash does not characterize the link.
            if !writes_flash(&answer.command) {
                recorder.round_trip(answer.round_trip);
            }
            let next = self.take_reply(answer, recorder, now);
            if next != Next::Continue {
                return next;
            }
        }
        Next::Continue
    }

    /// Evaluates one reply.
    fn take_reply(&mut self, answer: Answer, recorder: &mut Recorder, now: Duration) -> Next {
        let Answer { command, reply, .. } = answer;
        let event = match reply {
            Reply::Hello(version, identity) => {
                if self.stage == Stage::Hello {
                    self.take_hello(version, identity, recorder, now);
                }
                return Next::Continue;
            }
            Reply::Event(event) => *event,
        };
        if event == Event::Refused(refusal::Refusal::StaleSession) {
            // A device refuses no hello: another program has it.
            let taken = recorder.view.link.port.clone().filter(|_| self.stage == Stage::Hello);
            return Next::Lose(taken.map_or(LinkError::SessionEnded, LinkError::Busy));
        }
        if matches!(command, Command::Stop | Command::EmergencyStop) {
            self.stopped(&command, &event, recorder);
        } else if matches!(command, Command::KeepAlive(_) | Command::Status) {
            self.reported(&event, recorder);
        } else {
            return self.numbered(command, event, recorder, now);
        }
        Next::Continue
    }

    fn take_hello(
        &mut self,
        version: Version,
        identity: Option<Box<Identity>>,
        recorder: &mut Recorder,
        now: Duration,
    ) {
        let compatibility = Version::OURS.judge_device(version);
        recorder.view.device.compatibility = Some(compatibility);
        if let Some(identity) = &identity {
            let (major, minor, patch) = identity.firmware;
            recorder
                .log(Severity::Info, format!("{} with firmware {major}.{minor}.{patch}.", identity.board));
            if !identity.crash.is_empty() {
                recorder
                    .log(Severity::Error, format!("Before its last reset it crashed: {}", identity.crash));
            }
        }
        recorder.view.device.identity = identity.map(|identity| Arc::new(*identity));
        if compatibility.may_drive() && recorder.view.device.identity.is_some() {
            self.stage = Stage::Reading;
            self.keep_alive_due = now + KEEP_ALIVE_PERIOD;
            self.channel.keep_alive(now);
            self.tasks.push_front(Task::new(None, Job::FirstReadBack));
            for command in [
                Command::Inputs,
                Command::Analogue,
                Command::Profile,
                Command::Wear,
                Command::Board,
                Command::Maintenance,
            ] {
                if self.channel.is_known(&command) {
                    self.tasks.push_front(Task::new(None, Job::Send(command)));
                }
            }
        } else {
            self.stage = Stage::Limited;
            recorder.log(Severity::Warning, compatibility.sentence());
            self.connected(0, recorder);
        }
    }

    /// The device and its table are known: the connection is established.
    pub(super) fn connected(&mut self, at: u64, recorder: &mut Recorder) {
        recorder.view.link.error = None;
        recorder.link(LinkState::Connected);
        recorder.finish(self.connect.take(), Outcome::Done { at });
    }

    fn take_status(&mut self, status: Status, recorder: &mut Recorder) {
        let is_first = recorder.view.drive.status.is_none();
        let rate = recorder.view.device.identity.as_ref().map_or(0, |identity| identity.sample_rate_hz);
        let before = recorder.view.drive.status.as_ref();
        recorder.fold_back(&FoldbackSteps::between(before, &status, &Timing::at(rate)));
        recorder.status(status);
        self.ask_for_trigger(recorder);
        // A stop or a disarm by the user that is not answered yet may be the cause.
        if self.channel.pending_stop().is_none() {
            if status.state == State::Fault {
                recorder.stopped_by_itself(status.first_fault_at);
            }
            // Unless a disarm has been sent and is not answered yet.
            if !matches!(&self.current, Some(Current::Task(task)) if matches!(task.job, Job::Send(Command::Disarm)))
            {
                recorder.end_lease(&status);
            }
        }
        if is_first {
            recorder.acknowledge(status.now, Change::Session);
        }
        for ticket in std::mem::take(&mut self.status_asked) {
            recorder.finish(Some(ticket), Outcome::Done { at: status.now });
        }
    }

    /// Evaluates the reply to a stop.
    fn stopped(&mut self, command: &Command, event: &Event, recorder: &mut Recorder) {
        let outcome = match accepted_at(event) {
            Ok(at) => {
                let change = if *command == Command::Stop { Change::Stop } else { Change::EmergencyStop };
                recorder.acknowledge(at, change);
                Outcome::Done { at }
            }
            Err(refusal) => Outcome::Refused(refusal),
        };
        for ticket in std::mem::take(&mut self.urgent) {
            recorder.finish(Some(ticket), outcome.clone());
        }
        self.status_stale = true;
    }

    /// Evaluates the reply to a keep-alive or a status request. After any other event the next keep-alive
    /// repeats the request.
    fn reported(&mut self, event: &Event, recorder: &mut Recorder) {
        if let Event::Status(status) = event {
            self.take_status(*status, recorder);
        } else if let Err(refusal @ Refusal::Device(_)) = accepted_at(event) {
            for ticket in std::mem::take(&mut self.status_asked) {
                recorder.finish(Some(ticket), Outcome::Refused(refusal.clone()));
            }
        }
    }
}

/// The index at which the device carries out the command, or its refusal.
fn accepted_at(event: &Event) -> Result<SampleIndex, Refusal> {
    if let Event::Refused(refusal) = event {
        return Err(Refusal::Device(*refusal));
    }
    event.accepted_at().ok_or(Refusal::UnexpectedReply)
}
