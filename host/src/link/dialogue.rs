//! What to say to a connected device next, and what its answers mean.
//!
//! Tasks are said in order, one numbered command at a time. An upload runs beside them, a step whenever the lane is
//! free. A stop goes out at once, throws away the drives that have not been said, and makes sure that one that has
//! been said is never repeated.

use super::conversation::{Answer, Conversation, KEEP_ALIVE_PERIOD, Reply};
use super::record::Record;
use super::upload::{BUSY_PAUSE, BUSY_TRIES, Step, Upload};
use super::{Change, DriveRequest, LinkState, Outcome, Request, Severity, Ticket, Trouble};
use slipline_protocol::event::Digest;
use slipline_protocol::refusal::Busy;
use slipline_protocol::version::{Compatibility, Version};
use slipline_protocol::{Command, Event, Refusal, event};
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

/// A drive that came before the device took up the last one is said again after so long: three blocks of 128 codes
/// at 400 kS/s.
const DRIVE_PAUSE: Duration = Duration::from_millis(1);
/// A digest is asked for this often until its window is over.
const DIGEST_PAUSE: Duration = Duration::from_millis(20);
/// A numbered command is given a new number so often before the device counts as lost.
const RENUMBERINGS: u32 = 3;
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

#[derive(Clone, Debug)]
struct Task {
    /// None for what the link does by itself.
    ticket: Option<Ticket>,
    job: Job,
    tries: u32,
    not_before: Duration,
}

impl Task {
    const fn new(ticket: Option<Ticket>, job: Job) -> Self {
        Self { ticket, job, tries: 0, not_before: Duration::ZERO }
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
    Lose(Trouble),
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
            Request::Arm => Job::Say(Command::Arm),
            Request::Disarm => Job::Say(Command::Disarm),
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
            Request::Connect(_) | Request::Disconnect | Request::AutoReconnect(_) => return,
        };
        self.tasks.push_back(Task::new(Some(ticket), job));
    }

    fn stop(&mut self, ticket: Ticket, command: Command, record: &mut Record, now: Duration) {
        let is_emergency = command == Command::EmergencyStop;
        self.drop_tasks(record, |job| match job {
            Job::Drive(_) => true,
            Job::Say(Command::Arm | Command::ClearFaults) => is_emergency,
            _ => false,
        });
        if let Some(Command::Drive(_) | Command::Arm | Command::ClearFaults) = self.talk.pending() {
            self.talk.defuse();
        }
        self.urgent.push(ticket);
        self.talk.say(command, now);
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
        self.drop_tasks(record, |_| true);
        if self.stage == Stage::Limited || !self.is_greeted() {
            self.farewell = Some(now);
            return;
        }
        self.talk.defuse();
        self.talk.say(Command::Stop, now);
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
            return Verdict::Lose(Trouble::Silent);
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
        if self.talk.is_free() {
            let upload = self.upload.iter().map(|upload| upload.not_before);
            let tasks = self.tasks.iter().map(|task| task.not_before);
            deadline = deadline.min(upload.chain(tasks).min().unwrap_or(deadline));
        }
        deadline
    }

    /// Says the next thing that is due; returns whether there was one.
    fn say_next(&mut self, record: &mut Record, now: Duration) -> bool {
        // A digest that is not ready yet lets the others pass.
        let due =
            self.tasks.iter().position(|task| !matches!(task.job, Job::DigestRead) || now >= task.not_before);
        let due = due.filter(|&at| self.tasks.get(at).is_some_and(|task| now >= task.not_before));
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
            Job::CancelUpload => match self.upload.take() {
                Some(upload) => {
                    record.view.upload = None;
                    record.finish(Some(upload.ticket), Outcome::Superseded);
                    Command::TableAbort
                }
                None => {
                    record.finish(task.ticket, Outcome::Done { at: 0 });
                    return true;
                }
            },
            Job::BeginUpload(upload) => {
                if let Some(older) = self.upload.replace(upload.clone()) {
                    record.finish(Some(older.ticket), Outcome::Superseded);
                }
                record.view.upload = Some(upload.progress());
                record.touch();
                return true;
            }
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
        self.talk.say(command, now);
        self.current = Some(Current::Task(Box::new(task)));
        true
    }

    fn understand(&mut self, answer: Answer, record: &mut Record, now: Duration) -> Verdict {
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
            return Verdict::Lose(Trouble::SessionEnded);
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
        identity: Option<Box<event::Identity>>,
        record: &mut Record,
        now: Duration,
    ) {
        let compatibility = version.compare_device();
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

    fn take_status(&mut self, status: event::Status, record: &mut Record) {
        let is_first = record.view.status.is_none();
        record.status(status);
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
        if let Event::Refused(Refusal::BadSequence { expected }) = event {
            self.renumberings += 1;
            if self.renumberings > RENUMBERINGS {
                return Verdict::Lose(Trouble::SessionEnded);
            }
            self.talk.renumber(command, expected, now);
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

    fn uploaded(&mut self, event: Event, record: &mut Record, now: Duration) {
        // Cancelled or replaced while a step was under way.
        let Some(upload) = &mut self.upload else { return };
        match (upload.step, event) {
            (_, Event::Refused(Refusal::Busy(_))) if upload.tries < BUSY_TRIES => {
                upload.tries += 1;
                upload.not_before = now + BUSY_PAUSE;
            }
            (Step::Verify, Event::Table(report)) => {
                let is_verified = report.active == Some(upload.table.header());
                record.view.table = report;
                record.view.upload_verified = Some(is_verified);
                record.view.upload = None;
                if let Some(upload) = self.upload.take() {
                    if is_verified {
                        record.view.confirmed_table = Some(upload.table.clone());
                        record.log(
                            Severity::Info,
                            format!("Table {:08x} is on the device.", upload.table.crc()),
                        );
                        let at = record.view.status.map_or(0, |status| status.now);
                        record.finish(Some(upload.ticket), Outcome::Done { at });
                    } else {
                        let sentence = "the table on the device is not the one that was sent";
                        record.finish(Some(upload.ticket), Outcome::Refused(sentence.to_owned()));
                    }
                }
                self.status_stale = true;
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
            (_, event) => {
                let ticket = upload.ticket;
                self.upload = None;
                record.view.upload = None;
                record.view.upload_verified = Some(false);
                record.finish(Some(ticket), Outcome::Refused(sentence(&event)));
            }
        }
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
            Event::Refused(Refusal::Busy(Busy::CommitPending | Busy::DriveActive))
                if matches!(task.job, Job::Drive(_))
                    && task.tries < BUSY_TRIES
                    && self.farewell.is_none() =>
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
                record.view.table = report;
                if record.view.confirmed_table.as_ref().map(|table| table.header()) != report.active {
                    record.view.confirmed_table = None;
                }
                record.touch();
                let now_at = record.view.status.map_or(0, |status| status.now);
                match task.job {
                    Job::FirstReadBack => {
                        self.stage = Stage::Connected;
                        self.connected(now_at, record);
                        self.arm_simulated(record);
                    }
                    // A defused drive or arm that never got through.
                    _ if command != Command::TableDigest => {
                        record.finish(task.ticket, Outcome::Superseded);
                    }
                    _ => record.finish(task.ticket, Outcome::Done { at: now_at }),
                }
                return Verdict::GoOn;
            }
            Event::Digest(digest) => {
                self.digested(task, digest, record, now);
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
            Command::Drive(drive) => record.acknowledge(at, Change::Drive(Arc::new(drive))),
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
        let is_dragging = record.view.status.is_some_and(|status| status.state == event::State::Driving);
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

fn sentence(event: &Event) -> String {
    match event {
        Event::Refused(refusal) => refusal.to_string(),
        _ => "the device gave an answer that does not fit the question".to_owned(),
    }
}
