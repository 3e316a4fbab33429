//! `slipline drive`.

use super::argument;
use super::destination::ForceArgument;
use super::device::{ArmingArgument, Device, LoadedDevice};
use super::drive_wait::{wait_for_end, wait_for_trigger};
use super::failure::Failure;
use super::followed_drive::FollowedDrive;
use super::hold::{HoldArgument, Holder};
use super::input_lines::{InputLines, Wake};
use super::known_drive::{self, KnownDriveArgument};
use super::rig::PortArgument;
use super::setup_source::{SetupArgument, SetupSource, at_master_level};
use super::{output, progress, source, tones};
use crate::signals::{self, Signal};
use clap::{Args, ValueEnum};
use serde_json::json;
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::event::Fault;
use slipline_link::protocol::limits::LEASE_MS;
use slipline_link::{DeviceTable, Snapshot, Sounding, upkeep};
use slipline_model::answer::ToneAnswer;
use slipline_model::companions::with_companions;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::{Setup, edit};
use slipline_plate::DriveTable;
use slipline_plate::quantity::number_format::rounded;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Longest drive of one command, in seconds: the device's own limit is ten minutes.
const DRIVE_S: f64 = 600.0;

/// `drive`.
#[derive(Debug, Args)]
pub struct DriveArguments {
    #[command(flatten)]
    port: PortArgument,
    #[command(flatten)]
    sounds: SetupArgument,
    /// Duration of the drive, up to 600s; by default, until Ctrl-C, or 10 minutes: then the device stops by
    /// itself.
    #[arg(long = "for", value_name = "TIME", value_parser = argument::seconds(0.0, DRIVE_S), allow_hyphen_values = true)]
    duration: Option<f64>,
    /// Duration of the change, 5ms to 10s.
    #[arg(long, value_name = "TIME", value_parser = argument::seconds(0.005, 10.0), allow_hyphen_values = true, default_value = "20ms", conflicts_with = "setup")]
    glide: f64,
    /// Follow lines of standard input while driving, without silence between them, until they end: felt-edge 210mm,
    /// turning-point 160mm, level 0.5, glide 20ms, stop. Further values are those of the next tones. A line that is refused
    /// changes nothing.
    #[arg(long, conflicts_with = "hold")]
    stdin: bool,
    /// Play companions at twice and three times the frequency of each tone, opposite to the harmonics of the drive that the plate
    /// file states, so that the still side is still. The tones begin in silence and do not glide; up to five have room. Of
    /// several tones the sums of their frequencies stay.
    #[arg(long, conflicts_with_all = ["stdin", "hold"])]
    cancel_harmonics: bool,
    /// When to begin: now, or with the first block of samples after the device's trigger input rises. Until
    /// then the device waits, armed; Ctrl-C cancels the drive.
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = Begin::Now)]
    at: Begin,
    /// Clear the device's latched faults first.
    #[arg(long)]
    clear_faults: bool,
    #[command(flatten)]
    hold: HoldArgument,
    #[command(flatten)]
    known: KnownDriveArgument,
    // For the trace, which main writes.
    #[command(flatten)]
    force: ForceArgument,
    #[command(flatten)]
    arming: ArmingArgument,
}

/// When a drive begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Begin {
    /// At once.
    Now,
    /// When the trigger input rises.
    Trigger,
}

pub(super) fn run(arguments: &DriveArguments, as_json: bool) -> Result<(), Failure> {
    let wanted = arguments.sounds.read()?;
    if arguments.stdin && source::is_standard_input_taken() {
        let why = "--stdin follows standard input, which is a file of this command already";
        return Err(Failure::usage(why));
    }
    let rig = arguments.hold.rig(&arguments.port, &wanted.plate)?;
    // Refused before a device is asked.
    let made = arguments.tables_and_setup(&wanted, SAMPLE_RATE_HZ)?;

    let device = Device::connect(&arguments.port.port()?, rig.as_ref())?;
    device.may_be_armed(&arguments.arming)?;
    if arguments.at == Begin::Trigger && device.snapshot().has_trigger_input() == Some(false) {
        let why = "the device has no trigger input: it can begin with --at now only";
        return Err(Failure::failed(why));
    }
    let drive = Drive::new(arguments, &wanted, &device, made, as_json)?;
    let mut holder =
        arguments.hold.holder(&device, &wanted.plate, &drive.bench.table, &edit::drive(&drive.setup))?;
    known_drive::check(&drive.bench, arguments.known.stated()?)?;
    device.arm_for(lease(arguments))?;
    let at = device.play(drive.sounding.clone().beginning(arguments.at.apply()))?;
    // Registered before the message that Ctrl-C ends the drive.
    let (wakes, interruption) = channel();
    let (stop, interrupted) = (device.stopper(), wakes.clone());
    let _closing = signals::end_by(move || {
        // Sent at once, without waiting.
        stop();
        let _ = interrupted.send(Wake::Signal);
    });

    drive.announce()?;
    let began = drive.begin(at, &interruption)?;
    let course = drive.sound(began, (wakes, &interruption), holder.as_mut())?;
    let stopped_at = device.stop()?;
    let hold = holder.as_ref().map(Holder::value);
    let clipped_samples = device.snapshot().drive.status.map(|status| status.counters.clips);
    // The drive ends before the answer is written: its reader may be slow.
    device.disarm()?;
    let value = json!({
        "port": arguments.port.port()?.to_string(),
        "plate": wanted.plate.name(),
        "at_samples": began.map(|(at, _)| at),
        // JSON: Index of the sample at which it stopped; null if it did not begin
        "stopped_at_samples": stopped_at,
        // JSON: Time of the drive
        "driven_s": course.driven_s,
        // JSON, text: time, stop or input (of --stdin), or the signal that ended it
        "ended_by": signals::ended_by().map_or(course.end.name(), Signal::name),
        "feeling": wanted.feeling.answer(),
        "tones": drive.tones(course.followed.places().as_ref().unwrap_or(&drive.places)),
        "chord_gain_db": drive.gain_db,
        "hold": hold,
        "table": { "crc": format!("{:08x}", drive.bench.table.crc()) },
        "clipped_samples": clipped_samples,
    });
    output::print(as_json, &value, |out| match signals::ended_by() {
        Some(signal) => writeln!(out, "Stopped by {} after {:.3} s.", signal.name(), course.driven_s),
        None => writeln!(out, "Stopped."),
    })
}

impl Begin {
    const fn apply(self) -> Apply {
        match self {
            Self::Now => Apply::Next,
            Self::Trigger => Apply::AtTrigger,
        }
    }
}

/// The plate's table, the device's, and the setup that sounds.
type Made = (DriveTable, Arc<DeviceTable>, Setup);

impl DriveArguments {
    /// The tables and the setup at this sample rate.
    fn tables_and_setup(&self, wanted: &SetupSource, rate_hz: u32) -> Result<Made, Failure> {
        let (plate_table, table) = progress::table_for(&wanted.plate, rate_hz)?;
        let setup = wanted.setup(&plate_table)?;
        let glide_s = if wanted.is_of_file() { setup.glide_s } else { self.glide };
        Ok((plate_table, table, Setup { glide_s, ..setup }))
    }
}

/// A drive on a device that holds its table.
struct Drive<'a> {
    arguments: &'a DriveArguments,
    wanted: &'a SetupSource,
    bench: LoadedDevice<'a>,
    plate_table: DriveTable,
    setup: Setup,
    sounding: Sounding,
    /// Both places of its tones, and the gain of the chord that they are, in dB.
    places: Vec<TonePlaces>,
    gain_db: Option<f64>,
    as_json: bool,
}

/// How a drive went.
struct Course<'a> {
    driven_s: f64,
    end: End,
    followed: FollowedDrive<'a>,
}

impl<'a> Drive<'a> {
    /// Uploads the table that was `made`, or one for the device's sample rate.
    fn new(
        arguments: &'a DriveArguments,
        wanted: &'a SetupSource,
        device: &'a Device,
        made: Made,
        as_json: bool,
    ) -> Result<Self, Failure> {
        let rate_hz = device.identity()?.sample_rate_hz;
        let (plate_table, table, setup) = if rate_hz == SAMPLE_RATE_HZ {
            made
        } else {
            device.during(|| arguments.tables_and_setup(wanted, rate_hz))??
        };
        let snapshot = device.snapshot();
        let sounding = if arguments.cancel_harmonics {
            Sounding::Comb(with_companions(&setup, &table).map_err(Failure::usage)?)
        } else {
            device.during(|| wanted.sounding(&setup, &table, &snapshot))??
        };
        if arguments.stdin && matches!(sounding, Sounding::Chord(_)) {
            let why = "--stdin: the setup is a chord, whose tones stand still; drive it without --stdin";
            return Err(Failure::usage(why));
        }
        let (sum, share) = (table.sum_of(&at_master_level(&setup)), snapshot.linear_share());
        // A chord is fitted to it.
        if sum > share && !matches!(sounding, Sounding::Chord(_)) {
            output::note(format_args!("slipline: {}", upkeep::beyond_linear(sum, share)));
        }
        let shown = if arguments.cancel_harmonics { setup.without_harmonics() } else { setup.clone() };
        let (places, gain_db) = TonePlaces::as_played(shown, Some(&sounding), &plate_table);
        if arguments.clear_faults {
            device.clear_faults()?;
        }
        let bench = LoadedDevice::with(device, &wanted.plate, table)?;
        Ok(Self { arguments, wanted, bench, plate_table, setup, sounding, places, gain_db, as_json })
    }

    /// Prints what sounds or waits, and how long.
    fn announce(&self) -> Result<(), Failure> {
        if self.as_json {
            return Ok(());
        }
        output::print(false, &json!(null), |out| {
            for (tone, frequency_hz) in TonePlaces::on_device(&self.places, &self.bench.table) {
                writeln!(out, "{}", tones::words(tone, frequency_hz))?;
            }
            writeln!(out, "{}", self.wanted.feeling.words())?;
            if let Some(gain_db) = self.gain_db {
                writeln!(out, "As a chord, {gain_db:.1} dB above the setup's levels.")?;
            }
            if self.arguments.cancel_harmonics {
                writeln!(out, "Companions cancel the drive's harmonics.")?;
            }
            if self.arguments.at == Begin::Trigger {
                writeln!(out, "Waiting for the trigger.")?;
            }
            if self.arguments.stdin {
                writeln!(out, "Lines of standard input change the drive, and their end stops it.")?;
            }
            match self.arguments.duration {
                Some(seconds) => writeln!(out, "Driving for {} s.", rounded(seconds, 3)),
                None => {
                    let most = self.bench.device.snapshot().fault_text(Fault::DriveTime);
                    writeln!(out, "Driving until Ctrl-C; the device stops by itself after {most}.")
                }
            }
        })
    }

    /// The index and time of its beginning, once it has begun; `None` if the user interrupts before. `at` is the index of
    /// the answer to the command.
    fn begin(&self, at: u64, interruption: &Receiver<Wake>) -> Result<Option<(u64, Instant)>, Failure> {
        if self.arguments.at == Begin::Now {
            return Ok(Some((at, Instant::now())));
        }
        let began = wait_for_trigger(self.bench.device, interruption, at)?;
        if let Some((at, _)) = began.filter(|_| !self.as_json) {
            output::print(false, &json!(null), |out| writeln!(out, "Began at sample {at}."))?;
        }
        Ok(began)
    }

    /// Waits for its end, and follows the lines and holds the levels meanwhile.
    fn sound(
        &self,
        began: Option<(u64, Instant)>,
        (wakes, interruption): (Sender<Wake>, &Receiver<Wake>),
        mut holder: Option<&mut Holder>,
    ) -> Result<Course<'_>, Failure> {
        let device = self.bench.device;
        let tables = (&self.plate_table, &*self.bench.table);
        let mut followed =
            FollowedDrive::new(device, tables, self.wanted.asked(), self.setup.clone(), self.as_json);
        let mut end = End::Time;
        let Some((at, begin)) = began else { return Ok(Course { driven_s: 0.0, end, followed }) };
        let lines = self.arguments.stdin.then(|| InputLines::begin(wakes)).transpose()?;
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
            Some(holder) => holder.begin(device, interruption, at)?,
            None => true,
        };
        if goes_on {
            let each = |snapshot: &Snapshot| match &mut holder {
                Some(holder) => holder.watch(snapshot, self.as_json),
                None => Ok(()),
            };
            wait_for_end(device, (interruption, &mut follow), begin, self.arguments.duration, each)?;
        }
        Ok(Course { driven_s: begin.elapsed().as_secs_f64(), end, followed })
    }

    /// The fields of its tones at these places.
    fn tones(&self, places: &[TonePlaces]) -> Vec<ToneAnswer> {
        let played = TonePlaces::on_device(places, &self.bench.table);
        played.map(|(tone, frequency_hz)| ToneAnswer::of(tone, frequency_hz)).collect()
    }
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
