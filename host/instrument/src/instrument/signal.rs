//! The sensor's signal while its place is searched: repeated short captures of its input while a page shows
//! them.

use super::Instrument;
use crate::hold::HoldEnd;
use crate::measure::Signal;
use slipline_link::{Outcome, Ticket};

/// The input of the sensor.
pub(crate) const SENSOR_INPUT: u8 = 0;

/// The captures of the sensor's input.
#[derive(Default)]
pub(crate) struct Looks {
    awaited: Option<Ticket>,
    /// The signal of the latest capture.
    pub(crate) latest: Option<Signal>,
}

impl Looks {
    /// Whether a capture is under way.
    pub(crate) const fn is_looking(&self) -> bool {
        self.awaited.is_some()
    }

    /// Whether this request is a capture of the sensor's input.
    pub(crate) fn awaits(&self, ticket: Ticket) -> bool {
        self.awaited == Some(ticket)
    }
}

impl Instrument {
    /// Evaluates the last capture and requests the next; returns whether captures continue.
    pub(crate) fn update_signal(&mut self) -> bool {
        let is_wanted = self.attention.is_calibration_open
            && self.calibrating.has_sensor_in_hand()
            && self.snapshot.is_connected()
            && !self.live.is_under_way();
        let inputs = self.snapshot.inputs.filter(|_| is_wanted);
        let look = inputs.and_then(|inputs| Signal::look(&inputs, SENSOR_INPUT, self.sample_rate_hz()));
        let Some(look) = look else {
            self.live.looks = Looks::default();
            return false;
        };
        self.end_hold(HoldEnd::Measured);
        self.put_rig_up();
        let outcome = self.live.looks.awaited.and_then(|ticket| self.snapshot.outcome(ticket));
        if let Some(outcome) = outcome {
            // A refused capture gives no signal; the next one may.
            self.live.looks.latest =
                if let Outcome::Listened(listened) = outcome { Some(Signal::of(listened)) } else { None };
            self.live.looks.awaited = None;
        }
        if self.live.looks.awaited.is_none() {
            self.live.looks.awaited = Some(self.link.send(look));
        }
        true
    }
}
