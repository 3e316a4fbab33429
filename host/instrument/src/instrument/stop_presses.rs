//! Presses of STOP, Esc and Space. One press stops, and disarms a real device; two within a second are an emergency stop.
//! Esc also leaves pages and fields, so on a simulated device that is known to be silent a key is no first press.

use super::Instrument;
use crate::hold::HoldEnd;
use slipline_link::Request;
use slipline_link::protocol::event::State;

/// The second press counts within this time after the first, in seconds.
const TWICE_S: f64 = 1.0;

/// Time of the last press of STOP.
#[derive(Default)]
pub(crate) struct StopPresses {
    /// In seconds of the window's clock.
    last_s: Option<f64>,
}

impl StopPresses {
    /// Records a press; returns whether it is the second of two within [`TWICE_S`].
    fn is_second(&mut self, now_s: f64) -> bool {
        let is_second = self.has_first(now_s);
        self.last_s = Some(now_s);
        is_second
    }

    /// Whether a press now would be the second of two.
    fn has_first(&self, now_s: f64) -> bool {
        self.last_s.is_some_and(|last_s| now_s - last_s <= TWICE_S)
    }
}

impl Instrument {
    /// Carries out a press of a key of STOP.
    pub fn press_stop_key(&mut self) {
        if self.is_known_to_be_silent() && !self.stop_presses.has_first(self.attention.now_s) {
            self.stop();
        } else {
            self.press_stop();
        }
    }

    /// Whether nothing sounds, and nothing real could move: the device is simulated, connected, without a fault, and no
    /// drive or measurement is wanted.
    fn is_known_to_be_silent(&self) -> bool {
        let state = self.snapshot.status.map(|status| status.state);
        self.snapshot.is_connected()
            && self.snapshot.is_simulated()
            && matches!(state, Some(State::Idle | State::Armed))
            && !self.autopilot.wants_drive()
            && !self.live.is_under_way()
    }

    /// Carries out a press of the STOP button.
    pub fn press_stop(&mut self) {
        if self.stop_presses.is_second(self.attention.now_s) {
            self.end_drive(Request::EmergencyStop);
            return;
        }
        self.stop();
    }

    /// Stops the drive for every source and disarms a real device: only the user can drive again.
    pub fn stop(&mut self) {
        self.end_drive(Request::Stop);
        // The simulated device stays armed: nothing real moves, and it would be armed again automatically. A
        // device of another version accepts no command but the stop.
        let may_drive = self.snapshot.compatibility.is_none_or(|compatibility| compatibility.may_drive());
        if self.snapshot.is_connected() && !self.snapshot.is_simulated() && may_drive {
            self.link.send(Request::Disarm);
        }
    }

    /// Disarms at the user's request.
    pub fn disarm(&mut self) {
        self.end_drive(Request::Stop);
        self.link.send(Request::Disarm);
    }

    /// Sends a stop; the drive is no longer wanted.
    fn end_drive(&mut self, stop: Request) {
        self.autopilot.stopped();
        self.end_replay();
        self.cancel_measuring();
        self.end_hold(HoldEnd::Stopped);
        self.notices.settle();
        self.link.send(stop);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_press_counts_within_a_second_of_the_one_before() {
        let mut presses = StopPresses::default();
        let times_s = [5.0, 6.1, 7.1, 7.2, 9.0];
        assert_eq!(times_s.map(|now_s| presses.is_second(now_s)), [false, false, true, true, false]);
    }
}
