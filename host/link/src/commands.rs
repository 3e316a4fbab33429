//! What to say to a connected device next; what its answers mean is in [`answers`], a table's way in [`uploading`].
//!
//! Tasks are said in order, one numbered command at a time. An upload runs beside them, a step whenever the lane is
//! free. A stop goes out at once and overtakes what it would undo ([`Job::yields_to`]): what has not been said is
//! thrown away, what has been said is never said again, and what is asked for later waits until the stop is answered,
//! since its repeat would undo it.

mod answers;
mod upload;
mod uploading;

use crate::channel::{Conversation, KEEP_ALIVE_PERIOD};
use crate::error::LinkError;
use crate::journal::Record;
use crate::request::{DriveRequest, Outcome, Request, Ticket};
use slipline_protocol::Command;
use slipline_protocol::version::Compatibility;
use std::collections::VecDeque;
use std::time::Duration;
use upload::{BUSY_TRIES, Upload};

/// A disconnect waits so long for the device to agree; then the dead-man has to do.
const FAREWELL: Duration = Duration::from_millis(400);

/// One thing to say.
#[derive(Clone, Debug)]
enum Job {
    /// A command that needs no more than to be said.
    Say(Command),
    Drive(DriveRequest),
    BeginUpload(Upload),
    CancelUpload,
    DigestRead,
    /// Read the table's digest to complete the greeting.
    FirstReadBack,
}

impl Job {
    /// Whether this stop, emergency stop or disarm undoes it.
    const fn yields_to(&self, stop: &Command) -> bool {
        match self {
            Self::Drive(_) => true,
            Self::Say(Command::Arm | Command::ClearFaults) => matches!(stop, Command::EmergencyStop),
            _ => false,
        }
    }
}

#[derive(Clone, Debug)]
struct Task {
    /// None for what the link does by itself.
    ticket: Option<Ticket>,
    job: Job,
    tries: u32,
    not_before: Duration,
    /// A stop came after it had been said: whatever the answer, it is not said again.
    is_overtaken: bool,
}

impl Task {
    const fn new(ticket: Option<Ticket>, job: Job) -> Self {
        Self { ticket, job, tries: 0, not_before: Duration::ZERO, is_overtaken: false }
    }
}

/// What waits for the answer of the numbered lane.
#[derive(Clone, Debug)]
enum Current {
    Task(Box<Task>),
    Upload,
}

/// How far the acquaintance goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The hello is out.
    Greeting,
    /// Greeted; status and table are being read.
    Reading,
    Connected,
    /// Greeted by a version that may not be driven.
    Limited,
}

/// What the connection has to do after an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    GoOn,
    /// The farewell is over: close.
    Close,
    /// Close, and look for it again.
    Lose(LinkError),
}

/// The talk with one device, from hello to farewell.
#[derive(Debug)]
pub(super) struct Dialogue {
    talk: Conversation,
    stage: Stage,
    connect: Option<Ticket>,
    tasks: VecDeque<Task>,
    current: Option<Current>,
    urgent: Vec<Ticket>,
    upload: Option<Upload>,
    upload_turn: bool,
    keep_alive_due: Duration,
    status_wanted: Vec<Ticket>,
    /// Something happened that shows in the status.
    status_stale: bool,
    renumberings: u32,
    farewell: Option<Duration>,
}

impl Dialogue {
    /// Begins with a hello.
    pub(super) fn begin(nonce: [u8; 4], connect: Option<Ticket>, now: Duration) -> Self {
        let mut talk = Conversation::new(nonce);
        let hello = talk.hello();
        talk.say(hello, now);
        Self {
            talk,
            stage: Stage::Greeting,
            connect,
            tasks: VecDeque::new(),
            current: None,
            urgent: Vec::new(),
            upload: None,
            upload_turn: false,
            keep_alive_due: now + KEEP_ALIVE_PERIOD,
            status_wanted: Vec::new(),
            status_stale: false,
            renumberings: 0,
            farewell: None,
        }
    }

    pub(super) const fn talk(&self) -> &Conversation {
        &self.talk
    }

    pub(super) const fn output(&mut self) -> &mut Vec<u8> {
        self.talk.output()
    }

    /// Whether all that was said has been written.
    pub(super) fn is_written(&self) -> bool {
        self.talk.is_written()
    }

    /// Whether the device has answered the hello.
    pub(super) fn is_greeted(&self) -> bool {
        self.stage != Stage::Greeting
    }

    /// Takes a request for the device.
    pub(super) fn request(&mut self, ticket: Ticket, request: Request, record: &mut Record, now: Duration) {
        let limited = self.stage == Stage::Limited;
        let job = match request {
            Request::Stop => return self.stop(ticket, Command::Stop, record, now),
            Request::EmergencyStop => return self.stop(ticket, Command::EmergencyStop, record, now),
            Request::Refresh if limited => return record.finish(Some(ticket), Outcome::Done { at: 0 }),
            Request::Refresh => return self.status_wanted.push(ticket),
            Request::Bootloader => Job::Say(Command::BootloaderToken),
            _ if limited => {
                let sentence = record.view.compatibility.map_or("", Compatibility::sentence);
                return record.finish(Some(ticket), Outcome::Refused(sentence.to_owned()));
            }
            #[cfg(slipline_next)]
            Request::MeasureCoil => {
                Job::Say(Command::MeasureCoil(slipline_protocol::command::CoilTest { current_ma: 5 }))
            }
            Request::Arm => Job::Say(Command::Arm),
            Request::Disarm => {
                self.overtake(record, |job| job.yields_to(&Command::Disarm));
                Job::Say(Command::Disarm)
            }
            Request::ClearFaults => Job::Say(Command::ClearFaults),
            Request::ReadBack => Job::Say(Command::TableDigest),
            Request::Store => Job::Say(Command::Store),
            Request::Forget => Job::Say(Command::Forget),
            Request::Digest(window) => Job::Say(Command::DigestStart(window)),
            Request::Upload(table) => Job::BeginUpload(Upload::new(ticket, table)),
            Request::CancelUpload => Job::CancelUpload,
            Request::Drive(drive) => {
                self.drop_tasks(record, |job| matches!(job, Job::Drive(_)));
                Job::Drive(drive)
            }
            // The connection deals with these itself.
            Request::Connect(_) | Request::Disconnect | Request::AutoReconnect(_) | Request::Note(..) => {
                return;
            }
        };
        self.tasks.push_back(Task::new(Some(ticket), job));
    }

    fn stop(&mut self, ticket: Ticket, command: Command, record: &mut Record, now: Duration) {
        self.overtake(record, |job| job.yields_to(&command));
        self.urgent.push(ticket);
        self.say_stop(command, now);
    }

    /// Says a stop; an emergency stop that waits for its answer is said again, not replaced by less.
    fn say_stop(&mut self, command: Command, now: Duration) {
        let unanswered = self.talk.stopping().filter(|stop| **stop == Command::EmergencyStop);
        let command = unanswered.cloned().unwrap_or(command);
        self.talk.say(command, now);
    }

    /// Drops what has not been said of these, and makes sure that none is said again.
    fn overtake(&mut self, record: &mut Record, which: impl Fn(&Job) -> bool) {
        self.drop_tasks(record, &which);
        if let Some(Current::Task(task)) = &mut self.current
            && which(&task.job)
        {
            task.is_overtaken = true;
            self.talk.defuse();
        }
    }

    fn drop_tasks(&mut self, record: &mut Record, which: impl Fn(&Job) -> bool) {
        self.tasks.retain(|task| {
            let drop = which(&task.job);
            if drop {
                if matches!(task.job, Job::Drive(_)) {
                    record.superseded();
                }
                record.finish(task.ticket, Outcome::Superseded);
            }
            !drop
        });
    }

    /// Stops the drive and disarms; [`Verdict::Close`] follows soon.
    pub(super) fn leave(&mut self, record: &mut Record, now: Duration) {
        self.overtake(record, |_| true);
        if self.stage == Stage::Limited || !self.is_greeted() {
            self.farewell = Some(now);
            return;
        }
        self.say_stop(Command::Stop, now);
        self.tasks.push_back(Task::new(None, Job::Say(Command::Disarm)));
        self.farewell = Some(now + FAREWELL);
    }

    /// Ends the talk: whatever has been asked for will not be done.
    pub(super) fn end(mut self, record: &mut Record, outcome: &Outcome) {
        if let Some(Current::Task(task)) = self.current.take() {
            record.finish(task.ticket, outcome.clone());
        }
        let upload = self.upload.take().map(|upload| upload.ticket);
        let tasks = self.tasks.iter().filter_map(|task| task.ticket);
        let open: Vec<Ticket> =
            self.urgent.iter().chain(&self.status_wanted).copied().chain(upload).chain(tasks).collect();
        for ticket in open {
            record.finish(Some(ticket), outcome.clone());
        }
        if let Some(ticket) = self.connect {
            record.finish(Some(ticket), outcome.clone());
        }
    }

    /// Takes bytes from the device.
    pub(super) fn hear(&mut self, bytes: &[u8], record: &mut Record, now: Duration) -> Verdict {
        for answer in self.talk.hear(bytes, now) {
            // A device that is busy erasing says nothing about the link.
            if !matches!(answer.command, Command::Store | Command::Forget) {
                record.round_trip(answer.round_trip);
            }
            let verdict = self.understand(answer, record, now);
            if verdict != Verdict::GoOn {
                return verdict;
            }
        }
        Verdict::GoOn
    }

    /// Repeats what is overdue and says what is due.
    pub(super) fn speak(&mut self, record: &mut Record, now: Duration) -> Verdict {
        if self.talk.tick(now).is_err() {
            return Verdict::Lose(LinkError::Silent);
        }
        if self.farewell.is_some_and(|end| now >= end) {
            return Verdict::Close;
        }
        if now >= self.keep_alive_due {
            self.keep_alive_due = now + KEEP_ALIVE_PERIOD;
            match self.stage {
                Stage::Greeting => {}
                Stage::Limited if !self.talk.is_listening() => {
                    let hello = self.talk.hello();
                    self.talk.say(hello, now);
                }
                Stage::Limited => {}
                Stage::Reading | Stage::Connected => self.talk.keep_alive(now),
            }
        }
        let is_wanted = self.status_stale || !self.status_wanted.is_empty();
        if is_wanted && matches!(self.stage, Stage::Reading | Stage::Connected) && !self.talk.is_listening() {
            self.status_stale = false;
            self.talk.say(Command::Status, now);
        }
        while self.talk.is_free() && self.is_greeted() && self.say_next(record, now) {}
        Verdict::GoOn
    }

    /// When [`Dialogue::speak`] has something to do next.
    pub(super) fn deadline(&self) -> Duration {
        let mut deadline = self.keep_alive_due;
        deadline = deadline.min(self.talk.deadline().unwrap_or(deadline));
        deadline = deadline.min(self.farewell.unwrap_or(deadline));
        if self.talk.is_free() && self.is_greeted() {
            let upload = self.upload.iter().map(|upload| upload.not_before);
            let tasks = self.candidates().map(|(_, task)| task.not_before);
            deadline = deadline.min(upload.chain(tasks).min().unwrap_or(deadline));
        }
        deadline
    }

    /// The tasks of which the next one is chosen: the first, and before it the digests, which let the others pass
    /// until they are ready. None passes one that waits for a stop's answer.
    fn candidates(&self) -> impl Iterator<Item = (usize, &Task)> {
        let first = self.tasks.iter().position(|task| !matches!(task.job, Job::DigestRead));
        let is_held = |task: &Task| self.talk.stopping().is_some_and(|stop| task.job.yields_to(stop));
        let count = first.map_or(self.tasks.len(), |first| first + 1);
        self.tasks.iter().enumerate().take(count).filter(move |(_, task)| !is_held(task))
    }

    /// Says the next thing that is due; returns whether there was one.
    fn say_next(&mut self, record: &mut Record, now: Duration) -> bool {
        let due = self.candidates().find(|(_, task)| now >= task.not_before).map(|(at, _)| at);
        let upload_due = self.upload.as_ref().is_some_and(|upload| now >= upload.not_before);
        if upload_due && (due.is_none() || self.upload_turn) {
            self.upload_turn = false;
            if let Some(upload) = &self.upload {
                let command = upload.command();
                self.talk.say(command, now);
                self.current = Some(Current::Upload);
            }
            return true;
        }
        let Some(task) = due.and_then(|at| self.tasks.remove(at)) else { return false };
        self.upload_turn = true;
        let command = match &task.job {
            Job::Say(command) => command.clone(),
            Job::FirstReadBack => Command::TableDigest,
            Job::DigestRead => Command::DigestRead,
            Job::BeginUpload(upload) => {
                self.begin_upload(upload, record);
                return true;
            }
            Job::CancelUpload => match self.cancel_upload(task.ticket, record) {
                Some(command) => command,
                None => return true,
            },
            Job::Drive(request) => {
                let Some(identity) = record.view.identity.clone() else { return true };
                match request.for_device(&identity, record.view.table.active.as_ref()) {
                    Ok(drive) => Command::Drive(drive),
                    Err(error) => {
                        record.finish(task.ticket, Outcome::Refused(error.to_string()));
                        return true;
                    }
                }
            }
        };
        if !self.talk.is_known(&command) {
            record.finish(task.ticket, Outcome::DeviceTooOld);
            return true;
        }
        self.talk.say(command, now);
        self.current = Some(Current::Task(Box::new(task)));
        true
    }
}
