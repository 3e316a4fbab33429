//! The actions that are offered in each state of link and device. Every state offers a next step; while the plate
//! is driven that is STOP, which is always shown.

use crate::intent::{Confirm, DeviceIntent, Dialog, Intent, MeasureIntent};
use crate::scene::Scene;
use slipline_instrument::autopilot;
use slipline_link::protocol::event::State;
use slipline_link::{LinkError, LinkState, Port};
use slipline_model::jobs::table::TableState;

/// One action: the text of its button, its explanation and its intents; none while it cannot be pressed.
pub(crate) struct Offer {
    pub(crate) name: &'static str,
    pub(crate) help: String,
    pub(crate) asks: Vec<Intent>,
}

fn offer(name: &'static str, help: impl Into<String>, asks: Intent) -> Offer {
    Offer { name, help: help.into(), asks: vec![asks] }
}

/// The place of a button that has nothing to do at present, so that its neighbour does not come there: a second press of
/// Drive would disarm.
fn idle(name: &'static str, help: &str) -> Offer {
    Offer { name, help: help.to_owned(), asks: Vec::new() }
}

/// The actions of the present state, the most likely first.
pub(crate) fn offers(scene: &Scene<'_>) -> Vec<Offer> {
    let snapshot = scene.snapshot;
    let port = snapshot.link.port.clone().unwrap_or(Port::Simulated);
    let disconnect = |name, help| offer(name, help, Intent::Device(DeviceIntent::Disconnect));
    match &snapshot.link.state {
        LinkState::Disconnected => {
            vec![offer("Connect", format!("Open {port}, the port chosen last"), Intent::Connect(port))]
        }
        LinkState::Connecting => vec![disconnect("Cancel", "Stop waiting and close the port")],
        LinkState::Lost(LinkError::Crashed) => {
            let help = "Close the window, then start Slipline again; it keeps the setup";
            vec![offer("Close Slipline", help, Intent::Quit)]
        }
        LinkState::Lost(_) => {
            vec![offer("Reconnect", format!("Open {port} again"), Intent::Connect(port))]
        }
        LinkState::Reconnecting(LinkError::NoSuchPort(_)) => {
            vec![disconnect("Cancel", "Stop waiting for this port; you can choose another one at any time")]
        }
        LinkState::Reconnecting(_) => vec![disconnect("Stop looking", "Give up the search for the device")],
        LinkState::Connected => connected(scene),
    }
}

/// The actions while the device answers.
fn connected(scene: &Scene<'_>) -> Vec<Offer> {
    let snapshot = scene.snapshot;
    if let Some(mismatch) = snapshot.mismatch() {
        return vec![offer("What to do", mismatch.sentence(), Intent::ShowDevice)];
    }
    let Some(status) = snapshot.drive.status else {
        let close = Intent::Device(DeviceIntent::Disconnect);
        return vec![offer("Disconnect", "Close the port", close)];
    };
    if scene.is_measured_now() {
        // The calibration's pages cover the bar and have their own button.
        if scene.dialog == Some(&Dialog::Calibrate) {
            return Vec::new();
        }
        let cancel = Intent::Measure(MeasureIntent::Cancel);
        return vec![offer("Cancel measuring", "Stop the tones; nothing is kept", cancel)];
    }
    let mut offers = of_state(scene, status.state, snapshot.is_simulated());
    if matches!(scene.table, TableState::Cancelled) && status.state != State::SafeMode {
        let help = "Make the table of this plate: without it the plate cannot be driven";
        offers.push(offer("Make the table", help, Intent::MakeTable));
    }
    offers
}

/// The actions in a device state. Only the user arms a real device; Drive arms a simulated one
/// ([`autopilot::drive_arms`]), and clears its fault if that is harmless.
fn of_state(scene: &Scene<'_>, state: State, is_simulated: bool) -> Vec<Offer> {
    let drive = || offer("Drive", "Sound the tones of the setup (Ctrl+Enter)", Intent::Start);
    let disarm = || offer("Disarm", "Ramp to silence and mute the amplifier", Intent::Disarm);
    match (state, is_simulated) {
        (State::Fault, true) if autopilot::drive_clears_fault(scene.snapshot) => vec![drive()],
        (State::Idle, true) => {
            let arm = Intent::Device(DeviceIntent::Arm);
            vec![drive(), offer("Arm", "Accept drives; no real plate is connected", arm)]
        }
        (State::Idle, false) => {
            let arm = Intent::Dialog(Some(Dialog::Confirm(Confirm::Arm)));
            vec![offer("Arm…", "Unmute the amplifier and accept drives", arm)]
        }
        (State::Armed | State::Waiting | State::Stopping, true) => vec![drive()],
        (State::Armed | State::Waiting, false) => vec![drive(), disarm()],
        (State::Driving, false) => vec![idle("Drive", "Driving"), disarm()],
        (State::Stopping, false) => vec![idle("Drive", "Wait until it is silent"), disarm()],
        (State::Driving, true) => Vec::new(),
        (State::Fault, _) => {
            let clear = Intent::Device(DeviceIntent::ClearFaults);
            vec![offer("Clear fault", "Clear the latched faults whose cause is gone", clear)]
        }
        (State::SafeMode, true) => {
            let port = scene.snapshot.link.port.clone().unwrap_or(Port::Simulated);
            vec![offer("Reconnect", "Restart the simulated device", Intent::Connect(port))]
        }
        (State::SafeMode, false) => {
            let flash = Intent::Dialog(Some(Dialog::Confirm(Confirm::Bootloader)));
            vec![offer("Bootloader…", "Restart into the ROM bootloader to flash firmware", flash)]
        }
    }
}
