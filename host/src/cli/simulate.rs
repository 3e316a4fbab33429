//! `slipline simulate`.

use super::argument::{self, FingerArgument};
use super::destination::{Destination, ForceArgument};
use super::envelope_file::EnvelopeArgument;
use super::failure::Failure;
use super::rig::actual_plate;
use super::schema::with_files;
use super::setup_source::{SetupArgument, SetupSource};
use super::{differs, output, progress, tones};
use clap::Args;
use serde_json::json;
use slipline_instrument::requests::{NamedFeeling, SimulateRequest};
use slipline_link::simulator::loopback::Loopback;
use slipline_model::answer::simulate::SimulatedDrive;
use slipline_model::export::figures::envelope_figure;
use slipline_model::field::felt::{Felt, by_person_words};
use slipline_model::field::simulation::{
    MAX_SECONDS, SAMPLE_RATE_HZ, Simulated, SlowBeat, Solver, ToneResult, sheet_grid,
};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{show_frequency, show_length, show_place, show_si};
use slipline_plate::{Plate, SheetError};
use std::io::Write;
use std::sync::Arc;
use std::thread::available_parallelism;

/// `simulate`.
#[derive(Debug, Args)]
pub struct SimulateArguments {
    #[command(flatten)]
    sounds: SetupArgument,
    /// The plate on which the waves run, if it differs from the table's plate. A preset's name, a TOML file, or
    /// secret:SEED (a plate near it: wave speed within 5 %, 0.5 to 2.5 times the loss).
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

pub(super) fn run(arguments: &SimulateArguments, as_json: bool) -> Result<(), Failure> {
    let wanted = arguments.sounds.read()?;
    let request = arguments.request(&wanted)?;
    let files = arguments.files.destinations(arguments.force)?;
    let (table, device_table) = progress::table_for(&request.plate, SAMPLE_RATE_HZ)?;
    let setup = wanted.setup(&table)?;
    let chain = Loopback::connect(SAMPLE_RATE_HZ).map_err(Failure::failed)?;
    // Without gains the sum is another; it is checked with that table.
    let sounding =
        wanted.is_of_file().then(|| wanted.sounding(&setup, &device_table, chain.view())).transpose()?;
    let planned = request.plan(setup, sounding, &table).map_err(Failure::refused)?;
    let what = if arguments.sheet { "sheet" } else { "plate" };
    let result = progress::watched(what, |progress| planned.run(progress))?;
    for file in &files {
        match &file.figure {
            None => file.destination.write(|out| Ok(csv(&result, out)?))?,
            Some(figure) => {
                figure.write(&file.destination, &envelope_figure(&result, request.plate.name()))?;
            }
        }
    }
    let drive = planned.drive(&wanted.feeling, &result);
    let names = Destination::names(files.iter().map(|file| &file.destination));
    let actual_plate = arguments.actual_plate.as_deref();
    output::print(as_json, &with_files(json!(drive.answer()), names), |out| {
        print(&drive, actual_plate, &wanted.feeling, out)
    })
}

impl SimulateArguments {
    /// What is simulated of this plate and its tones.
    fn request(&self, wanted: &SetupSource) -> Result<SimulateRequest, Failure> {
        let plate = Arc::clone(&wanted.plate);
        let actual = self.actual_plate.as_deref().map(|text| actual_plate(text, Some(&plate))).transpose()?;
        if self.no_table && wanted.has_felt_edge() {
            let why = "--felt-edge is by the table's gains: with --no-table name a --turning-point";
            return Err(Failure::usage(why));
        }
        let solver = if self.sheet { sheet_of(actual.as_ref().unwrap_or(&plate))? } else { Solver::Line };
        let finger = self.finger.and_then(|argument| argument.0);
        Ok(SimulateRequest {
            plate,
            actual,
            has_gains: !self.no_table,
            seconds: self.duration,
            solver,
            finger,
        })
    }
}

/// Prints a simulated drive; `actual_plate` is the option that named the plate on which the waves ran.
fn print(
    drive: &SimulatedDrive<'_>,
    actual_plate: Option<&str>,
    feeling: &NamedFeeling,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let result = drive.result;
    let waves_run_on = match (actual_plate, drive.actual.name()) {
        // A plate near the command's has its name.
        (Some(text), name) if name == drive.plate.name() => format!("{name} ({text})"),
        (_, name) => name.to_owned(),
    };
    output::lines(
        out,
        &[
            ("Plate", drive.plate.name().to_owned()),
            ("Waves run on", waves_run_on),
            ("Simulated", format!("{:.3} s, the last {:.3} s measured", result.seconds, result.window_s)),
            ("Clipped", format!("{} samples", result.clipped_samples)),
        ],
    )?;
    if let Some(it) = drive.sensitivity {
        let (worst, at) = (it.worst_db, show_place(it.worst_at_m));
        writeln!(out, "The table is off by up to {worst:.2} dB on the actual plate, worst at {at}.")?;
    }
    if let Some(beat) = result.slow_beat {
        writeln!(out, "{}", slow_beat(beat, result.window_s))?;
    }
    writeln!(out)?;
    print_places(drive, out)?;
    writeln!(out, "{}", feeling.words())?;
    if let Some(gain_db) = drive.chord_gain_db {
        writeln!(out, "As a chord, {gain_db:.1} dB above the setup's levels.")?;
    }
    writeln!(out)?;
    output::table(out, &rows(result))?;
    writeln!(out)?;
    writeln!(out, "{}", felt_words(result.felt(drive.actual, &feeling.feeling)))?;
    match drive.solver {
        Solver::Line => Ok(()),
        Solver::Sheet { .. } => print_sheet(result, out),
    }
}

/// Where the peaks of the sheet differ from those of one mode.
fn print_sheet(result: &Simulated, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out)?;
    result.tones.iter().try_for_each(|tone| {
        let [one_mode, sheet] = tone.differs.nodes;
        let (at, peak) = (show_place(tone.boundary_m), differs::peak(&tone.differs));
        writeln!(out, "On the sheet, the peak for {at}: {peak}; {sheet} nodes (one mode: {one_mode}).")
    })
}

/// Both places of each tone by the plate of the command and its table, before anything is simulated.
fn print_places(drive: &SimulatedDrive<'_>, out: &mut dyn Write) -> std::io::Result<()> {
    if !drive.has_gains {
        // The peaks are not those of the table, by which the felt edges are computed.
        return writeln!(out, "Without the table's gains the felt edges are not known beforehand.");
    }
    drive.places.iter().try_for_each(|tone| writeln!(out, "{}", tones::words(tone, tone.frequency_hz)))
}

/// The sheet of a plate, on all processors, or why the plate has none.
fn sheet_of(plate: &Plate) -> Result<Solver, Failure> {
    let threads = available_parallelism().map_or(1, |count| count.get().min(64));
    match sheet_grid(plate, plate.band_hz().1, threads).cost(plate, f64::from(SAMPLE_RATE_HZ)) {
        // Whether it follows the air depends on the tones.
        Ok(_) | Err(SheetError::Air { .. }) => Ok(Solver::Sheet { threads }),
        Err(SheetError::Bends { plate }) => Err(Failure::Usage(format!(
            "--sheet carries membranes and shear waves, and {plate:?} is a plate in bending: slipline respond --2d solves \
             it in two dimensions"
        ))),
        Err(error) => Err(Failure::Usage(format!("--sheet: {error}"))),
    }
}

/// The quantities that a beat slower than the measured time leaves unknown.
fn slow_beat(beat: SlowBeat, measured_s: f64) -> String {
    let (low_hz, high_hz) = beat.between_hz;
    let unknown =
        "their peaks are not measured, and the RMS is that of the measured time, not the mean of a beat";
    if low_hz == high_hz {
        return format!("Two tones have the same frequency, {}: {unknown}.", show_frequency(low_hz));
    }
    let period = show_si(1.0 / (high_hz - low_hz), "s");
    let (measured, needed) = (show_si(measured_s, "s"), show_si(beat.needed_s, "s"));
    format!(
        "Two tones beat once in {period}. The {measured} measured do not resolve them, {needed} would: {unknown}."
    )
}

/// The felt edge by the measured fields, as a sentence.
fn felt_words(felt: Option<Felt>) -> String {
    match felt {
        None => {
            "The felt edge is not known: the beat of two tones is slower than the measured time.".to_owned()
        }
        Some(Felt { not_felt: Some(why), .. }) => {
            format!("A finger feels nothing: {} (illustrative).", why.reason())
        }
        Some(felt) => {
            let edge = felt.edge.place_m().map_or("the plate's end".to_owned(), show_place);
            let by_person =
                by_person_words(felt.by_person).map_or(String::new(), |words| format!(", {words}"));
            format!("A finger feels it up to {edge}{by_person} (illustrative).")
        }
    }
}

fn rows(result: &Simulated) -> Vec<Vec<String>> {
    let header = [
        "Turning point",
        "Level",
        "Frequency",
        "Turns at",
        "Peak due at",
        "Peak found at",
        "Amplitude",
        "Edge width",
    ];
    let row = |tone: &ToneResult| {
        let none = || "none".to_owned();
        vec![
            show_place(tone.boundary_m),
            with_decimals(tone.level, 2),
            show_frequency(tone.frequency_hz),
            show_place(tone.predicted.turning_point_m),
            tone.predicted.peak.map_or_else(none, |peak| show_place(peak.position_m)),
            tone.measured.map_or_else(none, |peak| show_place(peak.position_m)),
            tone.measured.map_or_else(none, |peak| show_length(peak.amplitude)),
            show_place(tone.predicted.edge_width_m),
        ]
    };
    std::iter::once(header.map(str::to_owned).to_vec()).chain(result.tones.iter().map(row)).collect()
}

fn csv(result: &Simulated, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "position_m,predicted_rms_m,measured_rms_m,measured_maximum_m")?;
    let places = result.position_m.iter().zip(&result.predicted_rms_m);
    for ((x_m, predicted_m), (rms_m, maximum_m)) in places.zip(result.rms_m.iter().zip(&result.maximum_m)) {
        writeln!(out, "{x_m},{predicted_m:e},{rms_m:e},{maximum_m:e}")?;
    }
    Ok(())
}
