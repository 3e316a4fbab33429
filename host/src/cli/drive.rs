//! `slipline drive`.

use super::device::{Device, LoadedDevice};
use super::feeling::NamedFeeling;
use super::hold::Holder;
use super::tones::AskedTones;
use super::{Begin, DriveArguments, Failure, argument, known_drive, output, progress, tones};
use crate::signals::{self, Signal};
use serde_json::json;
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::event::Fault;
use slipline_link::protocol::limits::LEASE_MS;
use slipline_link::{DriveRequest, LinkState, Snapshot, Sounding};
use slipline_model::atomic_file::{read_text, said};
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::file::{self, Opened};
use slipline_model::setup::{Setup, edit};
use slipline_model::texture::{self, chord_of};
use slipline_plate::{DriveTable, Plate};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time between two checks of the device's state.
const GLANCE: Duration = Duration::from_millis(100);

pub(super) fn run(arguments: &DriveArguments, as_json: bool) -> Result<(), Failure> {
    let wanted = Wanted::of(arguments)?;
    let duration_s = arguments.duration;
    let port = &arguments.port.port;
    let rig = arguments.hold.rig(&arguments.port, &wanted.plate)?;
    let mut made = progress::table_for(&wanted.plate, SAMPLE_RATE_HZ)?;
    let mut setup = wanted.setup(&made.0, arguments.glide)?;

    let device = Device::connect(port, rig.as_ref())?;
    device.may_be_armed(&arguments.arming)?;
    let rate_hz = device.identity()?.sample_rate_hz;
    if rate_hz != SAMPLE_RATE_HZ {
        made = device.during(|| progress::table_for(&wanted.plate, rate_hz))?;
        setup = wanted.setup(&made.0, arguments.glide)?;
    }
    let (plate_table, table) = made;
    let request = edit::drive(&setup);
    let sounding = if wanted.is_of_file() {
        let snapshot = device.snapshot();
        let chord = chord_of(&setup, &table);
        device.during(|| texture::sounding(&setup, chord, &table, &snapshot)).map_err(Failure::usage)?
    } else {
        Sounding::Drive(request.clone())
    };
    let is_chord = matches!(sounding, Sounding::Chord(_));
    let gain_db = setup.chord_gain_db.filter(|_| is_chord);
    let places = TonePlaces::of_setup(&Setup { chord_gain_db: gain_db, ..setup }, &plate_table);
    if !is_chord {
        table.check_sum(&at_master_level(&request)).map_err(Failure::usage)?;
    }
    if arguments.clear_faults {
        device.clear_faults()?;
    }
    let bench = LoadedDevice::with(&device, &wanted.plate, table)?;
    let table = &bench.table;
    let mut holder = arguments.hold.holder(&device, &wanted.plate, table, &request)?;
    known_drive::check(&bench, arguments.known.known(None))?;
    device.arm_for(lease(arguments))?;
    let apply = match arguments.at {
        Begin::Now => Apply::Next,
        Begin::Trigger => Apply::AtTrigger,
    };
    let at = device.play(sounding.beginning(apply))?;
    // Registered before the message that Ctrl-C ends the drive.
    let (interrupted, interruption) = channel();
    let stop = device.stopper();
    let _closing = signals::end_by(move || {
        // Sent at once, without waiting.
        stop();
        let _ = interrupted.send(());
    });

    let played: Vec<(&TonePlaces, f64)> = places
        .iter()
        .filter_map(|tone| Some((tone, table.frequency_hz(table.position(tone.turning_point_m)?))))
        .collect();
    if !as_json {
        output::print(false, &json!(null), |out| {
            for (tone, frequency_hz) in &played {
                writeln!(out, "{}", tones::words(tone, *frequency_hz))?;
            }
            writeln!(out, "{}", wanted.feeling.words())?;
            if let Some(gain_db) = gain_db {
                writeln!(out, "As a chord, {gain_db:.1} dB above the setup's levels.")?;
            }
            if arguments.at == Begin::Trigger {
                writeln!(out, "Waiting for the trigger.")?;
            }
            match duration_s {
                Some(seconds) => writeln!(out, "Driving for {seconds} s."),
                None => {
                    let most = device.snapshot().fault_text(Fault::DriveTime);
                    writeln!(out, "Driving until Ctrl-C; the device stops by itself after {most}.")
                }
            }
        })?;
    }
    let began = match arguments.at {
        Begin::Now => Some((at, Instant::now())),
        Begin::Trigger => wait_for_trigger(&device, &interruption, at)?,
    };
    if let Some((at, _)) = began.filter(|_| !as_json && arguments.at == Begin::Trigger) {
        output::print(false, &json!(null), |out| writeln!(out, "Began at sample {at}."))?;
    }
    let driven_s = match began {
        Some((at, begin)) => {
            let goes_on = match &mut holder {
                Some(holder) => holder.begin(&device, &interruption, at)?,
                None => true,
            };
            let each = |snapshot: &Snapshot| match &mut holder {
                Some(holder) => holder.watch(snapshot, as_json),
                None => Ok(()),
            };
            if goes_on {
                hold(&device, &interruption, begin, duration_s, each)?
            } else {
                begin.elapsed().as_secs_f64()
            }
        }
        None => 0.0,
    };
    let stopped_at = device.stop()?;
    let hold = holder.as_ref().map(Holder::value);
    let clipped_samples = device.snapshot().status.map(|status| status.counters.clips);
    // Before anything is written, because the reader of the output may be slow.
    device.disarm()?;
    let ended_by = signals::ended_by();
    let value = json!({
        "port": port.to_string(),
        "plate": wanted.plate.name(),
        "at_samples": began.map(|(at, _)| at),
        "stopped_at_samples": stopped_at,
        "driven_s": driven_s,
        "ended_by": ended_by.map_or("time", Signal::name),
        "feeling": wanted.feeling.value(),
        "tones": played.iter().map(|(tone, frequency_hz)| tones::value(tone, *frequency_hz)).collect::<Vec<_>>(),
        "chord_gain_db": gain_db,
        "hold": hold,
        "table_crc": format!("{:08x}", table.crc()),
        "clipped_samples": clipped_samples,
    });
    output::print(as_json, &value, |out| match ended_by {
        Some(signal) => writeln!(out, "Stopped by {} after {driven_s:.3} s.", signal.name()),
        None => writeln!(out, "Stopped."),
    })
}

/// The lease of the drive: as long as it lasts and ten seconds more. What waits for the trigger may wait for any time.
fn lease(arguments: &DriveArguments) -> Option<Duration> {
    let longest_s = f64::from(LEASE_MS.1) / 1e3;
    let lease_s = arguments.duration.map_or(longest_s, |duration_s| (duration_s + 10.0).min(longest_s));
    (arguments.at == Begin::Now).then(|| Duration::from_secs_f64(lease_s))
}

/// The plate, and what is to sound on it.
struct Wanted {
    plate: Arc<Plate>,
    feeling: NamedFeeling,
    sounds: Sounds,
}

/// What is to sound: a setup of a file, or tones.
enum Sounds {
    Setup(Box<Setup>),
    Tones(AskedTones),
}

impl Wanted {
    fn of(arguments: &DriveArguments) -> Result<Self, Failure> {
        let Some(path) = &arguments.setup else {
            let plate = Arc::new(argument::plate(arguments.plate.as_deref().unwrap_or_default())?);
            let asked = arguments.tones.on(&plate)?;
            return Ok(Self { plate, feeling: asked.feeling.clone(), sounds: Sounds::Tones(asked) });
        };
        let refused = |message: String| Failure::Usage(format!("{}: {message}", path.display()));
        let text = read_text(path, file::FILE_BYTES_MAX).map_err(|error| refused(said(&error)))?;
        match file::read(&text).map_err(|error| refused(error.to_string()))? {
            Opened::Setup(setup) => Ok(Self {
                plate: Arc::clone(&setup.plate),
                feeling: NamedFeeling::of_setup(&setup, path),
                sounds: Sounds::Setup(setup),
            }),
            Opened::Plate(_) => Err(refused(
                "a plate alone: drive it with --plate and --felt-edge or --turning-point".to_owned(),
            )),
        }
    }

    /// Whether it is a setup of a file.
    const fn is_of_file(&self) -> bool {
        matches!(self.sounds, Sounds::Setup(_))
    }

    /// The setup that sounds; `table` is that of the plate. Tones on the command line glide for `glide_s`.
    fn setup(&self, table: &DriveTable, glide_s: f64) -> Result<Setup, Failure> {
        match &self.sounds {
            Sounds::Setup(setup) => Ok((**setup).clone()),
            Sounds::Tones(asked) => Ok(Setup { glide_s, ..asked.setup(&self.plate, table)? }),
        }
    }
}

/// The tones of a drive as (turning point in metres, level at the drive's master level).
fn at_master_level(request: &DriveRequest) -> Vec<(f64, f64)> {
    let master = 10.0_f64.powf(request.master_db / 20.0);
    request.tones.iter().map(|tone| (tone.boundary_m, tone.level * master)).collect()
}

/// Waits until the drive has begun after a trigger that counts from this sample index; returns the index and
/// time of its beginning, or `None` if the user interrupts.
fn wait_for_trigger(
    device: &Device,
    interruption: &Receiver<()>,
    from: u64,
) -> Result<Option<(u64, Instant)>, Failure> {
    let rate_hz = f64::from(device.identity()?.sample_rate_hz);
    let report = |snapshot: &Snapshot| snapshot.trigger.filter(|report| !report.waits);
    let is_over = watch(device, interruption, |snapshot| {
        Ok(if report(snapshot).is_some() { Duration::ZERO } else { GLANCE })
    })?;
    if !is_over {
        return Ok(None);
    }
    let snapshot = device.snapshot();
    let began = report(&snapshot).and_then(|report| report.began).filter(|&began| began > from);
    let began =
        began.ok_or_else(|| Failure::Failed("the device dropped the drive before the trigger".to_owned()))?;
    let now = snapshot.status.map_or(began, |status| status.now);
    let since = Duration::from_secs_f64(now.saturating_sub(began) as f64 / rate_hz);
    Ok(Some((began, Instant::now().checked_sub(since).unwrap_or_else(Instant::now))))
}

/// Waits until the time since `begin` is over or the user interrupts, and calls `each` at every check;
/// returns the driven time in seconds.
fn hold(
    device: &Device,
    interruption: &Receiver<()>,
    begin: Instant,
    duration_s: Option<f64>,
    mut each: impl FnMut(&Snapshot) -> Result<(), Failure>,
) -> Result<f64, Failure> {
    let duration = duration_s.map(Duration::from_secs_f64);
    watch(device, interruption, |snapshot| {
        each(snapshot)?;
        Ok(duration.map_or(GLANCE, |duration| duration.saturating_sub(begin.elapsed())))
    })?;
    Ok(begin.elapsed().as_secs_f64())
}

/// Waits until no time is `left` or the user interrupts, and checks the device meanwhile; returns whether the
/// time is over.
fn watch(
    device: &Device,
    interruption: &Receiver<()>,
    mut left: impl FnMut(&Snapshot) -> Result<Duration, Failure>,
) -> Result<bool, Failure> {
    loop {
        // Checked first, so that a drive that failed is not reported as complete.
        check(device)?;
        let left = left(&device.snapshot())?;
        if left.is_zero() {
            return Ok(true);
        }
        match interruption.recv_timeout(left.min(GLANCE)) {
            Ok(()) => return Ok(device.check_attended().map(|()| false)?),
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(GLANCE),
            Err(RecvTimeoutError::Timeout) => {}
        }
        device.sign_of_life();
    }
}

/// Fails if the device no longer carries out the drive.
fn check(device: &Device) -> Result<(), Failure> {
    device.check_attended()?;
    let snapshot = device.snapshot();
    if let LinkState::Lost(trouble) = &snapshot.link {
        return Err(Failure::Failed(trouble.to_string()));
    }
    match snapshot.status.filter(|status| !status.faults.is_empty()) {
        Some(status) => {
            let faults = snapshot.faults_text(status.faults);
            Err(Failure::Failed(format!("the device stopped: {faults}")))
        }
        None => Ok(()),
    }
}
