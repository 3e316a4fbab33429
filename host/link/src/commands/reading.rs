//! Parts of a measurement or a capture that have been read so far.

use crate::listen::{CaptureRequest, Captured, ListenRequest, Listened};
use slipline_protocol::listen::{CapturePart, ListenPart};

/// A measurement that is read part by part.
#[derive(Clone, Debug)]
pub(super) struct ListenReading {
    pub(super) request: ListenRequest,
    pub(super) first_slot: u8,
    pub(super) listened: Listened,
}

impl ListenReading {
    /// The part to request next.
    pub(super) const fn part(&self) -> ListenPart {
        ListenPart { input: self.request.input, first_slot: self.first_slot }
    }
}

/// A capture that is read part by part.
#[derive(Clone, Debug)]
pub(super) struct CaptureReading {
    pub(super) request: CaptureRequest,
    pub(super) captured: Captured,
}

impl CaptureReading {
    /// The part to request next.
    pub(super) fn part(&self) -> CapturePart {
        // At most 4096 values.
        CapturePart { first: self.captured.values.len() as u16 }
    }
}
