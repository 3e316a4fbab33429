//! `slipline serve`: offers the simulated device to other programs, in real time.

use super::{Failure, ServeArguments};

/// Serves until the program is told to end.
#[cfg(unix)]
pub(super) fn run(arguments: &ServeArguments, as_json: bool) -> Result<(), Failure> {
    use super::output;
    use crate::signals;
    use serde_json::json;
    use slipline_link::native::{Server, system_clock};
    use slipline_link::simulator::SimulatedDevice;
    use slipline_link::simulator::realtime::RealtimeDevice;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::{Arc, Mutex, PoisonError};

    let options = options(arguments.plate.as_deref())?;
    let mut server = match &arguments.socket {
        Some(path) => Server::at_socket(path),
        None => Server::at_terminal(),
    }
    .map_err(Failure::failed)?;
    let ended = Arc::new(AtomicBool::new(false));
    let is_ended = Arc::clone(&ended);
    let _closing = signals::end_by(move || is_ended.store(true, Ordering::Relaxed));
    let path = server.path().display().to_string();
    let port = if arguments.socket.is_some() { format!("unix:{path}") } else { path.clone() };
    output::print(as_json, &json!({ "path": path, "port": port }), |out| {
        writeln!(out, "The simulated device is at {path}, for Slipline --port {port}. Ctrl-C ends it.")?;
        writeln!(out, "Enter raises its trigger input.")
    })?;
    let device = RealtimeDevice::new(SimulatedDevice::new(options), system_clock());
    let device = Arc::new(Mutex::new(device));
    let triggered = Arc::clone(&device);
    // It ends with the input, or with the program.
    std::thread::spawn(move || {
        for _line in std::io::stdin().lines().map_while(Result::ok) {
            triggered.lock().unwrap_or_else(PoisonError::into_inner).raise_trigger();
        }
    });
    server.serve(device, &ended).map_err(Failure::failed)
}

/// A device that holds a plate's table in its flash, if a plate is named.
#[cfg(unix)]
fn options(plate: Option<&str>) -> Result<slipline_link::simulator::Options, Failure> {
    use super::{argument, progress};
    use slipline_link::Request;
    use slipline_link::simulator::Options;
    use slipline_link::simulator::loopback::Loopback;

    let Some(plate) = plate else { return Ok(Options::default()) };
    let rate_hz = Options::default().sample_rate_hz;
    let (_, table) = progress::table_for(&argument::plate(plate)?, rate_hz)?;
    let mut loopback = Loopback::connect(rate_hz).map_err(Failure::failed)?;
    loopback.perform(Request::Upload(table), |_| ()).map_err(Failure::failed)?;
    // An armed device does not write its flash.
    loopback.perform(Request::Disarm, |_| ()).map_err(Failure::failed)?;
    loopback.perform(Request::Store, |_| ()).map_err(Failure::failed)?;
    Ok(Options { flash: loopback.flash(), ..Options::default() })
}

/// Tells that this system has neither.
#[cfg(not(unix))]
pub(super) fn run(_arguments: &ServeArguments, _as_json: bool) -> Result<(), Failure> {
    Err(Failure::Failed("serve needs a Unix socket or a pseudo-terminal; this system has neither".to_owned()))
}
