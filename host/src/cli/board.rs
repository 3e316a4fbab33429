//! `slipline board`: what is set once per board, by the board itself, and its latched faults.

use super::device::Device;
use super::failure::Failure;
use super::output;
use super::rig::PortArgument;
use clap::{Args, Subcommand};
use serde_json::json;
use slipline_instrument::requests::BrownOutAnswer;
use slipline_link::protocol::board::BrownOut;
use slipline_link::upkeep;
use std::io::{self, IsTerminal as _};

/// `board`.
#[derive(Debug, Args)]
pub struct BoardArguments {
    #[command(subcommand)]
    setting: Setting,
}

/// What is shown or set.
#[derive(Debug, Subcommand)]
enum Setting {
    /// Show the level of the board's brown-out reset; with --set, write the one that the board needs.
    BrownOut(BrownOutArguments),
    /// Clear the latched faults whose causes are gone. Arms nothing.
    ClearFaults(ClearFaultsArguments),
}

/// `board clear-faults`.
#[derive(Debug, Args)]
struct ClearFaultsArguments {
    #[command(flatten)]
    port: PortArgument,
}

/// `board brown-out`.
#[derive(Debug, Args)]
struct BrownOutArguments {
    #[command(flatten)]
    port: PortArgument,
    /// Write the level that the board needs into its chip's option bytes, once; the board then restarts. Press the board's user button
    /// and hold it meanwhile. Asks first whether the power is safe.
    #[arg(long, help_heading = "Board")]
    set: bool,
    /// The board's power will not fail meanwhile: the answer to the question of --set.
    #[arg(long, requires = "set", help_heading = "Board")]
    power_is_safe: bool,
}

pub(super) fn run(arguments: &BoardArguments, as_json: bool) -> Result<(), Failure> {
    match &arguments.setting {
        Setting::BrownOut(arguments) => brown_out(arguments, as_json),
        Setting::ClearFaults(arguments) => clear_faults(arguments, as_json),
    }
}

fn clear_faults(arguments: &ClearFaultsArguments, as_json: bool) -> Result<(), Failure> {
    let port = arguments.port.port()?;
    let device = Device::observe(&port, arguments.port.rig(None)?.as_ref())?;
    device.clear_faults()?;
    let value = json!({ "port": port.to_string() });
    output::print(as_json, &value, |out| writeln!(out, "The device has no latched fault."))
}

fn brown_out(arguments: &BrownOutArguments, as_json: bool) -> Result<(), Failure> {
    let port = arguments.port.port()?;
    let device = Device::observe(&port, arguments.port.rig(None)?.as_ref())?;
    device.identity()?;
    let mut level = device.brown_out_level()?;
    if arguments.set && level.level < level.needed {
        if !arguments.power_is_safe {
            ask()?;
        }
        device.disarm()?;
        level = device.raise_brown_out_level(&port)?;
    }
    output::print(as_json, &json!(BrownOutAnswer::of(&level)), |out| writeln!(out, "{}", sentence(&level)))
}

/// Asks the user whether the board's power is safe, on a terminal.
fn ask() -> Result<(), Failure> {
    output::note(upkeep::OPTION_BYTES_RISK);
    if !io::stdin().is_terminal() {
        return Err(Failure::usage(
            "--set asks whether the board's power is safe, and standard input is no terminal: add --power-is-safe",
        ));
    }
    output::note("Hold the board's user button. Is its power safe? Type yes to write.");
    let mut answer = String::new();
    io::stdin().read_line(&mut answer).map_err(Failure::failed)?;
    if answer.trim() == "yes" { Ok(()) } else { Err(Failure::Failed("nothing was written".to_owned())) }
}

fn sentence(BrownOut { level, needed, restarts, .. }: &BrownOut) -> String {
    if *restarts {
        format!(
            "The brown-out level is {level} now, and compared after the restart: nothing else of the option bytes has changed."
        )
    } else if level >= needed {
        format!("The brown-out level is {level}: set. The board needs {needed}.")
    } else {
        format!("The brown-out level is {level}: not set. The board needs {needed}; add --set.")
    }
}
