//! `slipline drive`.

use super::device::{Device, LoadedDevice};
use super::followed_drive::FollowedDrive;
use super::hold::Holder;
use super::input_lines::{InputLines, Wake};
use super::{Begin, DriveArguments, Failure, known_drive, output, progress, source, tones};
use crate::signals::{self, Signal};
use serde_json::json;
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::event::Fault;
use slipline_link::protocol::limits::LEASE_MS;
use slipline_link::{Snapshot, Sounding, TriggerOutcome};
use slipline_model::answer::ToneAnswer;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::{Setup, edit};
use slipline_plate::DriveTable;
use slipline_plate::number_format::rounded;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time between two checks of the device's state.
const GLANCE: Duration = Duration::from_millis(100);

pub(super) fn run(arguments: &DriveArguments, as_json: bool) -> Result<(), Failure> {
    let wanted = arguments.sounds.read()?;
    if arguments.stdin && source::is_standard_input_taken() {
        let why = "--stdin follows standard input, which is a file of this command already";
        return Err(Failure::Usage(why.to_owned()));
    }
    let duration_s = arguments.duration;
    let port = &arguments.port.port;
    let rig = arguments.hold.rig(&arguments.port, &wanted.plate)?;
    let setup = |table: &DriveTable| -> Result<Setup, Failure> {
        let setup = wanted.setup(table)?;
        let glide_s = if wanted.is_of_file() { setup.glide_s } else { arguments.glide };
        Ok(Setup { glide_s, ..setup })
    };
    let mut made = progress::table_for(&wanted.plate, SAMPLE_RATE_HZ)?;
    let mut wanted_setup = setup(&made.0)?;

    let device = Device::connect(port, rig.as_ref())?;
    device.may_be_armed(&arguments.arming)?;
    if arguments.at == Begin::Trigger && device.snapshot().has_trigger_input() == Some(false) {
        let why = "the device has no trigger input: it can begin with --at now only";
        return Err(Failure::Failed(why.to_owned()));
    }
    let rate_hz = device.identity()?.sample_rate_hz;
    if rate_hz != SAMPLE_RATE_HZ {
        made = device.during(|| progress::table_for(&wanted.plate, rate_hz))?;
        wanted_setup = setup(&made.0)?;
    }
    let (plate_table, table) = made;
    let setup = wanted_setup;
    let snapshot = device.snapshot();
    let sounding = device.during(|| wanted.sounding(&setup, &table, &snapshot))?;
    if arguments.stdin && matches!(sounding, Sounding::Chord(_)) {
        let why = "--stdin: the setup is a chord, whose tones stand still; drive it without --stdin";
        return Err(Failure::Usage(why.to_owned()));
    }
    let (places, gain_db) = TonePlaces::as_played(setup.clone(), Some(&sounding), &plate_table);
    if arguments.clear_faults {
        device.clear_faults()?;
    }
    let bench = LoadedDevice::with(&device, &wanted.plate, table)?;
    let table = &bench.table;
    let mut holder = arguments.hold.holder(&device, &wanted.plate, table, &edit::drive(&setup))?;
    known_drive::check(&bench, arguments.known.stated()?)?;
    device.arm_for(lease(arguments))?;
    let apply = match arguments.at {
        Begin::Now => Apply::Next,
        Begin::Trigger => Apply::AtTrigger,
    };
    let at = device.play(sounding.beginning(apply))?;
    // Registered before the message that Ctrl-C ends the drive.
    let (wakes, interruption) = channel();
    let (stop, interrupted) = (device.stopper(), wakes.clone());
    let _closing = signals::end_by(move || {
        // Sent at once, without waiting.
        stop();
        let _ = interrupted.send(Wake::Signal);
    });

    let played: Vec<(&TonePlaces, f64)> = TonePlaces::on_device(&places, table).collect();
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
            if arguments.stdin {
                writeln!(out, "Lines of standard input change the drive, and their end stops it.")?;
            }
            match duration_s {
                Some(seconds) => writeln!(out, "Driving for {} s.", rounded(seconds, 3)),
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
    let pair = (&plate_table, &**table);
    let mut followed = FollowedDrive::new(&device, pair, wanted.asked(), setup, as_json);
    let mut end = End::Time;
    let driven_s = match began {
        Some((at, begin)) => {
            let lines = arguments.stdin.then(|| InputLines::begin(wakes));
            let mut follow = |wake: Wake| {
                end = match wake {
                    Wake::Signal => return Ok(false),
                    Wake::End(None) => End::Input,
                    Wake::End(Some(why)) => return Err(Failure::Failed(format!("standard input: {why}"))),
                    Wake::Line(line) if followed.follow(&line)? => {
                        lines.iter().for_each(InputLines::ask);
                        return Ok(true);
                    }
                    Wake::Line(_) => End::Line,
                };
                Ok(false)
            };
            let goes_on = match &mut holder {
                Some(holder) => holder.begin(&device, &interruption, at)?,
                None => true,
            };
            let each = |snapshot: &Snapshot| match &mut holder {
                Some(holder) => holder.watch(snapshot, as_json),
                None => Ok(()),
            };
            if goes_on {
                hold(&device, (&interruption, &mut follow), begin, duration_s, each)?
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
    let ended_by = signals::ended_by().map_or(end.name(), Signal::name);
    let at_the_end = followed.places();
    let played: Vec<_> = match &at_the_end {
        Some(places) => TonePlaces::on_device(places, table).collect(),
        None => played,
    };
    let value = json!({
        "port": port.to_string(),
        "plate": wanted.plate.name(),
        "at_samples": began.map(|(at, _)| at),
        "stopped_at_samples": stopped_at,
        "driven_s": driven_s,
        "ended_by": ended_by,
        "feeling": wanted.feeling.answer(),
        "tones": played.iter().map(|(tone, frequency_hz)| ToneAnswer::of(tone, *frequency_hz)).collect::<Vec<_>>(),
        "chord_gain_db": gain_db,
        "hold": hold,
        "table": { "crc": format!("{:08x}", table.crc()) },
        "clipped_samples": clipped_samples,
    });
    output::print(as_json, &value, |out| match signals::ended_by() {
        Some(signal) => writeln!(out, "Stopped by {} after {driven_s:.3} s.", signal.name()),
        None => writeln!(out, "Stopped."),
    })
}

/// What ends a drive that no signal ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Time,
    /// The line `stop`.
    Line,
    /// The end of standard input.
    Input,
}

impl End {
    /// Its name in JSON.
    const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Line => "stop",
            Self::Input => "input",
        }
    }
}

/// The lease of the drive: as long as it lasts and ten seconds more. What waits for the trigger may wait for any time.
fn lease(arguments: &DriveArguments) -> Option<Duration> {
    let longest_s = f64::from(LEASE_MS.1) / 1e3;
    let lease_s = arguments.duration.map_or(longest_s, |duration_s| (duration_s + 10.0).min(longest_s));
    (arguments.at == Begin::Now).then(|| Duration::from_secs_f64(lease_s))
}

/// Waits until the drive has begun after a trigger that counts from this sample index; returns the index and
/// time of its beginning, or `None` if the user interrupts.
fn wait_for_trigger(
    device: &Device,
    interruption: &Receiver<Wake>,
    from: u64,
) -> Result<Option<(u64, Instant)>, Failure> {
    let rate_hz = f64::from(device.identity()?.sample_rate_hz);
    let is_over = watch(device, (interruption, &mut |_| Ok(false)), |snapshot| {
        Ok(if snapshot.trigger_outcome(from) == TriggerOutcome::Waits { GLANCE } else { Duration::ZERO })
    })?;
    if !is_over {
        return Ok(None);
    }
    let snapshot = device.snapshot();
    let TriggerOutcome::Began(began) = snapshot.trigger_outcome(from) else {
        return Err(Failure::Failed("the device dropped the drive before the trigger".to_owned()));
    };
    let now = snapshot.status.map_or(began, |status| status.now);
    let since = Duration::from_secs_f64(now.saturating_sub(began) as f64 / rate_hz);
    Ok(Some((began, Instant::now().checked_sub(since).unwrap_or_else(Instant::now))))
}

/// What wakes the program, and what follows it: returns whether the drive goes on.
type Wakes<'a> = (&'a Receiver<Wake>, &'a mut dyn FnMut(Wake) -> Result<bool, Failure>);

/// Waits until the time since `begin` is over or what wakes the program ends the drive, and calls `each` at every check;
/// returns the driven time in seconds.
fn hold(
    device: &Device,
    wakes: Wakes<'_>,
    begin: Instant,
    duration_s: Option<f64>,
    mut each: impl FnMut(&Snapshot) -> Result<(), Failure>,
) -> Result<f64, Failure> {
    let duration = duration_s.map(Duration::from_secs_f64);
    watch(device, wakes, |snapshot| {
        each(snapshot)?;
        Ok(duration.map_or(GLANCE, |duration| duration.saturating_sub(begin.elapsed())))
    })?;
    Ok(begin.elapsed().as_secs_f64())
}

/// Waits until no time is `left` or what wakes the program ends the drive, and checks the device meanwhile; returns whether
/// the time is over.
fn watch(
    device: &Device,
    (interruption, follow): Wakes<'_>,
    mut left: impl FnMut(&Snapshot) -> Result<Duration, Failure>,
) -> Result<bool, Failure> {
    loop {
        // Checked first, so that a drive that failed is not reported as complete.
        device.check_drives()?;
        let left = left(&device.snapshot())?;
        if left.is_zero() {
            return Ok(true);
        }
        match interruption.recv_timeout(left.min(GLANCE)) {
            Ok(wake) => {
                if !follow(wake)? {
                    return Ok(device.check_attended().map(|()| false)?);
                }
            }
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(GLANCE),
            Err(RecvTimeoutError::Timeout) => {}
        }
        device.sign_of_life();
    }
}
