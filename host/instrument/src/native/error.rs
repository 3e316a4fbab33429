//! Why a client could not do what it was asked for.

use crate::measure::MeasureError;
use slipline_link::protocol::version::Compatibility;
use slipline_link::{LinkError, Port, Refusal, SIGN_PATIENCE};

/// Why a client could not do what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// This computer has no thread for the link.
    #[error(transparent)]
    Thread(#[from] std::io::Error),
    /// There is no device, or none that answers the handshake.
    #[error("{0} does not answer")]
    NoAnswer(Port),
    /// The device, or the link in its place, refuses.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The link has stopped and disarmed the device, because this program gave no sign of life.
    #[error(
        "this program was held up for {} s, so the device was stopped and disarmed: run it again",
        SIGN_PATIENCE.as_secs_f64()
    )]
    HeldUp,
    /// Firmware and program do not fit each other.
    #[error("{}", .0.sentence())]
    Mismatch(Compatibility),
    /// The board must not be armed before its user knows this.
    #[error("{0}")]
    Unguarded(&'static str),
    /// The connection was lost, for this reason.
    #[error(transparent)]
    Lost(LinkError),
    /// The device is not there any more.
    #[error("the device went away")]
    Gone,
    /// There was no answer in time.
    #[error("the device did not answer in time")]
    Late,
    /// The answer belongs to something else.
    #[error("the device did something else instead")]
    Unexpected,
    /// The digest of a window of codes did not come.
    #[error("the device gave no digest")]
    NoDigest,
    /// A procedure found nothing.
    #[error(transparent)]
    Procedure(#[from] MeasureError),
}
