//! `slipline drive`.

use super::device::Device;
use super::{DriveArguments, Failure, argument, output};
use crate::signals;
use serde_json::json;
use slipline_link::protocol::event::Fault;
use slipline_link::{DriveRequest, LinkState, Request};
use slipline_plate::quantity::{show_frequency, show_place};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time between two checks of the device's state.
const GLANCE: Duration = Duration::from_millis(100);

pub(super) fn run(arguments: &DriveArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate(&arguments.plate.plate)?;
    let tones = arguments.tones.on(&plate)?;
    let (duration_s, glide_s) = (arguments.duration, arguments.glide);
    let port = &arguments.port.port;

    let device = Device::connect(port)?;
    device.may_be_armed(&arguments.arming)?;
    if arguments.clear_faults {
        device.perform(Request::ClearFaults)?;
    }
    let table = device.use_table(&plate)?;
    table.check_sum(&tones).map_err(Failure::usage)?;
    device.arm()?;
    let request = DriveRequest { glide_s, ..DriveRequest::at(&tones) };
    let at = device.perform_at(Request::Drive(request))?;

    let played: Vec<(f64, f64, f64)> = tones
        .iter()
        .filter_map(|&(boundary_m, level)| {
            Some((boundary_m, level, table.frequency_hz(table.position(boundary_m)?)))
        })
        .collect();
    if !as_json {
        output::print(false, &json!(null), |out| {
            for (boundary_m, level, hz) in &played {
                let (place, frequency) = (show_place(*boundary_m), show_frequency(*hz));
                writeln!(out, "Boundary at {place}: {frequency}, level {level}.")?;
            }
            match duration_s {
                Some(seconds) => writeln!(out, "Driving for {seconds} s."),
                None => {
                    let most = Fault::DriveTime.text();
                    writeln!(out, "Driving until Ctrl-C; the device stops by itself after {most}.")
                }
            }
        })?;
    }
    let driven_s = hold(&device, duration_s)?;
    let stopped_at = device.perform_at(Request::Stop)?;
    let value = json!({
        "port": port.to_string(),
        "plate": plate.name(),
        "at_samples": at,
        "stopped_at_samples": stopped_at,
        "driven_s": driven_s,
        "tones": played.iter().map(|&(boundary_m, level, frequency_hz)| json!({
            "boundary_m": boundary_m, "level": level, "frequency_hz": frequency_hz,
        })).collect::<Vec<_>>(),
        "table_crc": format!("{:08x}", table.crc()),
        "clipped_samples": device.snapshot().status.map(|status| status.counters.clips),
    });
    output::print(as_json, &value, |out| writeln!(out, "Stopped."))
}

/// Waits until the time is over or the user interrupts; returns the driven time in seconds.
fn hold(device: &Device, duration_s: Option<f64>) -> Result<f64, Failure> {
    let (interrupted, interruption) = channel();
    let stop = device.handle();
    let _closing = signals::end_by(move || {
        // Sent at once, before waiting for anything.
        stop.send(Request::Stop);
        let _ = interrupted.send(());
    });
    let begin = Instant::now();
    loop {
        let left = duration_s.map(|s| Duration::from_secs_f64(s).saturating_sub(begin.elapsed()));
        if left.is_some_and(|left| left.is_zero()) {
            return Ok(begin.elapsed().as_secs_f64());
        }
        match interruption.recv_timeout(left.unwrap_or(GLANCE).min(GLANCE)) {
            Ok(()) => return Ok(begin.elapsed().as_secs_f64()),
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(GLANCE),
            Err(RecvTimeoutError::Timeout) => {}
        }
        device.sign_of_life();
        device.check_attended()?;
        let snapshot = device.snapshot();
        if let LinkState::Lost(trouble) = &snapshot.link {
            return Err(Failure::Failed(trouble.to_string()));
        }
        if let Some(status) = snapshot.status.filter(|status| !status.faults.is_empty()) {
            return Err(Failure::Failed(format!("the device stopped: {}", status.faults)));
        }
    }
}
