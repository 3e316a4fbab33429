//! Replies to numbered commands, and the next step of their task or upload.

use super::queue::{CommandQueue, Next};
use super::task::{Current, Job, Stage, Task};
use super::upload::{BUSY_PAUSE, BUSY_TRIES};
use crate::channel::writes_flash;
use crate::error::LinkError;
use crate::journal::Change;
use crate::log::Severity;
use crate::played::Played;
use crate::recorder::Recorder;
use crate::refusal::Refusal;
use crate::request::Outcome;
use crate::sounding::Sounding;
use slipline_protocol::command::Apply;
use slipline_protocol::event::{Digest, State};
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::units::SampleIndex;
use slipline_protocol::{Command, Event, refusal};
use std::time::Duration;

/// Time after which a drive is sent again that arrived before the device had taken up the previous one: three
/// blocks of 128 codes at 400 kS/s.
const DRIVE_PAUSE: Duration = Duration::from_millis(1);
/// Time between two requests for a digest until its window is over.
const DIGEST_PAUSE: Duration = Duration::from_millis(20);
/// Renumbering attempts before the device is considered lost.
const RENUMBERINGS: u32 = 3;

impl CommandQueue {
    /// Evaluates the reply to a numbered command.
    pub(super) fn numbered(
        &mut self,
        command: Command,
        event: Event,
        recorder: &mut Recorder,
        now: Duration,
    ) -> Next {
        let is_overtaken = matches!(&self.current, Some(Current::Task(task)) if task.is_overtaken);
        if matches!(event, Event::Refused(refusal::Refusal::BadSequence { .. })) && !is_overtaken {
            self.renumberings += 1;
            if self.renumberings > RENUMBERINGS {
                return Next::Lose(LinkError::SessionEnded);
            }
            self.channel.send(command, now);
            return Next::Continue;
        }
        self.renumberings = 0;
        match self.current.take() {
            Some(Current::Upload) => {
                let after = self.uploads.take_reply(event, recorder, now);
                if let Some(command) = after.command {
                    self.channel.send(command, now);
                    self.current = Some(Current::Upload);
                }
                self.status_stale |= after.is_status_stale;
            }
            Some(Current::Task(task)) => return self.done(*task, command, event, recorder, now),
            None => {}
        }
        Next::Continue
    }

    fn done(
        &mut self,
        task: Task,
        command: Command,
        event: Event,
        recorder: &mut Recorder,
        now: Duration,
    ) -> Next {
        match event {
            Event::Accepted(accepted) => {
                if matches!(command, Command::Drive(_) | Command::Chord(_) | Command::Comb(_)) {
                    recorder.view.drive.glide_until = None;
                }
                return self.accepted(task, command, accepted.at, recorder, now);
            }
            Event::AcceptedUntil(accepted) => {
                recorder.view.drive.glide_until = Some(accepted);
                return self.accepted(task, command, accepted.at, recorder, now);
            }
            Event::Unchanged(accepted) => {
                recorder
                    .log(Severity::Info, "The device's flash holds this already: it was not written again.");
                return self.accepted(task, command, accepted.at, recorder, now);
            }
            Event::Refused(_) | Event::Table(_) if task.is_overtaken => {
                // Refused; or lost, and a harmless command took its number: the stop prevails.
                recorder.finish(task.ticket, Outcome::Superseded);
            }
            Event::Refused(refusal::Refusal::Busy(Busy::CommitPending | Busy::DriveActive))
                if task.job.sounds() && task.tries < BUSY_TRIES =>
            {
                self.try_drive_again(task, recorder, now);
            }
            Event::Refused(refusal::Refusal::Busy(Busy::CommitPending))
                if matches!(task.job, Job::Hold(_)) && task.tries < BUSY_TRIES =>
            {
                self.tasks.push_front(Task { tries: task.tries + 1, not_before: now + DRIVE_PAUSE, ..task });
            }
            // Not requested by the user, who will therefore not retry; the link retries.
            Event::Refused(refusal::Refusal::Busy(_))
                if matches!(task.job, Job::ArmUnasked) && task.tries < BUSY_TRIES =>
            {
                self.tasks.push_front(Task { tries: task.tries + 1, not_before: now + BUSY_PAUSE, ..task });
            }
            // A device that was just disarmed takes some milliseconds to switch its amplifier off; a ramp
            // takes longer.
            Event::Refused(refusal::Refusal::Busy(Busy::DriveActive))
                if writes_flash(&command)
                    && task.tries < BUSY_TRIES
                    && recorder.view.drive.status.is_some_and(|status| status.state != State::Driving) =>
            {
                self.tasks.push_front(Task { tries: task.tries + 1, not_before: now + BUSY_PAUSE, ..task });
            }
            Event::Refused(refusal) => {
                return self.refused(&task, &command, Refusal::Device(refusal), recorder);
            }
            Event::Maintenance(reported) => recorder.take(task.ticket, |it| it.maintenance(reported)),
            Event::Wear(reported) => recorder.take(task.ticket, |it| it.view.device.wear = Some(reported)),
            Event::Profile(reported) => recorder.take(task.ticket, |it| it.profile(reported)),
            Event::Board(reported) => recorder.take(task.ticket, |it| it.board(reported)),
            Event::Analogue(reported) => recorder.take(task.ticket, |it| it.analogue(reported)),
            Event::MutePin(reported) => {
                recorder.take(task.ticket, |it| it.view.device.mute_pin = Some(reported));
                self.status_stale = true;
            }
            Event::Clock(reported) => recorder.take(task.ticket, |it| it.view.device.clock = Some(reported)),
            Event::BrownOut(reported) => recorder.take(task.ticket, |it| it.brown_out(reported)),
            Event::FaultTrial(reported) => {
                recorder.take(task.ticket, |it| it.view.device.fault_trial = Some(reported));
            }
            Event::Table(report) => {
                recorder.table(report);
                let now_at = recorder.view.drive.status.map_or(0, |status| status.now);
                if matches!(task.job, Job::FirstReadBack) {
                    self.stage = Stage::Connected;
                    self.connected(now_at, recorder);
                    self.arm_unasked(recorder);
                } else {
                    recorder.finish(task.ticket, Outcome::Done { at: now_at });
                }
            }
            Event::Trigger(report) => {
                recorder.trigger(report);
                // A present fault may have ended the drive that began.
                let fault = recorder.view.drive.status.filter(|status| status.state == State::Fault);
                if let Some(status) = fault.filter(|_| self.channel.pending_stop().is_none()) {
                    recorder.stopped_by_itself(status.first_fault_at);
                }
                recorder.finish(task.ticket, Outcome::Done { at: report.began.unwrap_or(0) });
            }
            Event::Digest(digest) => self.digested(task, digest, recorder, now),
            Event::Inputs(reported) => {
                recorder.view.device.inputs = Some(reported);
                recorder.finish(task.ticket, Outcome::Done { at: reported.now });
            }
            Event::Listened(reported) => self.listened(task, &reported, recorder, now),
            Event::Captured(reported) => self.captured(task, &reported, recorder, now),
            Event::Held(reported) => self.held(&task, reported, recorder, now),
            Event::BootloaderToken(token) => {
                let enter = Job::Send(Command::BootloaderEnter(token));
                self.tasks.push_front(Task::new(task.ticket, enter));
            }
            Event::Hello(_) | Event::Status(_) | Event::TravelLimit(_) => {
                return self.refused(&task, &command, Refusal::UnexpectedReply, recorder);
            }
        }
        Next::Continue
    }

    /// The previous change is being taken up, or a stop is ramping down: the drive is sent again soon, unless
    /// a newer one waits.
    fn try_drive_again(&mut self, mut task: Task, recorder: &mut Recorder, now: Duration) {
        if self.tasks.iter().any(|waiting| waiting.job.sounds()) {
            recorder.superseded();
            recorder.finish(task.ticket, Outcome::Superseded);
        } else {
            task.tries += 1;
            task.not_before = now + DRIVE_PAUSE;
            self.tasks.push_front(task);
        }
    }

    fn refused(&mut self, task: &Task, command: &Command, refusal: Refusal, recorder: &mut Recorder) -> Next {
        // A client whose window has already begun requests another from now on.
        let is_late = matches!(command, Command::Listen(_))
            && matches!(refusal, Refusal::Device(refusal::Refusal::OutOfRange { field: Field::ApplyAt, .. }));
        if is_late {
            recorder.finish_unlogged(task.ticket, Outcome::Refused(refusal));
        } else {
            recorder.finish(task.ticket, Outcome::Refused(refusal));
        }
        self.status_stale = true;
        self.after(command)
    }

    /// A closing is complete once the device has answered a disarm, whoever asked for it.
    fn after(&self, command: &Command) -> Next {
        if self.closing.is_some() && *command == Command::Disarm { Next::Close } else { Next::Continue }
    }

    fn accepted(
        &mut self,
        task: Task,
        command: Command,
        at: SampleIndex,
        recorder: &mut Recorder,
        now: Duration,
    ) -> Next {
        let next = self.after(&command);
        match command {
            Command::Arm => recorder.acknowledge(at, Change::Armed),
            Command::ArmFor(lease) | Command::Bench(lease) => {
                recorder.acknowledge(at, Change::Armed);
                recorder.begin_lease(lease, at);
            }
            Command::Disarm => {
                recorder.lease.end();
                recorder.acknowledge(at, Change::Disarmed);
            }
            Command::Drive(drive) => self.sounds(&task, drive.into(), at, recorder),
            Command::Chord(chord) => self.sounds(&task, chord.into(), at, recorder),
            Command::Comb(comb) => self.sounds(&task, comb.into(), at, recorder),
            Command::Listen(_) => {
                self.listens(&task, at, recorder, now);
                return Next::Continue;
            }
            Command::Capture(_) => {
                self.captures(&task, at, recorder, now);
                return Next::Continue;
            }
            Command::Hold(setting) => self.holds(&setting, at, recorder, now),
            Command::ClearFaults => self.arm_unasked(recorder),
            Command::DigestStart(_) => {
                let mut read = Task::new(task.ticket, Job::DigestRead);
                read.not_before = now + DIGEST_PAUSE;
                self.tasks.push_back(read);
                return Next::Continue;
            }
            Command::BootloaderEnter(_) => {
                recorder.log(Severity::Info, "The device restarts into its bootloader.");
                return Next::EnterBootloader(task.ticket, at);
            }
            Command::WriteProfile(_) => self.read_again(&[Command::Profile, Command::Wear]),
            Command::Store | Command::Forget => self.read_again(&[Command::Maintenance, Command::Wear]),
            // They do not change the journal, or are not sent as tasks.
            Command::Maintenance
            | Command::Board
            | Command::Profile
            | Command::Wear
            | Command::Analogue
            | Command::MutePin(_)
            | Command::Clock
            | Command::Stall
            | Command::BrownOut(_)
            | Command::SetTravelLimit(_)
            | Command::TravelLimit
            | Command::Trigger
            | Command::TableBegin(_)
            | Command::TableChunk(_)
            | Command::TableCommit
            | Command::TableAbort
            | Command::TableDigest
            | Command::DigestRead
            | Command::Inputs
            | Command::ListenRead(_)
            | Command::ListenStop
            | Command::CaptureRead(_)
            | Command::CaptureStop
            | Command::HoldRead
            | Command::BootloaderToken
            | Command::FaultToken
            | Command::FaultOrder(_)
            | Command::Hello(_)
            | Command::KeepAlive(_)
            | Command::Status
            | Command::Stop
            | Command::EmergencyStop => {}
        }
        recorder.finish(task.ticket, Outcome::Done { at });
        // A drag changes the status little; the keep-alives report it soon enough.
        let is_dragging = recorder.view.drive.status.is_some_and(|status| status.state == State::Driving);
        self.status_stale |= !(is_dragging && matches!(task.job, Job::Play(Sounding::Drive(_))));
        next
    }

    /// Reads again what the device reports of itself, as far as it knows the messages.
    fn read_again(&mut self, reports: &[Command]) {
        for report in reports {
            if self.channel.is_known(report) {
                self.tasks.push_back(Task::new(None, Job::Send(report.clone())));
            }
        }
    }

    /// Records a drive, a chord or a comb that the device has accepted.
    fn sounds(&mut self, task: &Task, played: Played, at: SampleIndex, recorder: &mut Recorder) {
        let waits = played.apply() == Apply::AtTrigger;
        recorder.lease.drive(at);
        if waits {
            recorder.wait_for_trigger(at, Change::Play(played));
        } else {
            recorder.acknowledge(at, Change::Play(played));
        }
        if task.is_overtaken {
            recorder.stop_again(at);
        }
        self.ask_for_trigger(recorder);
        self.status_stale |= waits;
    }

    /// Requests the outcome of a drive that waited for the trigger input, if it is not known.
    pub(super) fn ask_for_trigger(&mut self, recorder: &Recorder) {
        let asks = |task: &Task| matches!(task.job, Job::Send(Command::Trigger));
        let is_asked =
            self.tasks.iter().any(asks) || matches!(&self.current, Some(Current::Task(task)) if asks(task));
        if recorder.must_ask_for_trigger() && !is_asked {
            self.tasks.push_front(Task::new(None, Job::Send(Command::Trigger)));
        }
    }

    fn digested(&mut self, mut task: Task, digest: Digest, recorder: &mut Recorder, now: Duration) {
        if digest.crc.is_some() {
            return recorder.finish(task.ticket, Outcome::Digest(digest));
        }
        task.not_before = now + DIGEST_PAUSE;
        self.tasks.push_back(task);
    }

    /// Arms the device if no request of the user is needed.
    fn arm_unasked(&mut self, recorder: &Recorder) {
        if recorder.view.may_arm_unasked() {
            self.tasks.push_front(Task::new(None, Job::ArmUnasked));
        }
    }
}
