//! Errors of the client as exceptions.

use crate::error::{Exception, Failure};
use slipline_instrument::hold::HoldEnd;
use slipline_instrument::measure::MeasureError;
use slipline_instrument::native::ClientError;
use slipline_link::protocol::event::Faults;
use slipline_link::protocol::refusal::{self, Field};
use slipline_link::{Refusal, remedy};

impl From<ClientError> for Failure {
    fn from(error: ClientError) -> Self {
        let kind = match &error {
            ClientError::Thread(_)
            | ClientError::NoAnswer(_)
            | ClientError::Refused(Refusal::Link(_))
            | ClientError::Procedure(MeasureError::Lost | MeasureError::Refused(Refusal::Link(_)))
            | ClientError::NotHeld(Some(HoldEnd::LinkLost | HoldEnd::Refused(Refusal::Link(_))))
            | ClientError::Lost(_)
            | ClientError::Gone
            | ClientError::Late => Exception::LinkLost,
            ClientError::HeldUp | ClientError::LeaseOver(_) => Exception::Unattended,
            ClientError::Stopped(standing) => return fault(standing.faults, &error),
            ClientError::NotHeld(Some(HoldEnd::Fault(faults))) => return fault(*faults, &error),
            ClientError::NotComparable(Some(first)) => return fault(Faults::NONE.with(*first), &error),
            ClientError::Refused(Refusal::Device(refused))
            | ClientError::Procedure(MeasureError::Refused(Refusal::Device(refused))) => {
                return by_device(*refused, &error);
            }
            ClientError::Procedure(error) => return Self::of(error),
            ClientError::Refused(_)
            | ClientError::Mismatch(_)
            | ClientError::Unguarded(_)
            | ClientError::NoProfile
            | ClientError::Unexpected
            | ClientError::Superseded
            | ClientError::StoppedByCall
            | ClientError::Interrupted
            | ClientError::NotHeld(_)
            | ClientError::NotOn(_)
            | ClientError::NotComparable(None)
            | ClientError::Dropped
            | ClientError::OptionsDiffer { .. } => Exception::Refused,
        };
        Self::Because(kind, error.to_string())
    }
}

/// A refusal by the device.
#[expect(clippy::wildcard_enum_match_arm, reason = "the others are refusals without numbers of the caller's")]
fn by_device(refused: refusal::Refusal, error: &ClientError) -> Failure {
    match refused {
        refusal::Refusal::Faulted { faults } => fault(faults, error),
        refusal::Refusal::OutOfRange { field: Field::ApplyAt, min, max, got } => Failure::OutOfRange {
            message: format!(
                "at = {got}: it has passed, or is too far ahead; the device takes {min} to {max} now"
            ),
            field: "at".to_owned(),
            value: got as f64,
            range: (min as f64, max as f64),
        },
        _ => Failure::refused(error),
    }
}

/// `slipline.Fault`, which names the cause and the call.
fn fault(faults: Faults, error: &ClientError) -> Failure {
    let remedies: Vec<&str> = faults.iter().map(remedy).collect();
    let remedy = format!("{}; then call clear_faults(), and arm()", remedies.join("; "));
    Failure::Fault {
        message: format!("{error}: {remedy}"),
        faults: faults.iter().map(|fault| format!("{fault:?}")).collect(),
        remedy,
    }
}
