//! The commands: the words of the command line, and which module carries each out.

use super::destination::ForceArgument;
use super::failure::Failure;
use super::rig::PortArgument;
use super::{
    board, calibrate, check, completions, design, drive, figures, images, info, manual, measure, merit,
    output, page, presets, profile, progress, record, respond, selftest, serve, simulate, study, sweep,
    table, texture, trim, udev, verify, watch,
};
use crate::signals;
use clap::{CommandFactory as _, Parser, Subcommand};
use slipline_link::Port;
use slipline_plate::quantity::nearest;
use std::path::PathBuf;

const EXIT_CODES: &str = "\
Defaults of --port and --plate: the option, else SLIPLINE_PORT and SLIPLINE_PLATE of the environment, else port and plate of \
the settings file, else sim and membrane. slipline info shows them, each with its source, and the settings file's place.

Exit code: 0 done; 1 could not be done; 2 bad usage or a bad file, the message says what is allowed; 3 the plate or the board \
that was checked has red lights. Ctrl-C, SIGTERM and SIGHUP stop and disarm the device, and then end the program as they end any other; \
serve, page and watch, which nothing else ends, end with 0.

A file named - is standard input or standard output; ./- is a file of this name.";
const CHECK_EXIT_CODES: &str = "Exit code: 0 no light is red; 3 some are, the last line gives their number; for 1 and 2 see slipline --help.";
const SELFTEST_EXIT_CODES: &str = "Exit code: 0 no step is red; 3 some are, the last line gives their number; for 1 and 2 see slipline --help.";
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
    /// Whether existing files may be replaced, the trace included: the command's `--force`.
    #[arg(skip)]
    pub may_replace: bool,
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
    },
    /// Print the device's status as lines of JSON, five times a second, until it is interrupted. Arms nothing.
    Watch(watch::WatchArguments),
    /// Show or write the profile of a board's actuator: the limits that the device itself keeps, for every program.
    Profile(profile::ProfileArguments),
    /// Show or set the level of a board's brown-out reset, once per board; clear its latched faults.
    Board(board::BoardArguments),
    /// Put a table on a device and drive it.
    Drive(drive::DriveArguments),
    /// Solve the plate at one frequency: complex amplitude over x, turning point, peak.
    Respond(respond::RespondArguments),
    /// Make the turning-point table of a plate.
    Table(table::TableArguments),
    /// Run the whole chain: protocol, device application, DAC codes, plate in time.
    Simulate(simulate::SimulateArguments),
    /// Write the DAC codes of a drive as a WAV file.
    Record(record::RecordArguments),
    /// Compare a device's own digest of its DAC codes with the mirror's.
    Verify(verify::VerifyArguments),
    /// Test a board by itself, with a wire or two: clocks, supply, mute pin, converters, codes, link. Its amplifier stays muted.
    #[command(after_help = SELFTEST_EXIT_CODES)]
    Selftest(selftest::SelftestArguments),
    /// Offer the simulated device to other programs, in real time, until it is interrupted.
    Serve(serve::ServeArguments),
    /// Offer the window as a page to the browsers of this computer, until it is interrupted.
    Page(page::PageArguments),
    /// Check a plate: one light per question, with the reason. Red lights end it with exit code 3.
    #[command(after_help = CHECK_EXIT_CODES)]
    Check(check::CheckArguments),
    /// Design a plate for a band: taper, damper, plate file and cut files of plate and frame.
    #[command(after_help = DESIGN_EXIT_CODES)]
    Design(design::DesignArguments),
    /// Make a texture: tones that together vibrate an even area, a drawn profile, stripes, or a beat.
    Texture(texture::TextureArguments),
    /// Rate the sharpness, speed and number of a plate's boundaries over their turning points: contrast, ripple, edge,
    /// switching, bits per second.
    Merit(merit::MeritArguments),
    /// Draw many plates within the tolerances of a plate's fields, drive each with the nominal plate's table, and
    /// report how far its lines land from their places, and how loud.
    Study(study::StudyArguments),
    /// Measure the response of a sensor on the plate, or of the drive's current, to the device's tones.
    Measure(measure::MeasureArguments),
    /// Play a sweep twice for a separate recorder (a phone, an audio interface) with a sensor on the plate, and describe it.
    Sweep(sweep::SweepArguments),
    /// Correct a plate file by measurements: of a sensor at two places or at one, of the drive's current, or of edges that
    /// a finger felt.
    Calibrate(Box<calibrate::CalibrateArguments>),
    /// Measure the present wave speed of a calibrated plate by one sensor, and follow it while tension or temperature change.
    Trim(trim::TrimArguments),
    /// Draw the paper's figures, as printed and corrected, and those of the physics, as SVG, PNG and CSV
    Figures(figures::FiguresArguments),
    /// Print the script with which a shell completes the words of this program.
    Completions(completions::CompletionsArguments),
    /// Write the pages of man: one for the program and one for each command.
    Manual(manual::ManualArguments),
    /// List or write the boards' images, which releases of this program hold.
    Images(images::ImagesArguments),
    /// Print the udev rules by which Linux lets the user at the screen open a board, with the two lines that install them.
    Udev,
}

impl Cli {
    /// The arguments, if they belong together: a file and a port without a command are for the window.
    ///
    /// # Errors
    /// [`Failure::Usage`]: the argument that does not belong here, or the file that does not exist.
    pub fn checked(self) -> Result<Self, Failure> {
        if self.command.is_some() && (self.file.is_some() || self.port.is_some()) {
            let text = "FILE and --port before a command are for the window: give a command's own after it";
            return Err(Failure::Usage(text.to_owned()));
        }
        if self.command.is_some() && self.kiosk {
            return Err(Failure::usage("--kiosk is for the window: it stands without a command"));
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

    /// Whether standard output has JSON.
    #[must_use]
    pub const fn prints_json(&self) -> bool {
        self.json || matches!(self.command, Some(Command::Watch(_)))
    }
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
            Self::Info { port, .. } => info::run(&port, json),
            Self::Watch(arguments) => watch::run(&arguments),
            Self::Profile(arguments) => profile::run(&arguments, json),
            Self::Board(arguments) => board::run(&arguments, json),
            Self::Drive(arguments) => drive::run(&arguments, json),
            Self::Respond(arguments) => respond::run(&arguments, json),
            Self::Table(arguments) => table::run(&arguments, json),
            Self::Simulate(arguments) => simulate::run(&arguments, json),
            Self::Record(arguments) => record::run(&arguments, json),
            Self::Verify(arguments) => verify::run(&arguments, json),
            Self::Selftest(arguments) => selftest::run(&arguments, json),
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
            Self::Completions(arguments) => completions::run(&arguments, Cli::command(), json),
            Self::Manual(arguments) => manual::run(&arguments, Cli::command(), json),
            Self::Images(arguments) => images::run(&arguments, json),
            Self::Udev => udev::run(json),
        }
    }
}
