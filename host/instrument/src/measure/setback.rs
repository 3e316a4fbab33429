//! Outcomes with which a procedure does not go on as planned: too late, too loud, lost samples; and how often it tries again.

use super::error::MeasureError;
use slipline_link::protocol::refusal::{Field, Refusal as DeviceRefusal};
use slipline_link::{Outcome, Refusal};

/// How often the same thing is tried.
pub(super) const TRIES: u32 = 4;
/// What is left of the travel that a device allows: its numbers are rounded.
const TRAVEL: f64 = 0.99;

/// The tries of one thing.
#[derive(Debug, Default)]
pub(super) struct Tries(u32);

impl Tries {
    /// It is tried again because of this error, unless that was the last try.
    pub(super) fn again(&mut self, error: MeasureError) -> Result<(), MeasureError> {
        self.0 += 1;
        if self.0 >= TRIES { Err(error) } else { Ok(()) }
    }

    /// The same because of samples that the inputs have lost; anything else ends the procedure.
    pub(super) fn lost(&mut self, outcome: &Outcome) -> Result<(), MeasureError> {
        if matches!(outcome, Outcome::Refused(Refusal::InputLost { .. })) {
            self.again(MeasureError::Overrun { tries: self.0 + 1 })
        } else {
            Err(ended_by(outcome))
        }
    }

    /// How much quieter it is tried again for the actuator's travel; anything else ends the procedure.
    pub(super) fn quieter(&mut self, outcome: &Outcome) -> Result<f64, MeasureError> {
        let share = quieter(outcome).filter(|_| self.0 < TRIES);
        self.0 += 1;
        share.ok_or_else(|| ended_by(outcome))
    }
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

/// How much quieter the tones must be for the actuator's travel; nothing if that did not refuse them.
pub(super) fn quieter(outcome: &Outcome) -> Option<f64> {
    let Outcome::Refused(Refusal::Device(DeviceRefusal::Travel { allowed_per_mille, .. })) = outcome else {
        return None;
    };
    (*allowed_per_mille > 0).then(|| TRAVEL * f64::from(*allowed_per_mille) / 1000.0)
}
