//! The command line: every use of Slipline except the window.
//!
//! JSON numbers are SI and their names end in the unit. Exit codes: 0 done; 1 failed; 2 bad usage or a bad
//! file (the message names it and the allowed range); 3 `check` is done and found red lights. A signal ends the
//! program by itself. Existing files are replaced with `--force` only.

mod argument;
mod calibrate;
mod calibrated;
mod call;
mod check;
mod completions;
mod defaults;
mod design;
mod design_argument;
mod destination;
mod device;
mod differs;
mod drive;
mod envelope_file;
mod examples;
mod failure;
mod feeling;
mod figure_file;
mod figures;
mod followed_drive;
mod hold;
mod info;
mod input_lines;
mod known_drive;
mod measure;
mod measured_file;
mod measuring;
mod merit;
mod output;
mod page;
mod presets;
mod profile;
mod progress;
mod record;
mod refusal;
mod renamed;
mod respond;
mod rig;
mod schema;
mod sensor_places;
mod serve;
mod setup_source;
mod simulate;
mod source;
mod study;
mod sweep;
mod table;
mod texture;
mod tones;
mod touch;
mod trim;
mod verify;
mod watch;

pub use calibrate::CalibrateArguments;
pub use call::asks_for_json;
pub use completions::CompletionsArguments;
pub use design::DesignArguments;
pub use destination::ForceArgument;
pub use examples::EXAMPLES;
pub use failure::Failure;
pub use figures::FiguresArguments;
pub use measure::MeasureArguments;
pub use merit::MeritArguments;
pub use page::PageArguments;
pub use profile::ProfileArguments;
pub use schema::SCHEMA;
pub use study::StudyArguments;
pub use sweep::SweepArguments;
pub use texture::TextureArguments;
pub use trim::TrimArguments;

use crate::signals;
use argument::{FingerArgument, PlaceArgument, Typed};
use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum};
use envelope_file::EnvelopeArgument;
use figure_file::{FigureFile, figure_file};
use setup_source::SetupArgument;
use slipline_link::Port;
use slipline_link::protocol::limits::MAX_TONES;
use slipline_model::atomic_file::{STANDARD_STREAM, is_stream};
use slipline_model::field::simulation::MAX_SECONDS;
use slipline_plate::calibrate::SensorKind;
use slipline_plate::{KNOTS_MAX, POINTS_MAX, POINTS_MIN, nearest};
use std::path::{Path, PathBuf};
use tones::GoneArgument;

/// Longest drive of one command, in seconds: the device's own limit is ten minutes.
const DRIVE_S: f64 = 600.0;

const EXIT_CODES: &str = "\
Defaults of --port and --plate: the option, else SLIPLINE_PORT and SLIPLINE_PLATE of the environment, else port and plate of \
the settings file, else sim and membrane. slipline info shows them, each with its source, and the settings file's place.

Exit code: 0 done; 1 could not be done; 2 bad usage or a bad file, the message says what is allowed; 3 the plate that was \
checked has red lights. Ctrl-C, SIGTERM and SIGHUP stop and disarm the device, and then end the program as they end any other; \
serve, page and watch, whose only end they are, end with 0.

A file named - is standard input or standard output; ./- is a file of this name.";
const CHECK_EXIT_CODES: &str = "Exit code: 0 no light is red; 3 some are, the last line gives their number; for 1 and 2 see slipline --help.";
const DESIGN_EXIT_CODES: &str = "Exit code: 0 designed, also where lights are red: they are printed, and slipline check of the plate ends with 3; for 1 and 2 see slipline --help.";

/// Drag the boundary on a tapered plate. With no command, the app opens its window.
#[derive(Debug, Parser)]
#[command(name = "slipline", version = env!("SLIPLINE_VERSION"), max_term_width = 110, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Without a command: the setup or plate file that the window opens. To open a file that has the name of a command,
    /// give its folder, too (./drive).
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Without a command: the port to which the window connects: sim, a serial port's name, or unix:PATH. A real device is
    /// not armed.
    #[arg(long, value_name = "P")]
    pub port: Option<Port>,
    /// Without a command: a window for visitors, full screen, the scenes in turn, without menus, STOP as everywhere; nothing
    /// that they change is kept.
    #[arg(long)]
    pub kiosk: bool,
    /// Print JSON: SI numbers, field names that end in their unit; host/JSON.md lists every field. An error is one line of JSON
    /// on the error stream.
    #[arg(long, global = true, display_order = 998, help_heading = "Output")]
    pub json: bool,
    /// Write every frame between this program and the device to this file (- is standard output), one line each. An existing
    /// file is replaced with --force only.
    #[arg(long, global = true, value_name = "FILE", display_order = 999, help_heading = "Output")]
    pub trace: Option<PathBuf>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the built-in plates.
    Presets,
    /// List the ports where a device can be: sim, Slipline devices, then other serial ports.
    Ports,
    /// Show the device's identity and state, and where the defaults of --port and --plate are from.
    Info {
        /// Which device.
        #[command(flatten)]
        port: PortArgument,
        /// Whether the trace may be replaced.
        #[command(flatten)]
        force: ForceArgument,
        /// Whether the port is that of the option, not a default.
        #[arg(skip)]
        is_port_given: bool,
    },
    /// Print the device's status as lines of JSON, five times a second, until it is interrupted. Arms nothing.
    Watch(WatchArguments),
    /// Show or write the profile of a board's actuator: the limits that the device itself keeps, for every program.
    Profile(ProfileArguments),
    /// Put a table on a device and drive it.
    Drive(DriveArguments),
    /// Solve the plate at one frequency: complex amplitude over x, turning point, peak.
    Respond(RespondArguments),
    /// Make the turning-point table of a plate.
    Table(TableArguments),
    /// Run the whole chain: protocol, device application, DAC codes, plate in time.
    Simulate(SimulateArguments),
    /// Write the DAC codes of a drive as a WAV file.
    Record(RecordArguments),
    /// Compare a device's own digest of its DAC codes with the mirror's.
    Verify(VerifyArguments),
    /// Offer the simulated device to other programs, in real time, until it is interrupted.
    Serve(ServeArguments),
    /// Offer the window as a page to the browsers of this computer, until it is interrupted.
    Page(PageArguments),
    /// Check a plate: one light per question, with the reason. Red lights end it with exit code 3.
    #[command(after_help = CHECK_EXIT_CODES)]
    Check(CheckArguments),
    /// Design a plate for a band: taper, damper, plate file and cut files of plate and frame.
    #[command(after_help = DESIGN_EXIT_CODES)]
    Design(DesignArguments),
    /// Make a texture: tones that together vibrate an even area, a drawn profile, stripes, or a beat.
    Texture(TextureArguments),
    /// Rate the sharpness, speed and number of a plate's boundaries over their turning points: contrast, ripple, edge,
    /// switching, bits per second.
    Merit(MeritArguments),
    /// Draw many plates around one by the tolerances of its fields, and drive each by the table of that one: how far its lines
    /// land from their places, and how loud.
    Study(StudyArguments),
    /// Measure the response of a sensor on the plate, or of the drive's current, to the device's tones.
    Measure(MeasureArguments),
    /// Play a sweep twice for a separate recorder (a phone, an audio interface) with a sensor on the plate, and describe it.
    Sweep(SweepArguments),
    /// Correct a plate file by measurements: of a sensor at two places or at one, of the drive's current, or of edges that
    /// a finger felt.
    Calibrate(CalibrateArguments),
    /// Measure the present wave speed of a calibrated plate by one sensor, and follow it while tension or temperature change.
    Trim(TrimArguments),
    /// Draw the paper's figures, as printed and corrected, and those of the physics, as SVG, PNG and CSV
    Figures(FiguresArguments),
    /// Print the script by which a shell completes words of this program.
    Completions(CompletionsArguments),
}

/// `watch`.
#[derive(Debug, Args)]
pub struct WatchArguments {
    #[command(flatten)]
    port: PortArgument,
    #[command(flatten)]
    force: ForceArgument,
}

/// The port of the device.
#[derive(Debug, Args)]
#[command(next_help_heading = "Device")]
pub struct PortArgument {
    /// sim, a serial port's name, or unix:PATH. Without this option: SLIPLINE_PORT of the environment, else port = "..." of the
    /// settings file, else sim.
    #[arg(long, value_name = "P", default_value = defaults::port(), hide_default_value = true)]
    port: Port,
    /// With --port sim: the plate under the simulated device, if it differs from the plate of the command. A
    /// preset's name, a TOML file, or secret:SEED (a plate whose values all deviate by a few per cent).
    #[arg(long, value_name = "TRUTH")]
    actual_plate: Option<String>,
}

/// Permission to arm a board without a brown-out level.
#[derive(Debug, Args)]
#[command(next_help_heading = "Device")]
pub struct ArmingArgument {
    /// Arm a board although it reports that its brown-out level is not set.
    #[arg(long)]
    despite_brown_out_level: bool,
    /// Arm a board although it keeps no profile of its actuator.
    #[arg(long)]
    despite_no_profile: bool,
}

/// The plate.
#[derive(Debug, Args)]
#[command(next_help_heading = "Plate")]
pub struct PlateArgument {
    /// A preset's name or a TOML file. Without this option: SLIPLINE_PLATE of the environment, else plate = "..." of the
    /// settings file, else membrane.
    #[arg(long, value_name = "PLATE", default_value = defaults::plate(), hide_default_value = true)]
    plate: String,
}

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
    /// When to begin: now, or with the first block of samples after the device's trigger input rises. Until
    /// then the device waits, armed; Ctrl-C cancels the drive.
    #[arg(long, value_name = "WHEN", value_enum, default_value_t = Begin::Now)]
    at: Begin,
    /// Clear the device's latched faults first.
    #[arg(long)]
    clear_faults: bool,
    #[command(flatten)]
    hold: hold::HoldArgument,
    #[command(flatten)]
    known: known_drive::KnownDriveArgument,
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

/// `respond`.
#[derive(Debug, Args)]
pub struct RespondArguments {
    #[command(flatten)]
    plate: PlateArgument,
    /// The frequency, such as 40kHz.
    #[arg(long, value_name = "F", value_parser = argument::frequency, allow_hyphen_values = true)]
    freq: Typed<f64>,
    /// Places along the plate, 8 to 200001.
    #[arg(long, value_parser = argument::count(POINTS_MIN, POINTS_MAX), allow_hyphen_values = true, default_value = "2001")]
    points: usize,
    /// The paper's equation, without the (W'/W) term.
    #[arg(long)]
    paper_mode: bool,
    /// Solve the plate in two dimensions, with the air of its file on the whole sheet, and show where the one-mode equation
    /// differs.
    #[arg(long = "2d")]
    two_dimensions: bool,
    /// A finger on the plate: none, light, firm, or R,M,WIDTH (120mm:0.5Ns/m,0.1g,10mm).
    /// All values are illustrative.
    #[arg(long, value_name = "PLACE:KIND", value_parser = argument::finger, allow_hyphen_values = true)]
    finger: Option<FingerArgument>,
    /// Draw the amplitude over x (.svg, .png; -).
    #[arg(long = "out", alias = "figure", value_name = "FILE", value_parser = figure_file, help_heading = "Output")]
    figure: Option<FigureFile>,
    #[command(flatten)]
    force: ForceArgument,
}

/// `table`.
#[derive(Debug, Args)]
pub struct TableArguments {
    #[command(flatten)]
    plate: PlateArgument,
    /// The device's sample rate, such as 400kHz.
    #[arg(long, value_name = "F", value_parser = argument::frequency, allow_hyphen_values = true, default_value = "400kHz")]
    sample_rate: Typed<f64>,
    /// Knots, 2 to 1025.
    #[arg(long, value_parser = argument::count(2, KNOTS_MAX), allow_hyphen_values = true, default_value = "1025")]
    knots: usize,
    /// Write the JSON to this file.
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// `simulate`.
#[derive(Debug, Args)]
pub struct SimulateArguments {
    #[command(flatten)]
    sounds: SetupArgument,
    /// The plate on which the waves run, if it differs from the table's plate. A preset's name, a TOML file, or
    /// secret:SEED (a plate whose values all deviate by a few per cent).
    #[arg(long, value_name = "TRUTH")]
    actual_plate: Option<String>,
    /// Longest drive, 10ms to 600s: it ends when the plate has settled and been measured for 2s.
    #[arg(long = "for", alias = "seconds", value_name = "TIME", value_parser = argument::seconds(0.01, MAX_SECONDS), allow_hyphen_values = true)]
    duration: Option<f64>,
    /// Leave out the table's gains: every tone has the same DAC amplitude. Not with a setup file.
    #[arg(long, conflicts_with = "setup")]
    no_table: bool,
    /// Run the whole sheet in two dimensions instead of the first width mode, and show where the two differ. For membranes
    /// and shear waves only.
    #[arg(long)]
    sheet: bool,
    /// A finger on the plate: none, light, firm, or R,M,WIDTH (120mm:0.5Ns/m,0.1g,10mm).
    /// All values are illustrative.
    #[arg(long, value_name = "PLACE:KIND", value_parser = argument::finger, allow_hyphen_values = true)]
    finger: Option<FingerArgument>,
    #[command(flatten)]
    files: EnvelopeArgument,
    #[command(flatten)]
    force: ForceArgument,
}

/// `record`.
#[derive(Debug, Args)]
pub struct RecordArguments {
    #[command(flatten)]
    sounds: SetupArgument,
    /// Duration of the recording, 1ms to 600s.
    #[arg(long = "for", alias = "seconds", value_name = "TIME", value_parser = argument::seconds(0.001, MAX_SECONDS), allow_hyphen_values = true, default_value = "1s")]
    duration: f64,
    /// The WAV file (.wav; -): one channel, 16 bits, at the device's sample rate.
    #[arg(long, value_name = "FILE", value_parser = wav_file, required_unless_present = "wav", help_heading = "Output")]
    out: Option<PathBuf>,
    #[arg(long, hide = true, value_name = "F", conflicts_with = "out")]
    wav: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

/// A file whose name ends in .wav, or a stream.
fn wav_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_wav = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("wav"));
    let is_allowed = is_wav || is_stream(&path) || path == Path::new(STANDARD_STREAM);
    is_allowed.then_some(path).ok_or_else(|| "must end in .wav".to_owned())
}

/// `verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    #[command(flatten)]
    port: PortArgument,
    /// The plate whose table is used. Without this option: SLIPLINE_PLATE of the environment, else plate = "..." of the
    /// settings file, else membrane.
    #[arg(long, value_name = "PLATE", default_value = defaults::plate(), hide_default_value = true, help_heading = "Plate")]
    plate: String,
    /// Number of tones, 1 to 16.
    #[arg(long, value_parser = argument::count(1, MAX_TONES), allow_hyphen_values = true, default_value = "16")]
    tones: usize,
    /// Longest window of codes per digest.
    #[arg(long, value_name = "TIME", value_parser = argument::time, allow_hyphen_values = true, default_value = "250ms")]
    window: Typed<f64>,
    #[command(flatten)]
    force: ForceArgument,
    #[command(flatten)]
    arming: ArmingArgument,
}

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
    /// secret:SEED (a plate whose values all deviate by a few per cent).
    #[arg(long, value_name = "TRUTH", requires = "sensor")]
    actual_plate: Option<String>,
    #[command(flatten)]
    force: ForceArgument,
}

/// `check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    plate: PlateArgument,
    /// One tone by its turning point (120mm) or its frequency (126Hz); by default, the worst over the span.
    #[arg(long, value_name = "X", value_parser = argument::place_or_frequency, allow_hyphen_values = true)]
    turning_point: Option<PlaceArgument>,
    #[command(flatten)]
    gone: GoneArgument,
    /// The tone's level, 0 to 1.
    #[arg(long, value_parser = argument::level, allow_hyphen_values = true, default_value = "1")]
    level: f64,
    /// The drive acts beside the centre line.
    #[arg(long)]
    off_centre: bool,
}

impl Cli {
    /// The arguments, if they belong together: a file and a port without a command are for the window.
    ///
    /// # Errors
    /// [`Failure::Usage`]: the argument that does not belong here, or the file that is not there.
    pub fn checked(self) -> Result<Self, Failure> {
        if self.command.is_some() && (self.file.is_some() || self.port.is_some()) {
            let text = "FILE and --port before a command are for the window: give a command's own after it";
            return Err(Failure::Usage(text.to_owned()));
        }
        if self.command.is_some() {
            defaults::check()?;
        }
        if self.command.is_some() && self.kiosk {
            return Err(Failure::Usage("--kiosk is for the window: it stands without a command".to_owned()));
        }
        if let Some(file) = self.file.as_deref().filter(|file| !file.is_file()) {
            let file = file.display().to_string();
            let commands = Self::command();
            let similar = nearest(&file, commands.get_subcommands().map(clap::Command::get_name));
            let similar = similar.map_or(String::new(), |name| format!("; a similar command is '{name}'"));
            return Err(Failure::Usage(format!(
                "'{file}' is neither a file nor a command{similar}; see slipline --help"
            )));
        }
        Ok(self)
    }
}

impl Cli {
    /// Whether standard output has JSON.
    #[must_use]
    pub const fn prints_json(&self) -> bool {
        self.json || matches!(self.command, Some(Command::Watch(_)))
    }

    /// Whether existing files may be replaced, the trace included.
    #[must_use]
    pub fn may_replace(&self) -> bool {
        let force = match &self.command {
            None
            | Some(
                Command::Presets
                | Command::Ports
                | Command::Check(_)
                | Command::Merit(_)
                | Command::Profile(_)
                | Command::Page(_)
                | Command::Completions(_),
            ) => ForceArgument::default(),
            Some(Command::Info { force, .. }) => *force,
            Some(Command::Watch(arguments)) => arguments.force,
            Some(Command::Drive(arguments)) => arguments.force,
            Some(Command::Respond(arguments)) => arguments.force,
            Some(Command::Table(arguments)) => arguments.force,
            Some(Command::Simulate(arguments)) => arguments.force,
            Some(Command::Record(arguments)) => arguments.force,
            Some(Command::Verify(arguments)) => arguments.force,
            Some(Command::Serve(arguments)) => arguments.force,
            Some(Command::Design(arguments)) => arguments.force,
            Some(Command::Texture(arguments)) => arguments.force,
            Some(Command::Measure(arguments)) => arguments.force,
            Some(Command::Sweep(arguments)) => arguments.force,
            Some(Command::Calibrate(arguments)) => arguments.force,
            Some(Command::Trim(arguments)) => arguments.force,
            Some(Command::Figures(arguments)) => arguments.force,
            Some(Command::Study(arguments)) => arguments.force,
        };
        force.force
    }
}

/// Takes standard output for the trace: the command's text goes to standard error then.
///
/// # Errors
/// [`Failure::Usage`] with JSON, which needs standard output, too.
pub fn trace_to_standard_output(json: bool) -> Result<(), Failure> {
    output::begin(json);
    output::take()
}

impl Command {
    /// Runs the command and prints its result.
    ///
    /// # Errors
    /// [`Failure`]: the reason and the exit code.
    pub fn run(self, json: bool) -> Result<(), Failure> {
        signals::before_exit(progress::wipe_for_good);
        output::begin(json);
        match self {
            Self::Presets => presets::run(json),
            Self::Ports => info::ports(json),
            Self::Info { port, is_port_given, .. } => info::run(&port, is_port_given, json),
            Self::Watch(arguments) => watch::run(&arguments),
            Self::Profile(arguments) => profile::run(&arguments, json),
            Self::Drive(arguments) => drive::run(&arguments, json),
            Self::Respond(arguments) => respond::run(&arguments, json),
            Self::Table(arguments) => table::run(&arguments, json),
            Self::Simulate(arguments) => simulate::run(&arguments, json),
            Self::Record(arguments) => record::run(&arguments, json),
            Self::Verify(arguments) => verify::run(&arguments, json),
            Self::Serve(arguments) => serve::run(&arguments, json),
            Self::Page(arguments) => page::run(&arguments, json),
            Self::Check(arguments) => check::run(&arguments, json),
            Self::Design(arguments) => design::run(&arguments, json),
            Self::Texture(arguments) => texture::run(&arguments, json),
            Self::Merit(arguments) => merit::run(&arguments, json),
            Self::Study(arguments) => study::run(&arguments, json),
            Self::Measure(arguments) => measure::run(&arguments, json),
            Self::Sweep(arguments) => sweep::run_sweep(&arguments, json),
            Self::Calibrate(arguments) => calibrate::run(&arguments, json),
            Self::Trim(arguments) => trim::run(&arguments, json),
            Self::Figures(arguments) => figures::run(&arguments, json),
            Self::Completions(arguments) => completions::run(&arguments, json),
        }
    }
}
