//! `slipline serve`: offers the simulated device to other programs, in real time.

use super::argument::Typed;
use super::destination::ForceArgument;
use super::failure::Failure;
#[cfg(unix)]
use super::rig::{actual_plate, prepared};
use super::{argument, measured_file};
use clap::Args;
#[cfg(unix)]
use slipline_instrument::rig::{PreparedRig, RigOptions};
#[cfg(unix)]
use slipline_model::atomic_file::said;
#[cfg(unix)]
use slipline_plate::Plate;
use slipline_plate::calibrate::SensorKind;
use std::path::PathBuf;

/// `serve`.
#[derive(Debug, Args)]
pub struct ServeArguments {
    /// Serve at this Unix socket. A file of another kind is not replaced.
    #[arg(long, value_name = "PATH", required_unless_present = "pty", conflicts_with = "pty")]
    socket: Option<PathBuf>,
    /// Serve at a pseudo-terminal, which other programs open as a serial port; its path is printed.
    #[arg(long)]
    pty: bool,
    /// The device holds this plate's table from the start.
    #[arg(long, value_name = "PLATE")]
    plate: Option<String>,
    /// The device drives this plate and measures it: its first input is a sensor at this place, from the
    /// driven end (30mm), its second the drive's current.
    #[arg(long, value_name = "PLACE", value_parser = argument::place, allow_hyphen_values = true, requires = "plate")]
    sensor: Option<Typed<f64>>,
    /// What the sensor measures: displacement, velocity, acceleration or strain.
    #[arg(long, value_name = "KIND", value_parser = measured_file::kind, default_value = "displacement", requires = "sensor")]
    kind: SensorKind,
    /// The actual plate, if it differs from the plate of --plate: a preset's name, a TOML file, or
    /// secret:SEED (a plate near it: wave speed within 5 %, 0.5 to 2.5 times the loss).
    #[arg(long, value_name = "TRUTH", requires = "sensor")]
    actual_plate: Option<String>,
    // For the trace, which main writes.
    #[command(flatten)]
    force: ForceArgument,
}

/// Serves until the program is interrupted.
#[cfg(unix)]
pub(super) fn run(arguments: &ServeArguments, as_json: bool) -> Result<(), Failure> {
    use super::output;
    use crate::signals;
    use serde_json::json;
    use slipline_link::native::{Server, system_clock};
    use slipline_link::simulator::realtime::RealtimeDevice;
    use slipline_link::simulator::{Options, SimulatedDevice};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Arc, Mutex, PoisonError};

    let plate = arguments.plate.as_deref().map(argument::plate).transpose()?;
    let simulated = match (&plate, &arguments.sensor) {
        (Some(plate), Some(sensor)) => {
            SimulatedDevice::with_inputs(options(plate)?, rig(arguments, plate, sensor)?.inputs())
        }
        (Some(plate), None) => SimulatedDevice::new(options(plate)?),
        (None, _) => SimulatedDevice::new(Options::default()),
    };
    let mut server = match &arguments.socket {
        Some(path) => Server::at_socket(path),
        None => Server::at_terminal(),
    }
    .map_err(Failure::failed)?;
    let ended = Arc::new(AtomicBool::new(false));
    let is_ended = Arc::clone(&ended);
    let _closing = signals::end_normally_by(move || is_ended.store(true, Ordering::Relaxed));
    let path = server.path().display().to_string();
    let port = if arguments.socket.is_some() { format!("unix:{path}") } else { path.clone() };
    // JSON `path`, text: Socket or pseudo-terminal
    output::print(as_json, &json!({ "path": path, "port": port }), |out| {
        writeln!(out, "The simulated device is at {path}, for Slipline --port {port}. Ctrl-C ends it.")?;
        writeln!(
            out,
            "Enter raises its trigger input; the lines press and release are its user button, open and close its stop input."
        )
    })?;
    let device = RealtimeDevice::new(simulated, system_clock());
    let device = Arc::new(Mutex::new(device));
    let triggered = Arc::clone(&device);
    // It ends with the input or with the program.
    let follow = move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            let mut device = triggered.lock().unwrap_or_else(PoisonError::into_inner);
            match line.trim() {
                "press" => device.press_button(true),
                "release" => device.press_button(false),
                "open" => device.open_stop_input(true),
                "close" => device.open_stop_input(false),
                _ => device.raise_trigger(),
            }
        }
    };
    std::thread::Builder::new().spawn(follow).map_err(|error| Failure::Failed(said(&error)))?;
    server.serve(device, &ended).map_err(|error| Failure::Failed(said(&error)))
}

/// The plate under the device, and a sensor on it.
#[cfg(unix)]
fn rig(arguments: &ServeArguments, plate: &Plate, sensor: &Typed<f64>) -> Result<PreparedRig, Failure> {
    let truth = arguments.actual_plate.as_deref().map(|text| actual_plate(text, Some(plate))).transpose()?;
    let place_m = sensor.of_sensor(plate)?;
    let options = RigOptions { place_m, sensor: arguments.kind, ..RigOptions::default() };
    prepared(truth.as_ref().unwrap_or(plate), &options)
}

/// Options of a device that holds a plate's table in its flash.
#[cfg(unix)]
fn options(plate: &Plate) -> Result<slipline_link::simulator::Options, Failure> {
    use super::progress;
    use slipline_link::simulator::Options;
    use slipline_link::simulator::loopback::Loopback;

    let rate_hz = Options::default().sample_rate_hz;
    let (_, table) = progress::table_for(plate, rate_hz)?;
    let mut loopback = Loopback::connect(rate_hz).map_err(Failure::failed)?;
    loopback.use_table(table).map_err(Failure::failed)?;
    loopback.store().map_err(Failure::failed)?;
    Ok(Options { flash: loopback.flash(), ..Options::default() })
}

/// Fails: this system has neither sockets nor pseudo-terminals.
#[cfg(not(unix))]
pub(super) fn run(_arguments: &ServeArguments, _as_json: bool) -> Result<(), Failure> {
    Err(Failure::failed("serve needs a Unix socket or a pseudo-terminal; this system has neither"))
}
