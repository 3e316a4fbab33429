//! `slipline merit`.

use super::tones::GoneArgument;
use super::{Failure, PlateArgument, argument, output, progress};
use argument::PlaceArgument;
use clap::Args;
use serde_json::json;
use slipline_model::field::simulation::SAMPLE_RATE_HZ;
use slipline_plate::Plate;
use slipline_plate::merit::Merit;
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity::{show_length, show_place, show_si};
use slipline_plate::texture::{Palette, TextureError};

/// Number of turning points, each in the middle of an equal share of the span.
const TURNING_POINTS: usize = 5;

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
    let plate = argument::plate(&arguments.plate.plate)?;
    arguments.gone.refuse("--felt-edge of drive, simulate and record")?;
    let one = arguments.turning_point.as_ref();
    let one = one.map(|place| place.turning_point_on(&plate, "--turning-point")).transpose()?;
    let (table, _) = progress::table_for(&plate, SAMPLE_RATE_HZ)?;
    let palette = Palette::new(&plate, &table);
    let merits = match one {
        Some(turning_point_m) => vec![Merit::of(&palette, turning_point_m).map_err(Failure::refused)?],
        None => over_span(&plate, &palette)?,
    };
    let value = json!({
        "plate": plate.name(),
        "turning_points": merits.iter().map(|merit| json!({
            "turning_point_m": merit.turning_point_m,
            "frequency_hz": merit.frequency_hz,
            "contrast_db": merit.contrast_db,
            "ripple_db": merit.ripple_db,
            "edge_width_m": merit.edge_width_m,
            "switching_time_s": merit.switching_time_s,
            "two_point_m": merit.two_point_m,
            "bits_per_s": merit.bits_per_s,
        })).collect::<Vec<_>>(),
    });
    output::print(as_json, &value, |out| {
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
        Ok(())
    })
}

/// Ratings of the boundaries before which there is room for an even area; if there are none, the error of the
/// last one.
fn over_span(plate: &Plate, palette: &Palette<'_>) -> Result<Vec<Merit>, Failure> {
    let (start_m, end_m) = plate.span_m();
    let at = |i: usize| start_m + (end_m - start_m) * (i as f64 + 0.5) / TURNING_POINTS as f64;
    let mut found = Vec::new();
    let mut refused = None;
    for turning_point_m in (0..TURNING_POINTS).map(at) {
        match Merit::of(palette, turning_point_m) {
            Ok(merit) => found.push(merit),
            Err(error @ TextureError::TooShort { .. }) => refused = Some(error),
            Err(error) => return Err(Failure::refused(error)),
        }
    }
    match refused {
        Some(error) if found.is_empty() => Err(Failure::refused(error)),
        _ => Ok(found),
    }
}
