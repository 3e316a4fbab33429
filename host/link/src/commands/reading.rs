//! Parts of a measurement or a capture that have been read so far.

use crate::listen::{CaptureRequest, Captured, ListenRequest, Listened};

/// A measurement that is read part by part.
#[derive(Clone, Debug)]
pub(super) struct ListenReading {
    pub(super) request: ListenRequest,
    pub(super) first_slot: u8,
    pub(super) listened: Listened,
}

/// A capture that is read part by part.
#[derive(Clone, Debug)]
pub(super) struct CaptureReading {
    pub(super) request: CaptureRequest,
    pub(super) captured: Captured,
}
