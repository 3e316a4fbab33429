//! What all procedures with a device share: they ask for requests, take their outcomes, and look at what the link knows.

use super::error::MeasureError;
use slipline_link::protocol::refusal::{Field, Refusal as DeviceRefusal};
use slipline_link::{LinkState, Outcome, Refusal, Request, Snapshot};

/// What to do next.
#[derive(Debug, Clone)]
pub enum Step {
    /// Send this request, and hand its outcome over by [`Procedure::take`].
    Ask(Request),
    /// The outcome of the last request is awaited.
    Wait,
    /// It is over: call [`Procedure::finish`].
    Ended,
}

/// A procedure with a device, without a clock and without a port. Whatever goes wrong, what sounds is stopped before it ends.
///
/// ```text
/// loop: watch(snapshot) -> step() -> Ask: send it | Wait: take(outcome), when it is there | Ended: finish()
/// ```
pub trait Procedure {
    /// What it ends with.
    type Found;

    /// What to do next.
    fn step(&mut self) -> Step;

    /// Takes the outcome of the last request.
    fn take(&mut self, outcome: &Outcome);

    /// Looks at what the link knows: a fault or a lost device ends the procedure. Call it until the end: a fault explains why
    /// the tones were stopped.
    fn watch(&mut self, snapshot: &Snapshot);

    /// Gives it up: the next step is a stop.
    fn cancel(&mut self);

    /// The share that is done (0 to 1), when the device is at sample `now`.
    fn progress(&self, now: u64) -> f64;

    /// What was found.
    ///
    /// # Errors
    /// [`MeasureError`]: why nothing was.
    fn finish(self) -> Result<Self::Found, MeasureError>;
}

/// Lets the latched faults explain why tones were stopped, and tells why the procedure cannot go on.
pub(super) fn trouble(error: &mut Option<MeasureError>, snapshot: &Snapshot) -> Option<MeasureError> {
    let faults = snapshot.status.map(|status| status.faults).filter(|faults| !faults.is_empty());
    let fault = faults.map(|faults| MeasureError::Fault(faults.to_string()));
    if let (Some(MeasureError::Stopped), Some(fault)) = (&error, &fault) {
        *error = Some(fault.clone());
    }
    if snapshot.link == LinkState::Connected { fault } else { Some(MeasureError::Lost) }
}

/// Why an outcome that nobody can go on with ends a procedure.
pub(super) fn ended_by(outcome: &Outcome) -> MeasureError {
    match outcome {
        Outcome::Refused(refusal) => MeasureError::Refused(refusal.clone()),
        Outcome::DeviceTooOld => MeasureError::TooOld,
        Outcome::NotConnected => MeasureError::Lost,
        Outcome::Superseded => MeasureError::Stopped,
        Outcome::Done { .. } | Outcome::Listened(_) | Outcome::Captured(_) | Outcome::Digest(_) => {
            MeasureError::Refused(Refusal::UnexpectedReply)
        }
    }
}

/// Whether a request came after the index that it names.
pub(crate) const fn is_late(outcome: &Outcome) -> bool {
    matches!(
        outcome,
        Outcome::Refused(Refusal::Device(DeviceRefusal::OutOfRange { field: Field::ApplyAt, .. }))
    )
}

/// What is left of the travel that a device allows: its numbers are rounded.
const TRAVEL: f64 = 0.99;

/// How much quieter the tones must be for the actuator's travel; nothing if that did not refuse them.
pub(super) fn quieter(outcome: &Outcome) -> Option<f64> {
    let Outcome::Refused(Refusal::Device(DeviceRefusal::Travel { allowed_per_mille, .. })) = outcome else {
        return None;
    };
    (*allowed_per_mille > 0).then(|| TRAVEL * f64::from(*allowed_per_mille) / 1000.0)
}
