//! Selection of the next command to the device.
//!
//! Tasks are sent in order, one numbered command at a time. An upload runs beside them, one step whenever the
//! channel is free. A stop is sent at once and overtakes the jobs that it would undo ([`Job::yields_to`]):
//! unsent jobs are dropped, sent ones are never repeated, and later ones wait until the stop is answered,
//! since a repeat of the stop would undo them.

use super::task::{Current, Job, Stage, Task};
use super::upload::{Upload, Uploads};
use crate::channel::{Channel, KEEP_ALIVE_PERIOD};
use crate::drive::DriveError;
use crate::error::LinkError;
use crate::recorder::Recorder;
use crate::refusal::Refusal;
use crate::request::{Outcome, Request, Ticket};
use slipline_protocol::Command;
use slipline_protocol::board::MuteStep;
use slipline_protocol::command::{ArmLease, ProfileSetting};
use slipline_protocol::listen::{CapturePart, ListenPart};
use slipline_protocol::units::SampleIndex;
use std::collections::VecDeque;
use std::time::Duration;

/// Longest wait of a disconnect for the device's replies; afterwards the dead-man stops the device.
const CLOSING: Duration = Duration::from_millis(400);

/// The connection's next step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Next {
    Continue,
    /// Stopped and disarmed: close the port.
    Close,
    /// Close the port: the device restarts into its bootloader, after this sample.
    EnterBootloader(Option<Ticket>, SampleIndex),
    /// Close the port, and look for the device again.
    Lose(LinkError),
}

/// The commands to one device, from hello to closing.
#[derive(Debug, Default)]
pub(crate) struct CommandQueue {
    pub(super) channel: Channel,
    pub(super) stage: Stage,
    pub(super) connect: Option<Ticket>,
    pub(super) tasks: VecDeque<Task>,
    pub(super) current: Option<Current>,
    pub(super) urgent: Vec<Ticket>,
    pub(super) uploads: Uploads,
    upload_turn: bool,
    pub(super) keep_alive_due: Duration,
    /// Requests for a status for which nothing has been sent yet.
    status_wanted: Vec<Ticket>,
    /// Requests for a status that the reply to the present keep-alive or status request answers.
    pub(super) status_asked: Vec<Ticket>,
    /// A change has occurred that the status reports, so the status is requested before the next keep-alive.
    pub(super) status_stale: bool,
    pub(super) renumberings: u32,
    pub(super) closing: Option<Duration>,
}

impl CommandQueue {
    /// Starts a session with a hello.
    pub(crate) fn begin(nonce: [u8; 4], keeps_frames: bool, connect: Option<Ticket>, now: Duration) -> Self {
        let mut channel = Channel::new(nonce, keeps_frames);
        let hello = channel.hello();
        channel.send(hello, now);
        Self { channel, connect, keep_alive_due: now + KEEP_ALIVE_PERIOD, ..Self::default() }
    }

    pub(crate) const fn channel(&mut self) -> &mut Channel {
        &mut self.channel
    }

    pub(crate) const fn output(&mut self) -> &mut Vec<u8> {
        self.channel.output()
    }

    /// Whether all commands have been written.
    pub(crate) fn is_written(&self) -> bool {
        self.channel.is_written()
    }

    /// Whether the device has answered the hello.
    pub(crate) fn is_identified(&self) -> bool {
        self.stage != Stage::Hello
    }

    /// Queues a request to the device.
    pub(crate) fn request(
        &mut self,
        ticket: Ticket,
        request: Request,
        recorder: &mut Recorder,
        now: Duration,
    ) {
        let limited = self.stage == Stage::Limited;
        // Requests that a device of another version accepts, too.
        let is_for_any_version = matches!(
            request,
            Request::Stop | Request::EmergencyStop | Request::Refresh | Request::Bootloader
        );
        if limited && !is_for_any_version {
            let refusal =
                recorder.view.device.compatibility.map_or(Refusal::UnexpectedReply, Refusal::Incompatible);
            return recorder.finish(Some(ticket), Outcome::Refused(refusal));
        }
        let job = match request {
            Request::Stop => return self.stop(ticket, Command::Stop, recorder, now),
            Request::EmergencyStop => return self.stop(ticket, Command::EmergencyStop, recorder, now),
            Request::Refresh if limited => return recorder.finish(Some(ticket), Outcome::Done { at: 0 }),
            Request::Refresh => return self.status_wanted.push(ticket),
            Request::Bootloader => Job::Send(Command::BootloaderToken),
            Request::Arm => Job::Send(Command::Arm),
            Request::ArmFor(lease) => Job::Send(Command::ArmFor(in_ms(lease))),
            Request::Bench(lease) => Job::Send(Command::Bench(in_ms(lease))),
            Request::MutePin(trial) => Job::Send(Command::MutePin(MuteStep { trial })),
            Request::ReadBoard => {
                if self.channel.is_known(&Command::Inputs) {
                    self.tasks.push_back(Task::new(None, Job::Send(Command::Inputs)));
                }
                Job::Send(Command::Board)
            }
            Request::ReadClock => Job::Send(Command::Clock),
            Request::Stall => Job::Send(Command::Stall),
            Request::BrownOut(order) => Job::Send(Command::BrownOut(order)),
            Request::FaultToken => Job::Send(Command::FaultToken),
            Request::FaultOrder(order) => Job::Send(Command::FaultOrder(order)),
            Request::Disarm => {
                self.overtake(recorder, |job| job.yields_to(&Command::Disarm));
                Job::Send(Command::Disarm)
            }
            Request::ClearFaults => Job::Send(Command::ClearFaults),
            Request::ReadBack => Job::Send(Command::TableDigest),
            Request::Store => Job::Send(Command::Store),
            Request::Forget => Job::Send(Command::Forget),
            Request::WriteProfile(profile) => {
                Job::Send(Command::WriteProfile(ProfileSetting { profile: *profile }))
            }
            Request::Digest(window) => Job::Send(Command::DigestStart(window)),
            Request::Upload(table) => Job::BeginUpload(Upload::new(ticket, table)),
            Request::CancelUpload => Job::CancelUpload,
            Request::Play(sounding) => {
                self.drop_tasks(recorder, Job::sounds);
                Job::Play(sounding)
            }
            Request::Listen(listen) => Job::Listen(listen),
            Request::Capture(capture) => Job::Capture(capture),
            Request::Hold(hold) => Job::Hold(hold),
            // The connection handles these itself.
            Request::Connect(_)
            | Request::Disconnect
            | Request::AutoReconnect(_)
            | Request::Observe
            | Request::Await(_)
            | Request::Note(..) => return,
        };
        self.tasks.push_back(Task::new(Some(ticket), job));
    }

    fn stop(&mut self, ticket: Ticket, command: Command, recorder: &mut Recorder, now: Duration) {
        self.overtake(recorder, |job| job.yields_to(&command));
        self.urgent.push(ticket);
        self.send_stop(command, now);
    }

    /// Sends a stop; an unanswered emergency stop is sent again instead of a weaker stop.
    fn send_stop(&mut self, command: Command, now: Duration) {
        let unanswered = self.channel.pending_stop().filter(|stop| **stop == Command::EmergencyStop);
        let command = unanswered.cloned().unwrap_or(command);
        self.channel.send(command, now);
    }

    /// Drops unsent jobs of this kind, and prevents the repetition of sent ones.
    fn overtake(&mut self, recorder: &mut Recorder, which: impl Fn(&Job) -> bool) {
        self.drop_tasks(recorder, &which);
        if let Some(Current::Task(task)) = &mut self.current
            && which(&task.job)
        {
            task.is_overtaken = true;
            self.channel.withdraw();
        }
    }

    pub(super) fn drop_tasks(&mut self, recorder: &mut Recorder, which: impl Fn(&Job) -> bool) {
        self.tasks.retain(|task| {
            let drop = which(&task.job);
            if drop {
                if task.job.sounds() {
                    recorder.superseded();
                }
                recorder.finish(task.ticket, Outcome::Superseded);
            }
            !drop
        });
    }

    /// Stops the drive and disarms; [`Next::Close`] follows. A closing under way continues unchanged.
    pub(crate) fn leave(&mut self, recorder: &mut Recorder, now: Duration) {
        if self.closing.is_some() {
            return;
        }
        self.overtake(recorder, |_| true);
        if self.stage == Stage::Limited || !self.is_identified() {
            self.closing = Some(now);
            return;
        }
        self.send_stop(Command::Stop, now);
        self.tasks.push_back(Task::new(None, Job::Send(Command::Disarm)));
        self.closing = Some(now + CLOSING);
    }

    /// Stops and disarms, since the driving program no longer responds. Jobs that would sound, arm or clear a
    /// fault are dropped; an upload continues. A closing already does the same.
    pub(crate) fn abandon(&mut self, recorder: &mut Recorder, now: Duration) {
        if self.closing.is_some() {
            return;
        }
        self.overtake(recorder, |job| job.yields_to(&Command::EmergencyStop));
        self.send_stop(Command::Stop, now);
        self.tasks.push_front(Task::new(None, Job::Send(Command::Disarm)));
    }

    /// Ends the session; pending requests end with `outcome`.
    pub(crate) fn end(mut self, recorder: &mut Recorder, outcome: &Outcome) {
        if let Some(Current::Task(task)) = self.current.take() {
            recorder.finish(task.ticket, outcome.clone());
        }
        let upload = self.uploads.end();
        let tasks = self.tasks.iter().filter_map(|task| task.ticket);
        let status = self.status_wanted.iter().chain(&self.status_asked);
        let open: Vec<Ticket> =
            self.urgent.iter().chain(status).copied().chain(upload).chain(tasks).collect();
        for ticket in open {
            recorder.finish(Some(ticket), outcome.clone());
        }
        if let Some(ticket) = self.connect {
            recorder.finish(Some(ticket), outcome.clone());
        }
    }

    /// Repeats overdue commands and sends due ones.
    pub(crate) fn send_due(&mut self, recorder: &mut Recorder, now: Duration) -> Next {
        if self.channel.tick(now).is_err() {
            return Next::Lose(LinkError::Silent);
        }
        if self.closing.is_some_and(|end| now >= end) {
            return Next::Close;
        }
        if now >= self.keep_alive_due {
            self.keep_alive_due = now + KEEP_ALIVE_PERIOD;
            match self.stage {
                Stage::Hello => {}
                Stage::Limited if !self.channel.awaits_periodic() => {
                    let hello = self.channel.hello();
                    self.channel.send(hello, now);
                }
                Stage::Limited => {}
                Stage::Reading | Stage::Connected => {
                    self.channel.keep_alive(now);
                    self.status_asked.append(&mut self.status_wanted);
                }
            }
        }
        let is_wanted = self.status_stale || !self.status_wanted.is_empty();
        if is_wanted
            && matches!(self.stage, Stage::Reading | Stage::Connected)
            && !self.channel.awaits_periodic()
        {
            self.status_stale = false;
            self.channel.send(Command::Status, now);
            self.status_asked.append(&mut self.status_wanted);
        }
        while self.channel.is_free() && self.is_identified() && self.send_next(recorder, now) {}
        Next::Continue
    }

    /// When [`CommandQueue::send_due`] must be called next.
    pub(crate) fn deadline(&self) -> Duration {
        let mut deadline = self.keep_alive_due;
        deadline = deadline.min(self.channel.deadline().unwrap_or(deadline));
        deadline = deadline.min(self.closing.unwrap_or(deadline));
        if self.channel.is_free() && self.is_identified() {
            let upload = self.uploads.current().map(|upload| upload.not_before).into_iter();
            let tasks = self.candidates().map(|(_, task)| task.not_before);
            deadline = deadline.min(upload.chain(tasks).min().unwrap_or(deadline));
        }
        deadline
    }

    /// Candidates for the next task: the first one that requests no result, and the requests for results
    /// before it, which let others pass until the device may have the result. No task passes one that waits for a
    /// stop's reply.
    fn candidates(&self) -> impl Iterator<Item = (usize, &Task)> {
        let first = self.tasks.iter().position(|task| !task.job.asks_for_result());
        let is_held = |task: &Task| self.channel.pending_stop().is_some_and(|stop| task.job.yields_to(stop));
        let count = first.map_or(self.tasks.len(), |first| first + 1);
        self.tasks.iter().enumerate().take(count).filter(move |(_, task)| !is_held(task))
    }

    /// Sends the next due command; returns whether there was one.
    fn send_next(&mut self, recorder: &mut Recorder, now: Duration) -> bool {
        let due = self.candidates().find(|(_, task)| now >= task.not_before).map(|(at, _)| at);
        let upload_due = self.uploads.current().is_some_and(|upload| now >= upload.not_before);
        if upload_due && (due.is_none() || self.upload_turn) {
            self.upload_turn = false;
            if let Some(upload) = self.uploads.current() {
                let command = upload.command();
                self.channel.send(command, now);
                self.current = Some(Current::Upload);
            }
            return true;
        }
        let Some(task) = due.and_then(|at| self.tasks.remove(at)) else { return false };
        self.upload_turn = true;
        let command = match &task.job {
            Job::Send(command @ Command::ArmFor(_)) if !self.channel.is_known(command) => Command::Arm,
            Job::Send(command) => command.clone(),
            Job::ArmUnasked => Command::Arm,
            Job::FirstReadBack => Command::TableDigest,
            Job::DigestRead => Command::DigestRead,
            Job::HoldRead => Command::HoldRead,
            Job::Listen(request) => Command::Listen(request.window()),
            Job::Capture(request) => Command::Capture(*request),
            Job::ListenRead(reading) => Command::ListenRead(ListenPart {
                input: reading.request.input,
                first_slot: reading.first_slot,
            }),
            // At most 4096 values.
            Job::CaptureRead(reading) => {
                Command::CaptureRead(CapturePart { first: reading.captured.values.len() as u16 })
            }
            Job::Hold(request) => {
                let Some(identity) = &recorder.view.device.identity else { return true };
                match request.for_device(identity, recorder.view.slowest_limit().as_ref()) {
                    Ok(setting) => Command::Hold(setting),
                    Err(error) => return refuse(&task, error, recorder),
                }
            }
            Job::BeginUpload(upload) => {
                self.uploads.begin(upload, recorder);
                return true;
            }
            Job::CancelUpload => match self.uploads.cancel(task.ticket, recorder) {
                Some(command) => command,
                None => return true,
            },
            Job::Play(sounding) => {
                let view = &recorder.view;
                let Some(identity) = &view.device.identity else { return true };
                let (table, travel) = (view.table.report.active.as_ref(), view.slowest_limit());
                match sounding.for_device(identity, table, travel.as_ref()) {
                    Ok(command) => command,
                    Err(error) => return refuse(&task, error, recorder),
                }
            }
        };
        if !self.channel.is_known(&command) {
            recorder.finish(task.ticket, Outcome::DeviceTooOld);
            return true;
        }
        self.channel.send(command, now);
        self.current = Some(Current::Task(Box::new(task)));
        true
    }
}

/// A lease as the device takes it; longer than it allows is refused there.
fn in_ms(lease: Duration) -> ArmLease {
    ArmLease { lease_ms: u32::try_from(lease.as_millis()).unwrap_or(u32::MAX) }
}

/// Ends a task that cannot be converted to the device's units; the next one may be sent.
fn refuse(task: &Task, error: DriveError, recorder: &mut Recorder) -> bool {
    recorder.finish(task.ticket, Outcome::Refused(error.into()));
    true
}
