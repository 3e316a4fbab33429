//! The sensor's signal while its place is searched: repeated short captures of its input while a page shows
//! them.

use crate::instrument::drive::Drive;
use crate::measure::Signal;
use slipline_link::{Outcome, Request, Ticket};

/// The input of the sensor.
pub(super) const SENSOR_INPUT: u8 = 0;

/// The captures of the sensor's input.
#[derive(Default)]
pub(super) struct Looks {
    awaited: Option<Ticket>,
    /// The signal of the latest capture.
    pub(super) latest: Option<Signal>,
}

impl Looks {
    /// Whether a capture is under way.
    pub(super) const fn is_looking(&self) -> bool {
        self.awaited.is_some()
    }

    /// Whether this request is a capture of the sensor's input.
    pub(super) fn awaits(&self, ticket: Ticket) -> bool {
        self.awaited == Some(ticket)
    }

    /// The request for the next capture, if the device has an input for a sensor.
    pub(super) fn next(drive: &Drive) -> Option<Request> {
        Signal::look(&drive.snapshot().device.inputs?, SENSOR_INPUT, drive.sample_rate_hz())
    }

    /// Evaluates the last capture, and sends the request for the next.
    pub(super) fn update(&mut self, next: Request, drive: &Drive) {
        let outcome = self.awaited.and_then(|ticket| drive.snapshot().outcome(ticket));
        if let Some(outcome) = outcome {
            // A refused capture gives no signal; the next one may.
            self.latest =
                if let Outcome::Listened(listened) = outcome { Some(Signal::of(listened)) } else { None };
            self.awaited = None;
        }
        if self.awaited.is_none() {
            self.awaited = Some(drive.send(next));
        }
    }
}
