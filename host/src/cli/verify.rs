//! `slipline verify`: checks that the device sends exactly the codes of the mirror.

use super::argument::Typed;
use super::destination::ForceArgument;
use super::device::{ArmingArgument, Device};
use super::failure::Failure;
use super::rig::PortArgument;
use super::{argument, output};
use clap::Args;
use serde_json::json;
use slipline_instrument::measure::{Verified, verify_windows_s};
use slipline_link::protocol::limits::MAX_TONES;
use slipline_plate::quantity::Measure;

/// `verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    #[command(flatten)]
    port: PortArgument,
    /// The plate whose table is used. Without this option: SLIPLINE_PLATE of the environment, else plate = "..." of the
    /// settings file, else membrane.
    #[arg(long, value_name = "PLATE", help_heading = "Plate")]
    plate: Option<String>,
    /// Number of tones, 1 to 16.
    #[arg(long, value_parser = argument::count(1, MAX_TONES), allow_hyphen_values = true, default_value = "16")]
    tones: usize,
    /// Longest window of codes per digest.
    #[arg(long, value_name = "TIME", value_parser = argument::time, allow_hyphen_values = true, default_value = "250ms")]
    window: Typed<f64>,
    // For the trace, which main writes.
    #[command(flatten)]
    force: ForceArgument,
    #[command(flatten)]
    arming: ArmingArgument,
}

pub(super) fn run(arguments: &VerifyArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate_or_default(arguments.plate.as_deref())?;
    let count = u8::try_from(arguments.tones).map_err(Failure::refused)?;
    let port = arguments.port.port()?;
    let device = Device::connect(&port, arguments.port.rig(Some(&plate))?.as_ref())?;
    device.may_be_armed(&arguments.arming)?;
    let windows = verify_windows_s(f64::from(device.identity()?.sample_rate_hz));
    let window_s = arguments.window.within("--window", windows, Measure::Time, "")?;
    device.use_table(&plate)?;
    let verified = device.verify(&plate, count, window_s)?;
    report(&port.to_string(), &verified, as_json)?;
    if verified.equal { Ok(()) } else { Err(Failure::failed("the device's codes differ from the mirror's")) }
}

fn report(port: &str, verified: &Verified, as_json: bool) -> Result<(), Failure> {
    let mut value = json!(verified);
    value["port"] = json!(port);
    output::print(as_json, &value, |out| {
        let header = ["Stage", "From sample", "Samples", "Device", "Mirror", ""].map(str::to_owned).to_vec();
        let rows = verified.windows.iter().map(|it| {
            vec![
                it.stage.to_owned(),
                it.at_samples.to_string(),
                it.samples.to_string(),
                it.device_crc.clone().unwrap_or_else(|| "none".to_owned()),
                it.mirror_crc.clone(),
                if it.equal { "equal" } else { "DIFFERENT" }.to_owned(),
            ]
        });
        output::table(out, &std::iter::once(header).chain(rows).collect::<Vec<_>>())
    })
}
