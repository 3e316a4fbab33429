//! `slipline merit`.

use super::argument::{self, PlateArgument};
use super::failure::Failure;
use super::tones::GoneArgument;
use super::{output, progress};
use argument::PlaceArgument;
use clap::Args;
use serde_json::json;
use slipline_model::answer::merit::{MeritAnswer, rate};
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{show_length, show_place, show_si};
use slipline_plate::texture::Palette;

/// `merit`.
#[derive(Debug, Args)]
pub struct MeritArguments {
    #[command(flatten)]
    plate: PlateArgument,
    /// One boundary, by its turning point (120mm) or its frequency (126Hz); by default, five over the span.
    #[arg(long, value_name = "X", value_parser = argument::place_or_frequency, allow_hyphen_values = true)]
    turning_point: Option<PlaceArgument>,
    #[command(flatten)]
    gone: GoneArgument,
}

pub(super) fn run(arguments: &MeritArguments, as_json: bool) -> Result<(), Failure> {
    let plate = arguments.plate.read()?;
    arguments.gone.refuse("--felt-edge of drive, simulate and record")?;
    let one = arguments.turning_point.as_ref();
    let one = one.map(|place| place.turning_point_on(&plate, "--turning-point")).transpose()?;
    let (table, _) = progress::table_for(&plate, SAMPLE_RATE_HZ)?;
    let palette = Palette::new(&plate, &table);
    let merits =
        progress::watched("merit", |progress| rate(&palette, one, progress)).map_err(Failure::refused)?;
    output::print(as_json, &json!(MeritAnswer::of(&plate, &merits)), |out| {
        writeln!(
            out,
            "{:>13} {:>9} {:>7} {:>8} {:>10} {:>10} {:>8}",
            "turning point", "contrast", "ripple", "edge", "switching", "two-point", "bit/s"
        )?;
        for merit in &merits {
            let unknown = || "-".to_owned();
            writeln!(
                out,
                "{:>13} {:>9} {:>7} {:>8} {:>10} {:>10} {:>8}",
                show_place(merit.turning_point_m),
                format!("{} dB", with_decimals(merit.contrast_db, 0)),
                format!("{} dB", with_decimals(merit.ripple_db, 1)),
                show_length(merit.edge_width_m),
                merit.switching_time_s.map_or_else(unknown, |time_s| show_si(time_s, "s")),
                merit.two_point_m.map_or_else(unknown, show_length),
                merit.bits_per_s.map_or_else(unknown, |bits| with_decimals(bits, 0)),
            )?;
        }
        // Only a plate file with harmonics has this figure.
        for (merit, felt_db) in merits.iter().filter_map(|it| Some((it, it.felt_contrast_db?))) {
            let (place, felt) = (show_place(merit.turning_point_m), with_decimals(felt_db, 0));
            writeln!(out, "With the drive's harmonics the contrast at {place} is felt as {felt} dB.")?;
        }
        Ok(())
    })
}
