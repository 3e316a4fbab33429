//! The user's switch of the level hold.
//!
//! ```text
//! on --> waits --the drive rests--> listens --heard--> orders --taken--> the device holds
//!          ^                                                                     |
//!          +---- something else sounds: a drag, another level, a chord ----------+
//! any --> off: the switch, a stop, another plate, a fault, a lost device, tones that cannot be held, all tones lost
//! ```
//! It has no clock and no port: the command line and the window run the same steps.
//!
//! The device itself ends a hold at the next drive, and returns a lost tone to its drive level, so nothing
//! here is time-critical for safety. The held amplitudes were measured on an untouched plate. After a stop it
//! is unknown whether the plate is untouched, so the hold stays off until it is switched on again.

use super::course::Course;
use super::end::HoldEnd;
use super::standing::Standing;
use slipline_link::protocol::refusal;
use slipline_link::{HoldRequest, Outcome, Refusal, Request, Snapshot, Ticket};
use slipline_plate::Plate;
use std::sync::Arc;

/// Number of tickets kept: the outcome of a superseded request may arrive some turns later.
const TICKETS: usize = 4;

/// The level hold of one user. The default is off.
#[derive(Debug, Default)]
pub struct Holding {
    course: Option<Course>,
    release: Release,
    end: Option<HoldEnd>,
    tickets: [Option<Ticket>; TICKETS],
}

/// Release of a hold that the user has switched off.
#[derive(Clone, Copy, Debug, Default)]
enum Release {
    #[default]
    None,
    Wanted,
    Sent(Option<Ticket>),
}

impl Holding {
    /// Switches the hold on for the present and later drives on this plate, with this largest rise
    /// ([`MAX_RISE`](super::MAX_RISE)). `since` is the sample index from which the sensor's signal is valid,
    /// if known; otherwise it is that of the device's next status.
    pub fn switch_on(&mut self, plate: &Arc<Plate>, max_rise_db: f64, since: Option<u64>) {
        self.end = None;
        self.course = Some(Course::new(plate, max_rise_db, since));
    }

    /// Switches it off at the user's request: the levels return to those of the drive.
    pub fn switch_off(&mut self) {
        self.put_off();
        self.end = None;
    }

    /// Ends it because of another action of the user.
    pub fn end(&mut self, end: HoldEnd) {
        if self.is_on() {
            self.put_off();
            self.end = Some(end);
        }
    }

    fn put_off(&mut self) {
        if self.course.take().is_some_and(|course| course.may_hold()) {
            self.release = Release::Wanted;
        }
    }

    /// Whether it is switched on.
    #[must_use]
    pub const fn is_on(&self) -> bool {
        self.course.is_some()
    }

    /// Why it has ended by itself, until it is switched on again.
    #[must_use]
    pub const fn ended(&self) -> Option<&HoldEnd> {
        self.end.as_ref()
    }

    /// Whether one of its last requests has this ticket.
    #[must_use]
    pub fn awaits(&self, ticket: Ticket) -> bool {
        self.tickets.contains(&Some(ticket))
    }

    /// Its state for display.
    #[must_use]
    pub fn standing<'a>(&'a self, snapshot: &'a Snapshot) -> Standing<'a> {
        match &self.course {
            Some(course) => course.standing(snapshot),
            None => Standing::Off(self.end.as_ref()),
        }
    }

    /// The frequency of the held tone in a slot, in Hz.
    #[must_use]
    pub fn frequency_hz(&self, slot: u8) -> Option<f64> {
        self.course.as_ref()?.frequency_hz(slot)
    }

    /// Evaluates the link's snapshot and the plate on the screen. Returns a request to send; its ticket must
    /// be given to [`sent`](Self::sent) before the next turn. `rests` says that nothing is being changed: no
    /// line is dragged and no slider is moved.
    pub fn turn(&mut self, snapshot: &Snapshot, plate: &Arc<Plate>, rests: bool) -> Option<Request> {
        if let Some(request) = self.release(snapshot) {
            return Some(request);
        }
        let course = self.course.as_mut()?;
        let turned = course.check(snapshot, plate).and_then(|()| course.turn(snapshot, rests));
        turned.unwrap_or_else(|end| {
            self.end(end);
            self.release(snapshot)
        })
    }

    /// Stores the ticket of the request that was returned last.
    pub fn sent(&mut self, ticket: Ticket) {
        self.tickets.rotate_right(1);
        self.tickets[0] = Some(ticket);
        if let Release::Sent(sent @ None) = &mut self.release {
            *sent = Some(ticket);
        } else if let Some(course) = &mut self.course {
            course.sent(ticket);
        }
    }

    /// Requests the end of a released hold until the device has confirmed it.
    fn release(&mut self, snapshot: &Snapshot) -> Option<Request> {
        let is_wanted = match self.release {
            Release::None => false,
            Release::Wanted => true,
            Release::Sent(ticket) => match ticket.and_then(|ticket| snapshot.outcome(ticket)) {
                // Its last levels are not in force yet.
                Some(Outcome::Refused(Refusal::Device(refusal::Refusal::Busy(_)))) => true,
                Some(_) => {
                    self.release = Release::None;
                    false
                }
                None => false,
            },
        };
        if !is_wanted {
            return None;
        }
        if !snapshot.is_connected() {
            // Without a device there is no hold to end.
            self.release = Release::None;
            return None;
        }
        self.release = Release::Sent(None);
        Some(Request::Hold(HoldRequest::OFF))
    }
}

#[cfg(test)]
mod tests;
