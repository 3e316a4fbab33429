//! `slipline table`.

use super::argument::{self, PlateArgument, Typed};
use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::schema::{finished, with_files};
use super::{output, progress};
use clap::Args;
use serde_json::json;
use slipline_model::answer::table::BuiltTable;
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{Measure, show_frequency, show_length, show_place};
use slipline_plate::{KNOTS_MAX, sample_rates};
use std::io::Write;
use std::path::PathBuf;

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

pub(super) fn run(arguments: &TableArguments, as_json: bool) -> Result<(), Failure> {
    let plate = arguments.plate.read()?;
    let file = Destination::perhaps(arguments.out.as_deref(), arguments.force)?;
    let why = format!(": the plate's band ends at {}", show_frequency(plate.band_hz().1));
    let rate_hz =
        arguments.sample_rate.within("--sample-rate", sample_rates(&plate), Measure::Frequency, &why)?;
    let built = progress::watched("table", |progress| {
        BuiltTable::build(&plate, rate_hz, arguments.knots, progress).map_err(Failure::refused)
    })?;
    let value = with_files(json!(built.answer(&plate)), Destination::names(&file));
    let BuiltTable { table, device_table, sensitivity } = &built;
    if let Some(file) = &file {
        file.write(|out| Ok(writeln!(out, "{}", finished(&value))?))?;
    }
    output::print(as_json, &value, |out| {
        let frequency = |knot: Option<&slipline_plate::Knot>| {
            knot.map_or_else(String::new, |knot| show_frequency(knot.frequency_hz))
        };
        let peaks = match table.knots_without_peak() {
            0 => "everywhere".to_owned(),
            count => format!("missing at {count} knots: loss leaves none there"),
        };
        let travel = match table.travel() {
            None => "not limited: the plate file names no peak travel".to_owned(),
            Some(travel) => {
                let lowered = if travel.scale < 1.0 {
                    format!("; lowered by {} dB to keep it", with_decimals(travel.lowered_db(), 1))
                } else {
                    String::new()
                };
                let percent = with_decimals(100.0 * travel.largest_share, 0);
                format!("{percent} % of the peak travel at level 1, at most{lowered}")
            }
        };
        let mut lines = vec![
            ("Plate", plate.name().to_owned()),
            ("Sample rate", show_frequency(rate_hz)),
            ("Span", format!("{} to {}", show_place(table.span_m().0), show_place(table.span_m().1))),
            ("Band", format!("{} to {}", frequency(table.knots().first()), frequency(table.knots().last()))),
            ("Knots", format!("{}, CRC {:08x}", table.knots().len(), device_table.crc())),
            ("Peak at level 1", show_length(table.peak_at_full_scale_m())),
            ("Travel", travel),
            ("Peaks", peaks),
            (
                "Departure",
                format!("{} dB at most between the knots", with_decimals(table.worst_error_db(), 2)),
            ),
            (
                "Without gains",
                format!("{} dB swing over the span", with_decimals(table.swing_without_gain_db(), 1)),
            ),
            (
                "Sensitivity",
                format!(
                    "{} dB per 1 % of wave speed, worst at {}",
                    with_decimals(sensitivity.worst_db, 2),
                    show_place(sensitivity.worst_at_m)
                ),
            ),
        ];
        if let Some(path) = &arguments.out {
            lines.push(("Written to", path.display().to_string()));
        }
        output::lines(out, &lines)
    })
}
