//! The level hold: the user's switch, and the user's actions that end it. The requests to the device are in
//! [`Holding`].

use super::{LOOK, Lab, Reach, is_at_bench};
use crate::hold::{HoldEnd, Holding, Standing, USUAL_RISE_DB};
use crate::instrument::outbox::Outbox;
use crate::instrument::shell::Attention;
use crate::instrument::shown::HoldScene;
use slipline_link::{Severity, Snapshot};
use slipline_plate::{Finger, Plate};
use std::sync::Arc;

/// The state of the level hold.
pub(super) struct LevelHold {
    pub(super) holding: Holding,
    max_rise_db: f64,
    /// Whether it begins once the simulated device has its sensor.
    pub(super) awaits_rig: bool,
}

impl Default for LevelHold {
    fn default() -> Self {
        Self { holding: Holding::default(), max_rise_db: USUAL_RISE_DB, awaits_rig: false }
    }
}

impl LevelHold {
    pub(super) fn scene<'a>(&'a self, snapshot: &'a Snapshot, has_rig: bool, place_m: f64) -> HoldScene<'a> {
        let Self { holding, max_rise_db, awaits_rig } = self;
        let (is_put_up, max_rise_db) = (*awaits_rig, *max_rise_db);
        HoldScene { holding, standing: holding.standing(snapshot), has_rig, is_put_up, max_rise_db, place_m }
    }

    /// Whether it listens to the sensor, or will once there is one.
    pub(super) fn needs_sensor(&self) -> bool {
        self.awaits_rig || self.holding.is_on()
    }

    fn begin(&mut self, plate: &Arc<Plate>) {
        self.awaits_rig = false;
        self.holding.switch_on(plate, self.max_rise_db, None);
    }

    /// Reports why the levels are no longer held, unless the user has ended the hold.
    fn report_end(&self, out: &mut Outbox) {
        let Some(end) = self.holding.ended() else { return };
        let text = format!("The levels are not held any more: {end}.");
        if end.is_trouble() {
            out.report(Severity::Warning, text.clone(), text);
        } else if *end == HoldEnd::Measured {
            out.post(text);
        }
    }
}

impl Lab {
    /// Switches the hold on or reports the obstacle; or switches it off.
    pub(crate) fn switch_hold(&mut self, is_on: bool, reach: &mut Reach<'_>) {
        self.hold.awaits_rig = false;
        if !is_on {
            return self.hold.holding.switch_off();
        }
        if let Some(obstacle) = self.obstacle_to_hold(reach) {
            return reach.out.hinder(obstacle.to_owned());
        }
        if is_at_bench(reach.drive.snapshot()) && !self.is_rig_standing(reach) {
            self.hold.awaits_rig = true;
            self.rig.refused = None;
            return self.put_rig_up(reach);
        }
        self.hold.begin(reach.desk.plate());
    }

    /// Why the sensor cannot be listened to now.
    fn obstacle_to_hold(&self, reach: &Reach<'_>) -> Option<&'static str> {
        if !reach.drive.snapshot().can_listen() {
            return Some("This device has no input for a sensor: its board or its firmware has none.");
        }
        if self.is_measuring() {
            return Some("The plate is being measured: wait, cancel that or press STOP first.");
        }
        let is_looked_at = reach.attention.is_calibration_open && self.calibration.has_sensor_in_hand();
        is_looked_at.then_some("The calibration looks at the sensor: close its pages first.")
    }

    /// Sets the largest rise of held tones, dB. An active hold begins again.
    pub(crate) fn choose_max_rise(&mut self, decibels: f64, plate: &Arc<Plate>) {
        self.hold.max_rise_db = decibels;
        if self.hold.holding.is_on() {
            self.hold.holding.switch_off();
            self.hold.begin(plate);
        }
    }

    /// Ends the hold, if it is on, because of another action of the user.
    pub(crate) fn end_hold(&mut self, end: HoldEnd, out: &mut Outbox) {
        self.hold.awaits_rig = false;
        if self.hold.holding.is_on() {
            self.hold.holding.end(end);
            self.hold.report_end(out);
        }
    }

    /// Sends the hold's requests, and reports when it ends by itself.
    pub(super) fn update_hold(&mut self, load: Option<Finger>, reach: &mut Reach<'_>) {
        let plate = reach.desk.plate();
        if self.hold.awaits_rig && self.is_rig_standing(reach) {
            self.hold.begin(plate);
        }
        let Attention { is_pressed, is_dragging, .. } = *reach.attention;
        let mut rests = !is_pressed && !is_dragging && reach.desk.recorder().played_s().is_none();
        let was_on = self.hold.holding.is_on();
        let (drive, holding) = (&*reach.drive, &mut self.hold.holding);
        // A finger that is being moved touches the simulated plate once it rests; listening needs an untouched plate.
        if was_on && rests && is_at_bench(drive.snapshot()) {
            let is_held = matches!(holding.standing(drive.snapshot()), Standing::Holding(_));
            rests = self.rig.touch(load.filter(|_| is_held));
        }
        while let Some(request) = holding.turn(drive.snapshot(), plate, rests) {
            holding.sent(drive.send(request));
        }
        if was_on && !holding.is_on() {
            self.hold.report_end(reach.out);
        }
        if was_on || self.hold.awaits_rig {
            reach.out.wake_after(LOOK);
        }
    }
}
