//! The common driver of all procedures with a device: it sends their requests, handles the outcomes, watches
//! the link for faults, and leaves the device silent and with its own table.

use super::dialogue::Dialogue;
use super::error::MeasureError;
use super::prompt::Prompt;
use super::setback::ended_by;
use slipline_link::{LinkState, Outcome, Request, Snapshot, Ticket};
use slipline_plate::calibrate::Measurement;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, Waker};
use std::time::Duration;

/// The evaluation of a device's outcomes. It may take seconds; the device is silent by then.
pub(crate) type Evaluation<T> = Box<dyn FnOnce() -> Result<T, MeasureError>>;

/// A procedure that is carried out.
type Course<T> = Pin<Box<dyn Future<Output = Result<Evaluation<T>, MeasureError>>>>;

/// The evaluation of what is known already.
pub(crate) fn evaluated<T: 'static>(found: T) -> Evaluation<T> {
    Box::new(|| Ok(found))
}

/// A sequence of requests to a device, without a clock and without a port.
pub trait Procedure: 'static {
    /// Its result.
    type Found: 'static;
    /// Whether faults of the device do not end it, because it looks at them itself. The link's snapshots are kept for it.
    const BEARS_FAULTS: bool = false;

    /// Sends its requests, the last of which is a stop, and returns how their outcomes are evaluated. After an error [`Run`] sends
    /// that stop.
    ///
    /// # Errors
    /// [`MeasureError`]: why it cannot continue; of the evaluation, why the outcomes give no result.
    fn carry_out(
        self,
        dialogue: Dialogue,
    ) -> impl Future<Output = Result<Evaluation<Self::Found>, MeasureError>>;
}

/// The next step.
#[derive(Debug, Clone)]
pub enum NextStep {
    /// Send this request, and pass its outcome to [`Run::take`].
    Ask(Request),
    /// The outcome of the last request is awaited.
    Wait,
    /// The procedure has ended: call [`Run::finish`].
    Ended,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Running,
    /// After an error: the drive is stopped.
    Stopping,
    /// A device that the procedure has armed by itself is disarmed.
    Disarming,
    /// After an error in a procedure that closes the port or makes the device restart: the link looks for a lost device as before.
    Settling,
    /// Then the port is opened again, so many times at most.
    Reopening(u32),
    /// The device is awaited before the port is opened again.
    Awaiting(u32),
    /// The device gets its own table back, if it may hold another.
    Restoring,
    Ended,
}

/// How often the port is opened again after an error, and for how long a device that restarts is awaited each time: the watchdog
/// takes 0.6 s at most, USB a second.
const OPENINGS: u32 = 3;
const BACK_WITHIN: Duration = Duration::from_secs(1);

/// A procedure under way. After any error the drive is stopped before the procedure ends, and the port is open again if the
/// procedure has closed it, or has made the device restart.
///
/// ```text
/// loop: watch(snapshot) -> step() -> Ask: send it | Wait: take(outcome), when it arrives | Ended: finish()
/// ```
pub struct Run<P: Procedure> {
    dialogue: Dialogue,
    course: Course<P::Found>,
    stage: Stage,
    is_asked: bool,
    awaited: Option<Ticket>,
    /// The request whose outcome is awaited while others are sent.
    begun: Option<Ticket>,
    heard: Option<Evaluation<P::Found>>,
    error: Option<MeasureError>,
    /// Whether the port is no longer the procedure's: it is not opened again.
    is_port_left: bool,
}

impl<P: Procedure> Run<P> {
    /// Starts the procedure at the next step.
    pub fn of(procedure: P) -> Self {
        let dialogue = Dialogue::default();
        dialogue.state().bears_faults = P::BEARS_FAULTS;
        Self {
            course: Box::pin(procedure.carry_out(dialogue.clone())),
            dialogue,
            stage: Stage::Running,
            is_asked: false,
            awaited: None,
            begun: None,
            heard: None,
            error: None,
            is_port_left: false,
        }
    }

    /// Passes the device's outcomes on and sends the next request; returns whether the procedure continues.
    pub fn turn(&mut self, snapshot: &Snapshot, mut send: impl FnMut(Request) -> Ticket) -> bool {
        self.watch(snapshot);
        loop {
            if let Some(outcome) = self.awaited.and_then(|ticket| snapshot.outcome(ticket)) {
                self.awaited = None;
                self.take(outcome);
            }
            if let Some(outcome) = self.begun.and_then(|ticket| snapshot.outcome(ticket)) {
                self.begun = None;
                self.dialogue.state().ended = Some(outcome.clone());
            }
            let step = self.step();
            let begun = self.dialogue.state().begun.take();
            if let Some(request) = begun {
                self.begun = Some(send(request));
            }
            match step {
                NextStep::Ask(request) => self.awaited = Some(send(request)),
                NextStep::Wait => return true,
                NextStep::Ended => return false,
            }
        }
    }

    /// The request of the last turn whose outcome is awaited.
    #[must_use]
    pub const fn awaited(&self) -> Option<Ticket> {
        self.awaited
    }

    /// Whether the outcome of this request is awaited.
    #[must_use]
    pub fn awaits(&self, ticket: Ticket) -> bool {
        [self.awaited, self.begun].contains(&Some(ticket))
    }

    /// The next step.
    pub fn step(&mut self) -> NextStep {
        if self.is_asked {
            return NextStep::Wait;
        }
        if self.stage == Stage::Running {
            match self.course.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
                Poll::Pending => {}
                Poll::Ready(Ok(heard)) => {
                    self.heard = Some(heard);
                    self.stage = Stage::Disarming;
                }
                Poll::Ready(Err(error)) => {
                    self.fail(error);
                    if self.dialogue.state().is_silent {
                        self.stage = Stage::Disarming;
                    }
                }
            }
        }
        if self.stage == Stage::Disarming && !std::mem::take(&mut self.dialogue.state().is_armed) {
            self.stage = self.after_disarming();
        }
        let request = match self.stage {
            Stage::Running => self.dialogue.state().asked.take(),
            Stage::Stopping => Some(Request::Stop),
            Stage::Disarming => Some(Request::Disarm),
            Stage::Settling => Some(Request::AutoReconnect(self.dialogue.seeks().unwrap_or_default())),
            Stage::Reopening(_) => Some(self.dialogue.port().map_or(Request::Refresh, Request::Connect)),
            Stage::Awaiting(_) => Some(Request::Await(BACK_WITHIN)),
            Stage::Restoring => self.dialogue.state().own_table.take().map(Request::Upload),
            Stage::Ended => None,
        };
        let Some(request) = request else {
            self.stage = Stage::Ended;
            return NextStep::Ended;
        };
        self.is_asked = true;
        NextStep::Ask(request)
    }

    /// Handles the outcome of the last request. The outcome of a request before a cancellation or a fault is
    /// ignored.
    pub fn take(&mut self, outcome: &Outcome) {
        if !std::mem::take(&mut self.is_asked) {
            return;
        }
        let is_done = matches!(outcome, Outcome::Done { .. });
        match self.stage {
            Stage::Running => self.dialogue.state().outcome = Some(outcome.clone()),
            Stage::Stopping => self.stage = Stage::Disarming,
            Stage::Disarming => self.stage = self.after_disarming(),
            Stage::Settling if self.is_port_left => self.stage = Stage::Restoring,
            Stage::Settling => self.stage = Stage::Reopening(OPENINGS),
            Stage::Reopening(_) | Stage::Awaiting(_) if is_done => self.stage = Stage::Restoring,
            Stage::Reopening(openings) => self.stage = Stage::Awaiting(openings - 1),
            Stage::Awaiting(0) => self.stage = Stage::Restoring,
            Stage::Awaiting(openings) => self.stage = Stage::Reopening(openings),
            Stage::Restoring => {
                if !is_done {
                    self.error.get_or_insert(ended_by(outcome));
                }
                self.stage = Stage::Ended;
            }
            Stage::Ended => {}
        }
    }

    /// Evaluates the link's snapshot: a fault or a lost device ends the procedure. Must be called until the
    /// end, since a fault explains why the tones were stopped.
    pub fn watch(&mut self, snapshot: &Snapshot) {
        self.dialogue.follow(snapshot);
        let bears_faults = self.dialogue.state().bears_faults;
        let faults = snapshot.drive.status.map(|status| status.faults);
        let faults = faults.filter(|faults| !faults.is_empty() && !bears_faults);
        let fault = faults.map(|faults| MeasureError::Fault(faults.to_string()));
        if let (Some(MeasureError::Stopped), Some(fault)) = (&self.error, &fault) {
            self.error = Some(fault.clone());
        }
        let is_there = snapshot.link.state == LinkState::Connected || self.dialogue.seeks().is_some();
        let trouble = if is_there { fault } else { Some(MeasureError::Lost) };
        if let Some(trouble) = trouble.filter(|_| self.stage == Stage::Running) {
            self.fail(trouble);
        }
    }

    /// Cancels the procedure: the next step is a stop.
    pub fn cancel(&mut self) {
        if self.stage == Stage::Running {
            self.fail(MeasureError::Cancelled);
        }
    }

    /// The user ends the connection or opens another: the procedure ends, and leaves the port as the user wants it.
    pub fn leave_port(&mut self) {
        self.cancel();
        self.is_port_left = true;
        if matches!(self.stage, Stage::Reopening(_) | Stage::Awaiting(_)) {
            self.stage = Stage::Restoring;
        }
        self.dialogue.give_up();
    }

    /// What follows the disarming, or the end of a procedure that has armed nothing.
    fn after_disarming(&self) -> Stage {
        let is_settled = self.error.is_none() || self.dialogue.seeks().is_none();
        if is_settled { Stage::Restoring } else { Stage::Settling }
    }

    fn fail(&mut self, error: MeasureError) {
        self.error.get_or_insert(error);
        self.stage = Stage::Stopping;
        self.is_asked = false;
    }

    /// The share that is done (0 to 1), when the device is at sample `now`.
    #[must_use]
    pub fn progress(&self, now: u64) -> f64 {
        let is_over = !matches!(self.stage, Stage::Running | Stage::Stopping);
        if is_over { 1.0 } else { self.dialogue.progress(now) }
    }

    /// What a person at the board is asked to do.
    #[must_use]
    pub fn prompt(&self) -> Option<Prompt> {
        self.dialogue.state().prompt
    }

    /// The points that a measurement has so far; `None` before its first answers, and of other procedures.
    #[must_use]
    pub fn so_far(&self) -> Option<Arc<Measurement>> {
        self.dialogue.state().so_far.clone()
    }

    /// Whether the drive is being checked.
    #[must_use]
    pub fn is_checking(&self) -> bool {
        self.dialogue.state().is_checking
    }

    /// Its result.
    ///
    /// # Errors
    /// [`MeasureError`]: why there is none.
    pub fn finish(self) -> Result<P::Found, MeasureError> {
        match self.error {
            Some(error) => Err(error),
            None => self.heard.map_or(Err(MeasureError::Cancelled), |evaluate| evaluate()),
        }
    }
}
