//! Requests of the user to the device itself.

use super::Instrument;
use slipline_link::Request;
use slipline_link::protocol::event::State;

/// A request of the user to the device itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceIntent {
    /// End the connection.
    Disconnect,
    /// Switch the automatic search for a lost device on or off.
    AutoReconnect(bool),
    /// Unmute the amplifier.
    Arm,
    /// Clear the faults whose causes are gone.
    ClearFaults,
    /// Cancel the upload of a table.
    CancelUpload,
    /// Read the table back and compare it.
    ReadBack,
    /// Overwrite the data in the device's flash.
    Store,
    /// Erase the data in the device's flash.
    Forget,
    /// Restart into the bootloader.
    Bootloader,
}

impl Instrument {
    /// Carries out a request of the user to the device.
    pub fn perform_device(&mut self, intent: DeviceIntent) {
        let is_armed = self.snapshot.status.is_some_and(|status| status.state == State::Armed);
        if is_armed && matches!(intent, DeviceIntent::Store | DeviceIntent::Forget) {
            // An armed device does not write its flash.
            self.link.send(Request::Disarm);
        }
        let ticket = self.link.send(match intent {
            DeviceIntent::Disconnect => Request::Disconnect,
            DeviceIntent::AutoReconnect(looks) => Request::AutoReconnect(looks),
            DeviceIntent::Arm => Request::Arm,
            DeviceIntent::ClearFaults => Request::ClearFaults,
            DeviceIntent::CancelUpload => Request::CancelUpload,
            DeviceIntent::ReadBack => Request::ReadBack,
            DeviceIntent::Store => Request::Store,
            DeviceIntent::Forget => Request::Forget,
            DeviceIntent::Bootloader => Request::Bootloader,
        });
        if intent == DeviceIntent::ClearFaults {
            self.clear_sent = Some(ticket);
        }
    }
}
