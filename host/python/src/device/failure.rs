//! Errors of the client as exceptions.

use crate::error::{Exception, Failure};
use slipline_instrument::native::ClientError;
use slipline_link::Refusal;

impl From<ClientError> for Failure {
    fn from(error: ClientError) -> Self {
        let kind = match &error {
            ClientError::Thread(_)
            | ClientError::NoAnswer(_)
            | ClientError::Refused(Refusal::Link(_))
            | ClientError::Lost(_)
            | ClientError::Gone
            | ClientError::Late => Exception::LinkLost,
            ClientError::HeldUp | ClientError::LeaseOver(_) => Exception::Unattended,
            ClientError::Procedure(error) => return Self::of(error),
            ClientError::Refused(_)
            | ClientError::Mismatch(_)
            | ClientError::Unguarded(_)
            | ClientError::NoProfile
            | ClientError::Unexpected
            | ClientError::Interrupted
            | ClientError::NotHeld(_)
            | ClientError::NotOn(_)
            | ClientError::NotComparable(_)
            | ClientError::Stopped(_)
            | ClientError::Dropped => Exception::Refused,
        };
        Self::Because(kind, error.to_string())
    }
}
