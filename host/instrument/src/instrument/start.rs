//! The Drive button: it sends the tones, or tells the user the obstacle and what helps.

use super::Instrument;
use super::{Output, Page};
use crate::autopilot;
use slipline_link::protocol::event::State;
use slipline_link::{LinkError, LinkState, Request};
use slipline_model::jobs::table::TableState;
use std::sync::Arc;

/// The explanation of safe mode, and what helps.
pub const SAFE_MODE: &str = "Restarted after repeated crashes: it talks but does not drive. \
    Take its power away and connect it again; if it comes back like this, flash its firmware.";

/// Why Drive cannot act.
struct Obstacle {
    text: String,
    /// The page that helps, if there is one.
    page: Option<Page>,
}

impl From<&str> for Obstacle {
    fn from(text: &str) -> Self {
        Self { text: text.to_owned(), page: None }
    }
}

impl Instrument {
    /// Handles a press of Drive: the tones are sent now, or as soon as the device is ready for them.
    pub fn start(&mut self) {
        if self.live.is_under_way() {
            let text = "The plate is being measured: cancel that or press STOP first.";
            return self.notices.hinder(text.to_owned());
        }
        if let Some(Obstacle { text, page }) = self.obstacle() {
            self.notices.hinder(text);
            if let Some(page) = page.filter(|_| !self.attention.has_page) {
                self.outputs.push(Output::Open(page));
            }
            return;
        }
        self.make_ready();
        let made = self.screen_table().cloned();
        if self.autopilot.start(&self.snapshot, made.as_deref()) {
            self.send_drive();
            return;
        }
        if !self.is_table_there() {
            let text = "The plate is driven as soon as the device holds its table.";
            self.notices.tell(text.to_owned());
        }
        let snapshot = Arc::clone(&self.snapshot);
        self.run_autopilot(&snapshot);
    }

    /// Clears a harmless fault and arms a simulated device.
    pub(crate) fn make_ready(&mut self) {
        if autopilot::drive_clears_fault(&self.snapshot) {
            self.link.send(Request::ClearFaults);
        }
        if autopilot::drive_arms(&self.snapshot) {
            self.link.send(Request::Arm);
        }
    }

    /// Why the plate cannot be driven now, if there is something that does not disappear by itself.
    pub(crate) fn obstacle_to_drive(&self) -> Option<String> {
        self.obstacle().map(|obstacle| obstacle.text)
    }

    /// Whether the device holds the table of the plate on the screen.
    pub(crate) fn is_table_there(&self) -> bool {
        let on_device = self.snapshot.table.active.map(|header| header.crc);
        self.screen_table().is_some_and(|made| on_device == Some(made.device_table.crc()))
    }

    /// The obstacle that prevents driving and does not disappear by itself, if there is one.
    fn obstacle(&self) -> Option<Obstacle> {
        let snapshot = &self.snapshot;
        match &snapshot.link {
            LinkState::Connected => {}
            LinkState::Disconnected => return Some("No device is connected: press Connect first.".into()),
            LinkState::Connecting => {
                return Some("The device has not answered yet: press Drive once it has.".into());
            }
            LinkState::Lost(LinkError::Crashed) => {
                return Some("The link itself has failed: close Slipline and start it again.".into());
            }
            LinkState::Lost(_) => return Some("The device is lost: press Reconnect first.".into()),
            LinkState::Reconnecting(LinkError::NoSuchPort(port)) => {
                let text = format!(
                    "The port {port} is not there yet: plug the device in or choose another port, \
                     and press Drive once it is connected."
                );
                return Some(Obstacle { text, page: None });
            }
            LinkState::Reconnecting(_) => {
                return Some("The device is lost and looked for: press Drive once it is back.".into());
            }
        }
        if let Some(mismatch) = snapshot.compatibility.filter(|compatibility| !compatibility.may_drive()) {
            return Some(mismatch.sentence().into());
        }
        let Some(status) = snapshot.status else {
            return Some("The device has not told its state yet: press Drive once it has.".into());
        };
        match status.state {
            State::Idle if !autopilot::drive_arms(snapshot) => {
                let text = "The device is muted: arm it first, then press Drive.".to_owned();
                return Some(Obstacle { text, page: Some(Page::Arm) });
            }
            State::Fault if !autopilot::drive_clears_fault(snapshot) => {
                let text = format!("The device has stopped: {}. Press Clear fault first.", status.faults);
                return Some(Obstacle { text, page: None });
            }
            State::SafeMode => return Some(SAFE_MODE.into()),
            State::Idle | State::Armed | State::Waiting | State::Driving | State::Stopping | State::Fault => {
            }
        }
        self.obstacle_of_table(snapshot.is_simulated())
    }

    /// The obstacle of the table, if there is one. A simulated device gets its table automatically; a real one at
    /// the user's request.
    fn obstacle_of_table(&self, is_simulated: bool) -> Option<Obstacle> {
        let is_coming = self.snapshot.upload.is_some();
        let may_go_on = !is_simulated && self.snapshot.table.active.is_some();
        match &self.table {
            _ if may_go_on || is_coming || self.is_table_there() => None,
            TableState::Failed(reason) => {
                let text = format!("The plate has no table, so it cannot be driven: {reason}");
                Some(Obstacle { text, page: None })
            }
            TableState::Cancelled => {
                Some("The making of the plate's table was given up: press Make the table first.".into())
            }
            TableState::Waiting | TableState::Making | TableState::Ready(_) if is_simulated => None,
            TableState::Waiting | TableState::Making => Some(
                "The device holds no table, and the plate's is not made yet: wait, then upload it.".into(),
            ),
            TableState::Ready(_) => {
                Some("The device holds no table: press \"table differs: upload\" first.".into())
            }
        }
    }
}
