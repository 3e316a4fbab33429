//! Requests of the user to the device itself.

use super::Drive;
use slipline_link::Request;
use slipline_link::protocol::board::BrownOutOrder;
use slipline_link::protocol::event::State;
use slipline_link::protocol::limits::LEASE_MS;
use slipline_link::protocol::profile::ActuatorProfile;
use std::time::Duration;

/// How long a device that its user has armed stays armed without a drive: as long as a drive may last.
const LEASE: Duration = Duration::from_millis(LEASE_MS.1 as u64);

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
    /// Write the brown-out level that the board needs, and restart. The caller has asked the user
    /// ([`upkeep::OPTION_BYTES_RISK`](slipline_link::upkeep::OPTION_BYTES_RISK)), who holds the board's button.
    RaiseBrownOutLevel,
}

impl Drive {
    /// Carries out a request of the user to the device.
    pub(crate) fn perform(&mut self, intent: DeviceIntent) {
        if matches!(intent, DeviceIntent::Store | DeviceIntent::Forget | DeviceIntent::RaiseBrownOutLevel) {
            self.disarm_to_write();
        }
        let ticket = self.send(match intent {
            DeviceIntent::Disconnect => Request::Disconnect,
            DeviceIntent::AutoReconnect(looks) => Request::AutoReconnect(looks),
            DeviceIntent::Arm => Request::ArmFor(LEASE),
            DeviceIntent::ClearFaults => Request::ClearFaults,
            DeviceIntent::CancelUpload => Request::CancelUpload,
            DeviceIntent::ReadBack => Request::ReadBack,
            DeviceIntent::Store => Request::Store,
            DeviceIntent::Forget => Request::Forget,
            DeviceIntent::Bootloader => Request::Bootloader,
            DeviceIntent::RaiseBrownOutLevel => Request::BrownOut(BrownOutOrder { is_written: true }),
        });
        if intent == DeviceIntent::ClearFaults {
            self.tickets.clear = Some(ticket);
        }
    }

    /// Writes the profile of the board's actuator; an armed device is disarmed first. The device refuses it while the board's user
    /// button is not pressed, which is shown as any refusal.
    pub fn write_profile(&self, profile: ActuatorProfile) {
        self.disarm_to_write();
        self.send(Request::WriteProfile(Box::new(Some(profile))));
    }

    /// An armed device does not write its flash.
    fn disarm_to_write(&self) {
        if self.snapshot.drive.status.is_some_and(|status| status.state == State::Armed) {
            self.send(Request::Disarm);
        }
    }
}
