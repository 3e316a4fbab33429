//! `slipline verify`: checks that the device sends exactly the codes of the mirror.
//!
//! In each stage the device computes a CRC-32 of a future window of its codes, a request changes the drive
//! within the window, and the mirror renders the same window from the changes that the device acknowledged.
//! Equal digests mean equal codes, on any board.

use super::device::Device;
use super::{Failure, VerifyArguments, argument, output};
use serde_json::{Value, json};
use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::protocol::command::DigestWindow;
use slipline_link::protocol::event::Digest;
use slipline_link::protocol::frame::CRC;
use slipline_link::protocol::limits::MAX_DIGEST_SAMPLES;
use slipline_link::{DriveRequest, Snapshot, Sounding, ToneRequest};
use slipline_plate::quantity::{Measure, Range};
use std::sync::Arc;
use std::time::Duration;

/// Time from the request to the window, in seconds, so that the command arrives before it over the slowest
/// link.
const AHEAD_S: f64 = 0.1;
/// Time after which a stop has ramped down and the table has been taken up.
const REST: Duration = Duration::from_millis(100);

/// Latest time of a window's digest after the window's end, over the slowest link, in seconds.
const KEPT_BEHIND_S: f64 = 5.0;

/// The change within a window.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// The tones start from silence.
    Start,
    /// They continue.
    Steady,
    /// They glide to other places, three times.
    Drag,
    /// They ramp to silence.
    Stop,
}

impl Stage {
    const ALL: [Self; 4] = [Self::Start, Self::Steady, Self::Drag, Self::Stop];

    const fn name(self) -> &'static str {
        match self {
            Self::Start => "start from silence",
            Self::Steady => "steady tones",
            Self::Drag => "drag",
            Self::Stop => "stop",
        }
    }
}

struct Compared {
    stage: Stage,
    digest: Digest,
    mirror: u32,
}

impl Compared {
    fn is_equal(&self) -> bool {
        self.digest.crc == Some(self.mirror)
    }
}

pub(super) fn run(arguments: &VerifyArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate(&arguments.plate)?;
    let count = u8::try_from(arguments.tones).map_err(Failure::refused)?;
    let port = &arguments.port.port;
    let device = Device::connect(port, arguments.port.rig(Some(&plate))?.as_ref())?;
    device.may_be_armed(&arguments.arming)?;
    let rate = f64::from(device.identity()?.sample_rate_hz);
    let longest_s = f64::from(MAX_DIGEST_SAMPLES) / rate;
    let windows = Range::new(0.01, longest_s, "s");
    let window_s = arguments.window.within("--window", windows, Measure::Time, "")?;
    device.use_table(&plate)?;
    device.arm()?;
    device.pause(REST);

    let mut replay = Replay::new(((window_s + KEPT_BEHIND_S) * rate) as usize);
    follow(&device, &mut replay)?;
    let mut compared = Vec::new();
    for stage in Stage::ALL {
        let from = device.refresh()? + (AHEAD_S * rate) as u64;
        let window = DigestWindow { from, count: (window_s * rate) as u32 };
        let patience = Duration::from_secs_f64(5.0 + 2.0 * window_s);
        let digest = device.digest(window, patience, || {
            // Until the window has begun.
            device.pause(Duration::from_secs_f64(AHEAD_S + 0.1 * window_s));
            act(stage, &device, &plate, count, window_s)
        })?;
        let mirror = mirror_digest(&device, &mut replay, window)?;
        compared.push(Compared { stage, digest, mirror });
    }
    device.stop()?;
    report(port.to_string(), &compared, as_json)?;
    if compared.iter().all(Compared::is_equal) {
        Ok(())
    } else {
        Err(Failure::Failed("the device's codes differ from the mirror's".to_owned()))
    }
}

fn act(
    stage: Stage,
    device: &Device,
    plate: &slipline_plate::Plate,
    count: u8,
    window_s: f64,
) -> Result<(), Failure> {
    let (start_m, end_m) = plate.span_m();
    let drive = |shift: f64| {
        let tones = (0..count)
            .map(|slot| {
                let share = 0.05 + 0.8 * f64::from(slot) / f64::from(count) + 0.1 * shift;
                ToneRequest {
                    slot,
                    boundary_m: start_m + share * (end_m - start_m),
                    level: 0.9 / f64::from(count),
                    phase_turns: f64::from(slot) / f64::from(count),
                }
            })
            .collect();
        device.play(Sounding::Drive(DriveRequest::of(tones)))
    };
    match stage {
        Stage::Start => drop(drive(0.0)?),
        Stage::Steady => {}
        Stage::Drag => {
            for shift in [1.0, 0.3, 0.7] {
                drive(shift)?;
                device.pause(Duration::from_secs_f64(0.1 * window_s));
            }
        }
        Stage::Stop => drop(device.stop()?),
    }
    Ok(())
}

/// The CRC-32 of a past window, from the changes that the device has accepted.
fn mirror_digest(device: &Device, replay: &mut Replay, window: DigestWindow) -> Result<u32, Failure> {
    // The status after the window contains the thermal fold-back up to its end.
    device.refresh()?;
    let snapshot = follow(device, replay)?;
    let crc = device.during(|| {
        replay.exact_codes(window.from, window.count).map(|codes| {
            let mut crc = CRC.digest();
            codes.for_each(|code| crc.update(&code.to_le_bytes()));
            crc.finalize()
        })
    });
    crc.ok_or_else(|| {
        let fault = snapshot.status.and_then(|status| status.first_fault);
        Failure::Failed(fault.map_or_else(
            || {
                "not every change in the window reached this program, so its codes cannot be compared"
                    .to_owned()
            },
            |fault| {
                format!("the device stopped by itself, so its codes cannot be compared: {}", fault.text())
            },
        ))
    })
}

fn follow(device: &Device, replay: &mut Replay) -> Result<Arc<Snapshot>, Failure> {
    let snapshot = device.snapshot();
    let history = DeviceHistory::of(&snapshot);
    let history = history.ok_or_else(|| Failure::Failed("the device went away".to_owned()))?;
    device.during(|| replay.follow(&history));
    Ok(snapshot)
}

fn report(port: String, compared: &[Compared], as_json: bool) -> Result<(), Failure> {
    let windows: Vec<Value> = compared
        .iter()
        .map(|it| {
            json!({
                "stage": it.stage.name(),
                "at_samples": it.digest.from,
                "samples": it.digest.count,
                "device_crc": it.digest.crc.map(|crc| format!("{crc:08x}")),
                "mirror_crc": format!("{:08x}", it.mirror),
                "equal": it.is_equal(),
            })
        })
        .collect();
    let value = json!({ "port": port, "equal": compared.iter().all(Compared::is_equal), "windows": windows });
    output::print(as_json, &value, |out| {
        let header = ["Stage", "From sample", "Samples", "Device", "Mirror", ""].map(str::to_owned).to_vec();
        let rows = compared.iter().map(|it| {
            vec![
                it.stage.name().to_owned(),
                it.digest.from.to_string(),
                it.digest.count.to_string(),
                it.digest.crc.map_or_else(|| "none".to_owned(), |crc| format!("{crc:08x}")),
                format!("{:08x}", it.mirror),
                if it.is_equal() { "equal" } else { "DIFFERENT" }.to_owned(),
            ]
        });
        output::table(out, &std::iter::once(header).chain(rows).collect::<Vec<_>>())
    })
}
