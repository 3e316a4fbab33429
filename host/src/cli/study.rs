//! `slipline study`.

use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::source::text_of;
use super::{argument, output, progress};
use clap::Args;
use serde_json::{Value, json};
use slipline_model::study::{
    Chunk, Draft, SPEC_BYTES_MAX, Spec, Statistics, Status, Study, Summary, csv, run_in_order,
};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{show_frequency, show_length, show_place};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;

/// Plates between two reports of progress: some milliseconds of work.
const PLATES_AT_ONCE: u64 = 32;
/// Most threads.
const THREADS_MAX: usize = 256;

/// `study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The specification, a TOML file: plate, seed, count, turning_point_m, and [vary] with the fields that vary. PLATES.md
    /// describes it.
    #[arg(value_name = "SPEC.toml")]
    spec: PathBuf,
    /// Threads, 1 to 256; by default, one for each processor. The numbers are the same.
    #[arg(long, value_parser = argument::count(1, THREADS_MAX), allow_hyphen_values = true)]
    threads: Option<usize>,
    /// Write a row for each plate to this CSV file.
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgument,
}

pub(super) fn run(arguments: &StudyArguments, as_json: bool) -> Result<(), Failure> {
    let spec = read(&arguments.spec)?;
    let file = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let study =
        progress::watched("table", |progress| Study::new(spec, progress)).map_err(Failure::refused)?;
    let threads = arguments.threads.or_else(|| available_parallelism().ok().map(Into::into));
    let threads = threads.unwrap_or(1).min(THREADS_MAX);
    let mut summary = Summary::new(study.spec());
    match &file {
        Some(file) => file.write(|out| {
            out.write_all(csv::head(&study).as_bytes())?;
            let rows = |chunk: &Chunk| out.write_all(csv::rows(&study, chunk).as_bytes());
            Ok(compute(&study, threads, &mut summary, rows)?)
        })?,
        None => compute(&study, threads, &mut summary, |_| Ok(())).map_err(Failure::failed)?,
    }
    let counts = || {
        let counts = Status::ALL.map(|status| (status, summary.count(status)));
        counts.into_iter().filter(|(_, count)| *count > 0)
    };
    let places = || study.spec().turning_point_m().iter().zip(study.frequencies_hz()).enumerate();
    let value = json!({
        "plate": study.nominal().name(),
        "seed": study.spec().seed(),
        "plates": counts()
            .map(|(status, count)| json!({ "status": status.meaning(), "count": count }))
            .collect::<Vec<_>>(),
        "turning_points": places()
            .map(|(place, (place_m, frequency_hz))| {
                let [shift, level] = summary.at_place(place).map_or([None; 2], |both| both.map(Some));
                json!({
                    "turning_point_m": place_m,
                    "frequency_hz": frequency_hz,
                    "shift_mean_m": shift.map(|it| it.mean),
                    "shift_deviation_m": shift.and_then(|it| it.standard_deviation),
                    "shift_quantiles_m": shift.map(|it| it.quantiles),
                    "level_mean_db": level.map(|it| it.mean),
                    "level_deviation_db": level.and_then(|it| it.standard_deviation),
                    "level_quantiles_db": level.map(|it| it.quantiles),
                })
            })
            .collect::<Vec<Value>>(),
        "quantiles": Statistics::SHARES,
        "files": Destination::names(&file),
    });
    output::print(as_json, &value, |out| {
        let plates: Vec<String> =
            counts().map(|(status, count)| format!("{count} {}", words(status))).collect();
        writeln!(out, "Plates around {}: {}", study.nominal().name(), plates.join(", "))?;
        let rows = places()
            .map(|(place, (place_m, frequency_hz))| row(*place_m, *frequency_hz, summary.at_place(place)));
        let header = [
            "Turning point",
            "Frequency",
            "Shift",
            "deviation",
            "5 to 95 %",
            "Level",
            "deviation",
            "5 to 95 %",
        ];
        let header = header.map(str::to_owned).to_vec();
        output::table(out, &std::iter::once(header).chain(rows).collect::<Vec<_>>())?;
        arguments.out.iter().try_for_each(|path| writeln!(out, "Written to {}", path.display()))
    })
}

/// Reads a specification, and its plate where it names one.
fn read(path: &Path) -> Result<Spec, Failure> {
    let draft =
        Draft::parse(&text_of(path, SPEC_BYTES_MAX)?).map_err(|error| Failure::in_file(path, error))?;
    let named = draft.plate_name().map(argument::plate).transpose()?;
    draft.finish(named).map_err(|error| Failure::in_file(path, error))
}

/// Computes all plates; `each` gets them in order.
fn compute(
    study: &Study,
    threads: usize,
    summary: &mut Summary,
    mut each: impl FnMut(&Chunk) -> io::Result<()>,
) -> io::Result<()> {
    progress::watched("plates", |progress| {
        let mut done = 0;
        let mut written = Ok(());
        run_in_order(study, threads, PLATES_AT_ONCE, |chunk| {
            summary.add(&chunk);
            written = each(&chunk);
            done += chunk.status.len();
            progress.at(done as f64 / study.spec().count() as f64).is_ok() && written.is_ok()
        })?;
        written
    })
}

fn words(status: Status) -> String {
    status.meaning().replace('_', " ")
}

fn row(place_m: f64, frequency_hz: f64, found: Option<[Statistics; 2]>) -> Vec<String> {
    let of = |statistics: Statistics, show: fn(f64) -> String| {
        let [low, _, high] = statistics.quantiles.map(show);
        let deviation = statistics.standard_deviation.map_or_else(|| "-".to_owned(), show);
        [show(statistics.mean), deviation, format!("{low} to {high}")]
    };
    let decibels = |value: f64| format!("{} dB", with_decimals(value, 2));
    let cells = match found {
        Some([shift, level]) => [of(shift, show_length), of(level, decibels)].concat(),
        None => vec!["-".to_owned(); 6],
    };
    [show_place(place_m), show_frequency(frequency_hz)].into_iter().chain(cells).collect()
}
