//! The Drive button: it sends the tones, or states the obstacle and its remedy.

use super::Drive;
use crate::autopilot;
use crate::changes::Changes;
use crate::instrument::outbox::Outbox;
use crate::instrument::shell::{Attention, Page};
use slipline_link::protocol::event::{Faults, State};
use slipline_link::protocol::version::Compatibility;
use slipline_link::{LinkError, LinkState, Request};
use slipline_model::jobs::table::TableState;
use slipline_model::setup::Setup;

/// The explanation of safe mode, and its remedy.
pub const SAFE_MODE: &str = "Restarted after repeated crashes: it talks but does not drive. \
    Disconnect its power and connect it again; if it comes back like this, flash its firmware.";

/// Why Drive cannot act, and its remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Obstacle {
    #[error("No device is connected: press Connect first.")]
    NotConnected,
    #[error("The device has not answered yet: press Drive once it has.")]
    Connecting,
    #[error("The link itself has failed: close Slipline and start it again.")]
    LinkFailed,
    #[error("The device is lost: press Reconnect first.")]
    Lost,
    #[error(
        "The port {0} does not exist yet: plug the device in or choose another port, \
             and press Drive once it is connected."
    )]
    NoPort(String),
    #[error("The device is lost and looked for: press Drive once it is back.")]
    Reconnecting,
    #[error("{}", .0.sentence())]
    OtherVersion(Compatibility),
    #[error("The device has not reported its state yet: press Drive once it has.")]
    NoState,
    #[error("The device is muted: arm it first, then press Drive.")]
    Muted,
    #[error("The device has stopped: {0}. Press Clear fault first.")]
    Fault(Faults),
    #[error("{SAFE_MODE}")]
    SafeMode,
    #[error("The plate has no table, so it cannot be driven: {0}")]
    NoTable(String),
    #[error("The plate's table was cancelled: press Make the table first.")]
    TableGivenUp,
    #[error("The device holds no table, and the plate's is not made yet: wait, then upload it.")]
    TableUnfinished,
    #[error("The device holds no table: press \"table differs: upload\" first.")]
    TableNotSent,
}

impl Drive {
    /// Handles a press of Drive: the tones are sent now, or as soon as the device is ready for them; or states the obstacle.
    pub(crate) fn start(&mut self, setup: &Setup, attention: &Attention, out: &mut Outbox) {
        if let Some(obstacle) = self.obstacle() {
            out.hinder(obstacle.to_string());
            if obstacle == Obstacle::Muted && !attention.has_page {
                out.open(Page::Arm);
            }
            return;
        }
        self.make_ready();
        let made = self.table_made().cloned();
        if self.autopilot.start(&self.snapshot, made.as_deref()) {
            return self.play(setup);
        }
        if !self.is_table_there() {
            let text = "The drive starts as soon as the device holds the plate's table.";
            out.delay(text.to_owned());
        }
        self.run_autopilot(&Changes::default(), setup, attention.uploads);
    }

    /// Clears a harmless fault and arms a simulated device.
    pub(crate) fn make_ready(&self) {
        if autopilot::drive_clears_fault(&self.snapshot) {
            self.send(Request::ClearFaults);
        }
        if autopilot::drive_arms(&self.snapshot) {
            self.send(Request::Arm);
        }
    }

    /// The obstacle that prevents driving and does not disappear by itself, if there is one.
    pub(crate) fn obstacle(&self) -> Option<Obstacle> {
        let snapshot = &self.snapshot;
        match &snapshot.link.state {
            LinkState::Connected => {}
            LinkState::Disconnected => return Some(Obstacle::NotConnected),
            LinkState::Connecting => return Some(Obstacle::Connecting),
            LinkState::Lost(LinkError::Crashed) => return Some(Obstacle::LinkFailed),
            LinkState::Lost(_) => return Some(Obstacle::Lost),
            LinkState::Reconnecting(LinkError::NoSuchPort(port)) => {
                return Some(Obstacle::NoPort(port.to_string()));
            }
            LinkState::Reconnecting(_) => return Some(Obstacle::Reconnecting),
        }
        if let Some(mismatch) = snapshot.mismatch() {
            return Some(Obstacle::OtherVersion(mismatch));
        }
        let Some(status) = snapshot.drive.status else { return Some(Obstacle::NoState) };
        match status.state {
            State::Idle if !autopilot::drive_arms(snapshot) => return Some(Obstacle::Muted),
            State::Fault if !autopilot::drive_clears_fault(snapshot) => {
                return Some(Obstacle::Fault(status.faults));
            }
            State::SafeMode => return Some(Obstacle::SafeMode),
            State::Idle | State::Armed | State::Waiting | State::Driving | State::Stopping | State::Fault => {
            }
        }
        self.obstacle_of_table(snapshot.is_simulated())
    }

    /// The obstacle to a self-test, which needs no table, and an armed device only where it unmutes the amplifier.
    pub(crate) fn obstacle_to_test(&self, unmutes: bool) -> Option<Obstacle> {
        self.obstacle().filter(|obstacle| {
            let is_of_table = matches!(
                obstacle,
                Obstacle::NoTable(_)
                    | Obstacle::TableGivenUp
                    | Obstacle::TableUnfinished
                    | Obstacle::TableNotSent
            );
            let is_muted = matches!(obstacle, Obstacle::Muted);
            !is_of_table && (unmutes || !is_muted)
        })
    }

    /// The obstacle of the table, if there is one. A simulated device gets its table automatically; a real one at
    /// the user's request.
    fn obstacle_of_table(&self, is_simulated: bool) -> Option<Obstacle> {
        let is_coming = self.snapshot.table.upload.is_some();
        let may_go_on = !is_simulated && self.snapshot.table.report.active.is_some();
        match self.table() {
            _ if may_go_on || is_coming || self.is_table_there() => None,
            TableState::Failed(reason) => Some(Obstacle::NoTable(reason.to_string())),
            TableState::Cancelled => Some(Obstacle::TableGivenUp),
            TableState::Waiting | TableState::Making | TableState::Ready(_) if is_simulated => None,
            TableState::Waiting | TableState::Making => Some(Obstacle::TableUnfinished),
            TableState::Ready(_) => Some(Obstacle::TableNotSent),
        }
    }
}
