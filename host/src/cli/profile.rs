//! `slipline profile`: the profile of a board's actuator.

use super::device::Device;
use super::failure::Failure;
use super::output;
use super::rig::PortArgument;
use super::source::text_of;
use clap::{Args, Subcommand};
use serde_json::json;
use slipline_instrument::profile_file;
use slipline_link::protocol::event::ProfileReport;
use slipline_link::protocol::profile::ActuatorProfile;
use slipline_link::protocol::version::Compatibility;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Shows the profile; with `write` or `erase`, changes it.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct ProfileArguments {
    #[command(flatten)]
    port: PortArgument,
    #[command(subcommand)]
    change: Option<Change>,
}

/// A change of the profile, which the board's user confirms with the button on the board.
#[derive(Debug, Subcommand)]
enum Change {
    /// Write a profile into the board's flash. Press the board's user button and hold it meanwhile.
    Write {
        /// The profile: a TOML file, as `slipline profile` prints it.
        #[arg(value_name = "PROFILE.toml")]
        file: PathBuf,
        #[command(flatten)]
        port: PortArgument,
    },
    /// Erase the profile. Press the board's user button and hold it meanwhile.
    Erase {
        #[command(flatten)]
        port: PortArgument,
    },
}

pub(super) fn run(arguments: &ProfileArguments, as_json: bool) -> Result<(), Failure> {
    let (port, change) = match &arguments.change {
        Some(Change::Write { file, port }) => (port, Some(Some(read(file)?))),
        Some(Change::Erase { port }) => (port, Some(None)),
        None => (&arguments.port, None),
    };
    let device = Device::observe(&port.port()?, port.rig(None)?.as_ref())?;
    if let Some(profile) = change {
        device.disarm()?;
        device.write_profile(profile)?;
        // The report that follows the write.
        device.refresh()?;
    }
    let report = device.snapshot().device.profile.clone();
    let report = report.ok_or_else(|| Failure::Failed(Compatibility::DeviceOlder.sentence().to_owned()))?;
    show(&report, as_json)
}

fn read(file: &Path) -> Result<ActuatorProfile, Failure> {
    let text = text_of(file, profile_file::BYTES_MAX)?;
    profile_file::read(&text).map_err(|error| Failure::in_file(file, error))
}

fn show(report: &Arc<ProfileReport>, as_json: bool) -> Result<(), Failure> {
    output::print(as_json, &json!(profile_file::answer(report)), |out| match &report.profile {
        Some(profile) => write!(out, "{}", profile_file::write(profile)),
        None => writeln!(out, "The device keeps no profile of its actuator."),
    })
}
