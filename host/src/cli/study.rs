//! `slipline study`.

use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::source::text_of;
use super::{argument, output, progress};
use clap::Args;
use serde_json::{Map, Value, json};
use slipline_model::study::{
    Chunk, Draft, Kind, SPEC_BYTES_MAX, Spec, Statistics, Status, Study, StudyResult, Summary, csv,
    run_in_order,
};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{show_frequency, show_length, show_place};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;

/// Plates between two reports of progress, of the one-mode equation: some milliseconds of work.
const PLATES_AT_ONCE: u64 = 32;
/// Results in one table of the text.
const RESULTS_IN_A_TABLE: usize = 2;
/// Most threads.
const THREADS_MAX: usize = 256;

/// `study`.
#[derive(Debug, Args)]
pub struct StudyArguments {
    /// The specification, a TOML file: plate, seed, count, turning_point_m, kind, results, and [vary] with the fields that vary.
    /// PLATES.md describes it.
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
        // JSON, count: Seed of the study's random numbers
        "seed": study.spec().seed(),
        "plates": counts()
            // JSON `count` of study, count: Plates with this status
            // JSON `status`, text: done, or why a place of these plates has no numbers
            .map(|(status, count)| json!({ "status": status.meaning(), "count": count }))
            .collect::<Vec<_>>(),
        "turning_points": places()
            .map(|(place, (place_m, frequency_hz))| {
                let mut value = Map::new();
                value.insert("turning_point_m".to_owned(), json!(place_m));
                value.insert("frequency_hz".to_owned(), json!(frequency_hz));
                for (number, result) in study.spec().results().iter().enumerate() {
                    value.extend(fields(*result, summary.of(number, place)));
                }
                Value::Object(value)
            })
            .collect::<Vec<Value>>(),
        // JSON, 1: Shares of the plates below the quantiles
        "quantiles": Statistics::SHARES,
        "files": Destination::names(&file),
    });
    output::print(as_json, &value, |out| {
        let plates: Vec<String> =
            counts().map(|(status, count)| format!("{count} {}", words(status))).collect();
        writeln!(out, "Plates around {}: {}", study.nominal().name(), plates.join(", "))?;
        let results: Vec<(usize, StudyResult)> = study.spec().results().iter().copied().enumerate().collect();
        for shown in results.chunks(RESULTS_IN_A_TABLE) {
            let words = shown.iter().flat_map(|(_, result)| [heading(*result), "deviation", "5 to 95 %"]);
            let header = ["Turning point", "Frequency"].into_iter().chain(words).map(str::to_owned).collect();
            let row = |(place, (place_m, frequency_hz)): (usize, (&f64, &f64))| {
                let cells =
                    shown.iter().flat_map(|(number, result)| cells(*result, summary.of(*number, place)));
                [show_place(*place_m), show_frequency(*frequency_hz)].into_iter().chain(cells).collect()
            };
            output::table(
                out,
                &std::iter::once(header).chain(places().map(row)).collect::<Vec<Vec<String>>>(),
            )?;
        }
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
        let plates_at_once = match study.spec().kind() {
            Kind::OneMode => PLATES_AT_ONCE,
            Kind::Plane => 1,
        };
        run_in_order(study, threads, plates_at_once, |chunk| {
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

/// The fields of a result's statistics at a place: `shift_mean_m`, `shift_deviation_m`, `shift_quantiles_m`.
fn fields(result: StudyResult, found: Option<Statistics>) -> [(String, Value); 3] {
    let unit = result.unit().to_lowercase();
    let stem = result.name().trim_end_matches(&unit).trim_end_matches('_');
    let stem = stem.trim_start_matches("turning_point_");
    // JSON `contrast_deviation_db`: Standard deviation of the contrast; null for a single plate
    // JSON `contrast_mean_db`: Mean contrast of the nominal plate's solid area; null where no plate has one
    // JSON `contrast_quantiles_db`: Quantiles of the contrast, in the order of `quantiles`
    // JSON `crest_deviation_db`: Standard deviation of the crest; null for a single plate
    // JSON `crest_mean_db`: Mean of the peak over the RMS amplitude before the turning point; null where no plate has a peak
    // JSON `crest_quantiles_db`: Quantiles of the crest, in the order of `quantiles`
    // JSON `felt_edge_deviation_m`: Standard deviation of the felt edge; null for a single plate
    // JSON `felt_edge_mean_m`: Mean place where the sensation ends; null where it ends on no plate
    // JSON `felt_edge_quantiles_m`: Quantiles of the felt edge, in the order of `quantiles`
    // JSON `peak_shift_deviation_m`: Standard deviation of the peak's shift; null for a single plate
    // JSON `peak_shift_mean_m`: Mean distance of the peak from that of the same tone on the nominal plate
    // JSON `peak_shift_quantiles_m`: Quantiles of the peak's shift, in the order of `quantiles`
    // JSON `ripple_deviation_db`: Standard deviation of the ripple; null for a single plate
    // JSON `ripple_mean_db`: Mean ripple of the nominal plate's solid area; null where no plate has one
    // JSON `ripple_quantiles_db`: Quantiles of the ripple, in the order of `quantiles`
    // JSON `level_deviation_db`: Standard deviation of the level; null for a single plate
    // JSON `level_mean_db`: Mean of the peak over the nominal plate's peak; null where no plate has a peak
    // JSON `level_quantiles_db`: Quantiles of the level, in the order of `quantiles`
    // JSON `shift_deviation_m`: Standard deviation of the shift; null for a single plate
    // JSON `shift_mean_m`: Mean distance of the turning point from that of the same tone on the nominal plate
    // JSON `shift_quantiles_m`: Quantiles of the shift, in the order of `quantiles`
    [
        (format!("{stem}_mean_{unit}"), json!(found.map(|it| it.mean))),
        (format!("{stem}_deviation_{unit}"), json!(found.and_then(|it| it.standard_deviation))),
        (format!("{stem}_quantiles_{unit}"), json!(found.map(|it| it.quantiles))),
    ]
}

const fn heading(result: StudyResult) -> &'static str {
    match result {
        StudyResult::TurningPointShift => "Shift",
        StudyResult::Level => "Level",
        StudyResult::PeakShift => "Peak's shift",
        StudyResult::FeltEdge => "Felt edge",
        StudyResult::Contrast => "Contrast",
        StudyResult::Ripple => "Ripple",
        StudyResult::Crest => "Crest",
    }
}

/// Mean, deviation and quantiles of a result at a place.
fn cells(result: StudyResult, found: Option<Statistics>) -> [String; 3] {
    let Some(found) = found else { return ["-"; 3].map(str::to_owned) };
    let show = |value: f64| match result {
        StudyResult::FeltEdge => show_place(value),
        StudyResult::TurningPointShift | StudyResult::PeakShift => show_length(value),
        StudyResult::Level | StudyResult::Contrast | StudyResult::Ripple | StudyResult::Crest => {
            format!("{} dB", with_decimals(value, 2))
        }
    };
    let [low, _, high] = found.quantiles.map(show);
    let deviation =
        |value: f64| if result == StudyResult::FeltEdge { show_length(value) } else { show(value) };
    let deviation = found.standard_deviation.map_or_else(|| "-".to_owned(), deviation);
    [show(found.mean), deviation, format!("{low} to {high}")]
}
