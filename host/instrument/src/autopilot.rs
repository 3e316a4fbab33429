//! Requests that the app sends to the device without a user action: the table after a change of plate, and the
//! drive as soon as the device takes it.
//!
//! It never arms a real device and never drives one that the user has not asked to drive. The simulated device is
//! armed by the link worker, and driven from the start so that the plate moves when the window opens.

use crate::changes::Changes;
use slipline_link::DeviceTable;
use slipline_link::protocol::command::TravelLimit;
use slipline_link::protocol::event::{Fault, Faults, State};
use slipline_link::protocol::refusal;
use slipline_link::{LinkState, Port, Refusal, Snapshot};
use slipline_model::jobs::table::TableMade;
use std::sync::Arc;

/// A request to the device.
#[derive(Clone, Debug)]
pub enum Action {
    /// Send this table.
    Upload(Arc<DeviceTable>),
    /// Send the setup's tones.
    Drive,
}

/// What the user wants from the device, and what has been sent to achieve it.
#[derive(Clone, Debug, Default)]
pub struct Autopilot {
    wants_drive: bool,
    /// Whether the user stopped the drive: a new connection must not start it again.
    is_stopped: bool,
    /// Whether the screen shows a complete new setup, such as an opened file, that was not sent yet.
    is_setup_new: bool,
    /// CRC and travel limit of the last table sent automatically, so that a table that fails is not sent
    /// repeatedly.
    sent_table: Option<(u32, Option<TravelLimit>)>,
    /// Whether a drive has been sent since the device was last armed or its table changed.
    has_driven: bool,
}

impl Autopilot {
    /// The user chose a port.
    pub fn connecting(&mut self, port: &Port) {
        let is_stopped = self.is_stopped;
        *self = Self { wants_drive: *port == Port::Simulated && !is_stopped, is_stopped, ..Self::default() };
    }

    /// Whether the user wants the plate driven.
    #[must_use]
    pub(crate) fn wants_drive(&self) -> bool {
        self.wants_drive
    }

    /// The user stopped the drive.
    pub fn stopped(&mut self) {
        self.is_stopped = true;
        self.forget_drive("the user stopped it");
    }

    /// The plate must no longer be driven; `why` goes to the trace.
    fn forget_drive(&mut self, why: &str) {
        if self.wants_drive {
            tracing::debug!("autopilot: drive no longer wanted: {why}");
        }
        self.wants_drive = false;
        self.has_driven = false;
    }

    /// The screen shows another setup, whose table must be made first. Its tones are sent once the device
    /// holds that table.
    pub(crate) fn setup_replaced(&mut self) {
        self.is_setup_new = true;
    }

    /// The user wants the plate driven. Returns whether to send the drive now: not while the table is being
    /// sent; then [`update`](Self::update) sends the drive later. `made` is the table for the plate on the
    /// screen.
    pub fn start(&mut self, snapshot: &Snapshot, made: Option<&TableMade>) -> bool {
        self.is_stopped = false;
        self.wants_drive = snapshot.is_connected();
        if !is_in_force(snapshot, made) && snapshot.table.upload.is_none() {
            // A table whose upload was cancelled or failed is tried again, because the user asks for it.
            self.sent_table = None;
        }
        self.has_driven = self.may_drive(snapshot) && !is_table_coming(snapshot, made);
        if self.has_driven {
            // The caller sends the drive now, so nothing remains to be sent for this setup.
            self.is_setup_new = false;
        }
        self.has_driven
    }

    /// Whether a change of the setup must be sent to the device.
    #[must_use]
    pub fn may_drive(&self, snapshot: &Snapshot) -> bool {
        let has_table = snapshot.table.report.active.is_some();
        self.wants_drive && snapshot.is_armed() && snapshot.is_connected() && has_table
    }

    /// Requests that follow from the changes of the snapshot. `made` is the table for the plate on the
    /// screen; `is_uploading_wanted` says whether a real device gets a new table automatically.
    pub fn update(
        &mut self,
        changes: &Changes,
        now: &Snapshot,
        made: Option<&TableMade>,
        is_uploading_wanted: bool,
    ) -> Vec<Action> {
        let mut actions = Vec::new();
        if !matches!(now.link.state, LinkState::Connecting | LinkState::Connected) {
            // After a lost connection the device is disarmed and silent, and its table must be checked again.
            self.forget_drive("the connection is lost");
            self.sent_table = None;
            return actions;
        }
        let state = now.drive.status.map(|status| status.state);
        // If the user pressed Drive during this fault, the fault is being cleared and the drive is still wanted.
        let is_cleared = drive_clears_fault(now) && !changes.state && !changes.faults;
        if matches!(state, Some(State::Fault | State::SafeMode)) && !is_cleared {
            self.forget_drive("the device has a fault");
        }
        if !now.is_connected() {
            return actions;
        }
        if state == Some(State::Idle) && !now.may_arm_unasked() {
            // Arming the device again does not permit driving it.
            self.forget_drive("the device was disarmed");
        }
        if now.mismatch().is_some() {
            return actions;
        }
        let is_held = is_held(now, made);
        if let Some(made) = made {
            let crc = made.device_table.crc();
            let sent = Some((crc, made.device_table.travel_limit()));
            // A table that the device already holds is only verified; that needs no permission from the user.
            let is_wanted = now.is_simulated() || is_uploading_wanted || is_held;
            let is_known = is_in_force(now, Some(made)) && now.table.confirmed.is_some();
            if is_wanted && !is_known && now.table.upload.is_none() && self.sent_table != sent {
                self.sent_table = sent;
                tracing::debug!("autopilot: sending the table {crc:08x}");
                actions.push(Action::Upload(Arc::clone(&made.device_table)));
                return actions;
            }
        }
        if changes.table || !now.is_armed() {
            self.has_driven = false;
        }
        // The same plate from another file has the same table, so only this flag shows that tones wait to be
        // send.
        let is_due = !self.has_driven || (self.is_setup_new && is_held);
        if self.wants_drive && is_due && !is_table_coming(now, made) && self.may_drive(now) {
            self.has_driven = true;
            self.is_setup_new = false;
            tracing::debug!("autopilot: sending the drive");
            actions.push(Action::Drive);
        }
        actions
    }
}

/// Whether Drive also clears the fault: only the fault of the drive time, and only on a simulated device, where it
/// is harmless. On a real device the user must do both steps.
#[must_use]
pub fn drive_clears_fault(snapshot: &Snapshot) -> bool {
    let stood = Faults::NONE.with(Fault::DriveTime);
    snapshot.is_simulated()
        && snapshot.is_connected()
        && snapshot.drive.status.is_some_and(|status| status.state == State::Fault && status.faults == stood)
}

/// Whether Drive also arms the device.
#[must_use]
pub fn drive_arms(snapshot: &Snapshot) -> bool {
    snapshot.may_arm_unasked()
        && snapshot.is_connected()
        && snapshot.drive.status.is_some_and(|status| status.state == State::Idle)
}

/// Whether a refused drive may succeed from rest. The device refuses a glide that would exceed headroom or
/// actuator travel on its path, although the final tones may fit. No other refusal concerns the path.
#[must_use]
pub(crate) const fn rest_helps(refusal: &Refusal) -> bool {
    matches!(
        refusal,
        Refusal::Device(
            refusal::Refusal::Headroom { .. } | refusal::Refusal::Travel { allowed_per_mille: 0, .. }
        )
    )
}

/// Whether the device holds the table of the plate on the screen.
fn is_held(snapshot: &Snapshot, made: Option<&TableMade>) -> bool {
    let on_device = snapshot.table.report.active.map(|header| header.crc);
    made.is_some_and(|made| on_device == Some(made.device_table.crc()))
}

/// Whether the device holds the table of the plate on the screen with that plate's travel limit.
fn is_in_force(snapshot: &Snapshot, made: Option<&TableMade>) -> bool {
    is_held(snapshot, made) && made.is_some_and(|made| snapshot.limits_travel_for(&made.device_table))
}

/// Whether a table is being sent. Until it arrives the device would place tones by the old table, or hold the
/// right table without its travel limit.
fn is_table_coming(snapshot: &Snapshot, made: Option<&TableMade>) -> bool {
    let misses_limit = is_held(snapshot, made) && !is_in_force(snapshot, made);
    snapshot.table.upload.is_some() || misses_limit || (snapshot.is_simulated() && !is_held(snapshot, made))
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_link::simulator::loopback::Loopback;
    use slipline_model::field::simulation::device_table;

    #[test]
    fn a_stop_holds_over_another_connection() {
        let mut autopilot = Autopilot::default();
        autopilot.connecting(&Port::Simulated);
        assert!(autopilot.wants_drive(), "the plate moves when the window opens");
        autopilot.stopped();
        autopilot.connecting(&Port::Simulated);
        assert!(!autopilot.wants_drive());
    }

    /// The table of a membrane at an actuator of this static travel; 1 mm is allowed.
    fn made(static_m: f64) -> TableMade {
        let mut spec = slipline_plate::preset("membrane").unwrap().spec().clone();
        let travel = Some(slipline_plate::Travel { peak_m: 1e-3, static_m });
        let resonator = slipline_plate::Resonator { resonance_hz: 40.0, quality: 0.7, travel };
        spec.actuator = Some(slipline_plate::Actuator::Resonator(resonator));
        let plate = Arc::new(slipline_plate::Plate::new(spec).unwrap());
        let drive_table = slipline_plate::DriveTable::build(&plate, 400e3, 33).unwrap();
        let device_table = Arc::new(device_table(&drive_table).unwrap());
        TableMade { plate, drive_table, device_table, sensitivity_db: None }
    }

    #[test]
    fn a_plate_that_differs_in_its_peak_travel_only_is_sent_with_its_own_limit() {
        let (stiff, soft) = (made(1e-6), made(2e-6));
        let limits =
            [&stiff, &soft].map(|made| made.device_table.travel_limit().map(|limit| limit.static_ppm));
        assert_eq!(limits, [Some(1000), Some(2000)]);
        assert_eq!(stiff.device_table.crc(), soft.device_table.crc(), "neither is lowered");
        let loopback = Loopback::connect(400_000).unwrap();
        let (now, mut autopilot) = (loopback.view(), Autopilot::default());
        let mut sent = |made| {
            let actions = autopilot.update(&Changes::default(), now, Some(made), true);
            actions.iter().filter(|action| matches!(action, Action::Upload(_))).count()
        };
        assert_eq!([sent(&stiff), sent(&stiff), sent(&soft), sent(&soft)], [1, 0, 1, 0]);
    }

    #[test]
    fn a_pause_at_rest_helps_where_only_the_glide_is_refused() {
        let travel =
            |allowed_per_mille| refusal::Refusal::Travel { travel_per_mille: 2000, allowed_per_mille };
        let headroom = refusal::Refusal::Headroom { sum_per_mille: 1500 };
        let refusals = [travel(0), travel(500), headroom, refusal::Refusal::NoTable];
        assert_eq!(refusals.map(|refusal| rest_helps(&Refusal::Device(refusal))), [true, false, true, false]);
    }
}
