//! The level hold: the user's switch, and the user's actions that end it. The requests to the device are in
//! [`Holding`].

use super::Instrument;
use super::shown::HoldScene;
use crate::hold::{HoldEnd, Holding, USUAL_RISE_DB};
use slipline_link::Severity;
use std::time::Duration;

/// Time between two updates of its state.
const LOOK: Duration = Duration::from_millis(50);

/// The state of the level hold.
pub(crate) struct LevelHold {
    pub(crate) holding: Holding,
    max_rise_db: f64,
    /// Whether it begins once the simulated device has its sensor.
    pub(crate) awaits_rig: bool,
}

impl Default for LevelHold {
    fn default() -> Self {
        Self { holding: Holding::default(), max_rise_db: USUAL_RISE_DB, awaits_rig: false }
    }
}

impl Instrument {
    pub(crate) fn hold_scene(&self) -> HoldScene<'_> {
        let LevelHold { holding, max_rise_db, awaits_rig } = &self.level;
        HoldScene {
            holding,
            standing: holding.standing(&self.snapshot),
            has_rig: self.is_at_bench(),
            is_put_up: *awaits_rig,
            max_rise_db: *max_rise_db,
            place_m: self.live.draft.place_m,
        }
    }

    /// Switches the hold on or reports the obstacle; or switches it off.
    pub fn switch_hold(&mut self, is_on: bool) {
        self.level.awaits_rig = false;
        if !is_on {
            return self.level.holding.switch_off();
        }
        if let Some(obstacle) = self.obstacle_to_hold() {
            return self.notices.hinder(obstacle.to_owned());
        }
        if self.is_at_bench() && !self.is_rig_standing() {
            self.level.awaits_rig = true;
            self.live.rig.refused = None;
            return self.put_rig_up();
        }
        self.begin_hold();
    }

    fn begin_hold(&mut self) {
        let LevelHold { holding, max_rise_db, awaits_rig } = &mut self.level;
        *awaits_rig = false;
        holding.switch_on(&self.setup.plate, *max_rise_db, None);
    }

    /// Why the sensor cannot be listened to now.
    fn obstacle_to_hold(&self) -> Option<&'static str> {
        if !self.snapshot.can_listen() {
            return Some("This device has no input for a sensor: its board or its firmware has none.");
        }
        if self.live.is_under_way() {
            return Some("The plate is being measured: wait, cancel that or press STOP first.");
        }
        let is_looked_at = self.attention.is_calibration_open && self.calibrating.has_sensor_in_hand();
        is_looked_at.then_some("The calibration looks at the sensor: close its pages first.")
    }

    /// Sets the largest rise of held tones, dB. An active hold begins again.
    pub fn choose_max_rise(&mut self, decibels: f64) {
        self.level.max_rise_db = decibels;
        if self.level.holding.is_on() {
            self.level.holding.switch_off();
            self.begin_hold();
        }
    }

    /// Ends the hold, if it is on, because of another action of the user.
    pub(crate) fn end_hold(&mut self, end: HoldEnd) {
        self.level.awaits_rig = false;
        if self.level.holding.is_on() {
            self.level.holding.end(end);
            self.tell_end_of_hold();
        }
    }

    /// Sends the hold's requests, and reports when it ends by itself.
    pub(crate) fn update_hold(&mut self) {
        if self.level.awaits_rig && self.is_rig_standing() {
            self.begin_hold();
        }
        let is_pressed = self.attention.is_pressed;
        let mut rests = !is_pressed && !self.attention.is_dragging && self.recorder.played_s().is_none();
        let was_on = self.level.holding.is_on();
        // A finger that is being moved touches the simulated plate once it rests.
        if was_on && rests && self.is_at_bench() {
            rests = self.touch_rig();
        }
        while let Some(request) = self.level.holding.turn(&self.snapshot, &self.setup.plate, rests) {
            self.level.holding.sent(self.link.send(request));
        }
        if was_on && !self.level.holding.is_on() {
            self.tell_end_of_hold();
        }
        if was_on || self.level.awaits_rig {
            self.wake_after(LOOK);
        }
    }

    /// Reports why the levels are no longer held, unless the user has ended the hold.
    fn tell_end_of_hold(&mut self) {
        let Some(end) = self.level.holding.ended() else { return };
        let text = format!("The levels are not held any more: {end}.");
        if end.is_trouble() {
            self.notices.report(Severity::Warning, text.clone(), text);
        } else if *end == HoldEnd::Measured {
            self.notices.post(text);
        }
    }
}
