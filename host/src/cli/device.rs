//! The device of one command: the blocking client, stopped and disarmed when a signal ends the program.

use super::failure::Failure;
use super::output;
use super::progress;
use crate::signals::{self, Ending};
use clap::Args;
use slipline_instrument::measure::Procedure;
use slipline_instrument::native::{ArmingConsent, Client, ClientError};
use slipline_instrument::rig::PreparedRig;
use slipline_link::DeviceTable;
use slipline_link::Port;
use slipline_link::simulator::Options;
use slipline_plate::Plate;
use std::ops::Deref;
use std::sync::Arc;

/// Permission to arm a board without a brown-out level.
#[derive(Debug, Args)]
#[command(next_help_heading = "Device")]
pub(super) struct ArmingArgument {
    /// Arm a board although it reports that its brown-out level is not set.
    #[arg(long)]
    despite_brown_out_level: bool,
    /// Arm a board although it keeps no profile of its actuator.
    #[arg(long)]
    despite_no_profile: bool,
}

/// A connected device. When it is dropped, it is stopped and disarmed.
pub(super) struct Device {
    client: Client,
    /// While this exists, a signal also stops and disarms the device.
    _ending: Ending,
}

impl Deref for Device {
    type Target = Client;

    fn deref(&self) -> &Client {
        &self.client
    }
}

impl From<ClientError> for Failure {
    fn from(error: ClientError) -> Self {
        Self::failed(error)
    }
}

impl Device {
    /// Connects to a device; the simulated one is wired to `rig`, if there is one. A lost link is not reconnected.
    pub(super) fn connect(port: &Port, rig: Option<&PreparedRig>) -> Result<Self, Failure> {
        let client = Client::new(rig)?;
        let ending = signals::stop_before_end(client.handle());
        client.connect(port)?;
        Ok(Self { client, _ending: ending })
    }

    /// Connects to a device that is observed only, which arms nothing.
    pub(super) fn observe(port: &Port, rig: Option<&PreparedRig>) -> Result<Self, Failure> {
        let client = Client::new(rig)?;
        let ending = signals::stop_before_end(client.handle());
        client.observe(port)?;
        Ok(Self { client, _ending: ending })
    }

    /// The same, with a simulated device of these options.
    pub(super) fn observe_simulating(port: &Port, options: Options) -> Result<Self, Failure> {
        let client = Client::simulating(options)?;
        let ending = signals::stop_before_end(client.handle());
        client.observe(port)?;
        Ok(Self { client, _ending: ending })
    }

    /// Checks that the device may be armed: its brown-out level is set and it keeps a profile of its actuator, or the user accepts that
    /// it does not.
    pub(super) fn may_be_armed(&self, arming: &ArmingArgument) -> Result<(), Failure> {
        let consent = ArmingConsent {
            despite_brown_out_level: arming.despite_brown_out_level,
            despite_no_profile: arming.despite_no_profile,
        };
        self.client.may_be_armed(consent).map_err(|error| {
            let option = if matches!(error, ClientError::Unguarded(_)) {
                "--despite-brown-out-level"
            } else if matches!(error, ClientError::NoProfile) {
                "--despite-no-profile"
            } else {
                return error.into();
            };
            Failure::Failed(format!("{error} To arm it anyway, add {option}."))
        })
    }

    /// The plate's table, made for the device's sample rate.
    pub(super) fn make_table(&self, plate: &Plate) -> Result<Arc<DeviceTable>, Failure> {
        let rate_hz = self.identity()?.sample_rate_hz;
        Ok(self.during(|| progress::table_for(plate, rate_hz))??.1)
    }

    /// Makes and uploads the plate's table.
    pub(super) fn use_table(&self, plate: &Plate) -> Result<Arc<DeviceTable>, Failure> {
        let table = self.make_table(plate)?;
        self.use_made(table.clone())?;
        Ok(table)
    }

    /// Uploads a table made for the device's sample rate.
    fn use_made(&self, table: Arc<DeviceTable>) -> Result<(), Failure> {
        let has_limit = table.travel_limit().is_some();
        self.client.use_table(table)?;
        if has_limit && !self.snapshot().can_limit_travel() {
            output::note(
                "slipline: the device does not limit the actuator's travel: its firmware is too old for it",
            );
        }
        Ok(())
    }
}

/// A device that holds a plate's table.
#[derive(Clone)]
pub(super) struct LoadedDevice<'a> {
    pub(super) device: &'a Device,
    pub(super) plate: &'a Plate,
    pub(super) table: Arc<DeviceTable>,
    pub(super) rate_hz: f64,
}

impl<'a> LoadedDevice<'a> {
    /// Uploads the plate's table.
    pub(super) fn new(device: &'a Device, plate: &'a Plate) -> Result<Self, Failure> {
        let rate_hz = f64::from(device.identity()?.sample_rate_hz);
        Ok(Self { device, plate, table: device.use_table(plate)?, rate_hz })
    }

    /// Uploads a table that is made for the device's sample rate already.
    pub(super) fn with(
        device: &'a Device,
        plate: &'a Plate,
        table: Arc<DeviceTable>,
    ) -> Result<Self, Failure> {
        let rate_hz = f64::from(device.identity()?.sample_rate_hz);
        device.use_made(table.clone())?;
        Ok(Self { device, plate, table, rate_hz })
    }
}

/// Arms the device, runs a procedure to its end with a progress bar, and disarms the device.
pub(super) fn run<P: Procedure>(
    device: &Device,
    what: &'static str,
    procedure: P,
) -> Result<P::Found, Failure> {
    Ok(progress::reported(what, |progress| device.run(procedure, progress))?)
}
