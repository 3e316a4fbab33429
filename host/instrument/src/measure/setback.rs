//! Outcomes after which a procedure must repeat a step: too late, too loud, lost samples; and the limit of
//! attempts.

use super::error::MeasureError;
use slipline_link::protocol::refusal::{Field, Refusal as DeviceRefusal};
use slipline_link::{Outcome, Refusal};

/// Attempts at the same step.
pub(super) const TRIES: u32 = 4;
/// Margin to the travel that a device allows: its numbers are rounded.
const TRAVEL: f64 = 0.99;

/// The attempts at one step.
#[derive(Debug, Default)]
pub(super) struct Tries(u32);

impl Tries {
    /// Counts an attempt that failed with this error; fails if it was the last one.
    pub(super) fn again(&mut self, error: MeasureError) -> Result<(), MeasureError> {
        self.0 += 1;
        if self.0 >= TRIES { Err(error) } else { Ok(()) }
    }

    /// Counts an attempt in which the inputs have lost samples; any other outcome ends the procedure.
    pub(super) fn lost(&mut self, outcome: &Outcome) -> Result<(), MeasureError> {
        if matches!(outcome, Outcome::Refused(Refusal::InputLost { .. })) {
            self.again(MeasureError::Overrun { tries: self.0 + 1 })
        } else {
            Err(ended_by(outcome))
        }
    }

    /// The factor on the level for the next attempt, if the actuator's travel was exceeded; any other outcome
    /// ends the procedure.
    pub(super) fn quieter(&mut self, outcome: &Outcome) -> Result<f64, MeasureError> {
        let share = quieter(outcome).filter(|_| self.0 < TRIES);
        self.0 += 1;
        share.ok_or_else(|| ended_by(outcome))
    }
}

/// The error for an outcome after which a procedure cannot continue.
pub(crate) fn ended_by(outcome: &Outcome) -> MeasureError {
    match outcome {
        Outcome::Refused(refusal) => MeasureError::Refused(refusal.clone()),
        Outcome::DeviceTooOld => MeasureError::TooOld,
        Outcome::NotConnected => MeasureError::Lost,
        Outcome::Superseded => MeasureError::Stopped,
        Outcome::Done { .. } | Outcome::Listened(_) | Outcome::Captured(_) | Outcome::Digest(_) => {
            MeasureError::Refused(Refusal::UnexpectedReply)
        }
        _ => MeasureError::Refused(Refusal::UnexpectedReply),
    }
}

/// Whether a request arrived after the sample index that it states.
pub(crate) const fn is_late(outcome: &Outcome) -> bool {
    matches!(
        outcome,
        Outcome::Refused(Refusal::Device(DeviceRefusal::OutOfRange { field: Field::ApplyAt, .. }))
    )
}

/// The factor on the level that the actuator's travel requires; `None` if the travel was not the reason for a
/// refusal.
pub(super) fn quieter(outcome: &Outcome) -> Option<f64> {
    let Outcome::Refused(Refusal::Device(DeviceRefusal::Travel { allowed_per_mille, .. })) = outcome else {
        return None;
    };
    (*allowed_per_mille > 0).then(|| TRAVEL * f64::from(*allowed_per_mille) / 1000.0)
}
