//! `slipline respond`.

use super::argument::{self, FingerArgument, PlateArgument, Typed};
use super::destination::{Destination, ForceArgument};
use super::failure::Failure;
use super::figure_file::{FigureFile, figure_file};
use super::schema::with_files;
use super::{differs, output};
use clap::Args;
use serde_json::json;
use slipline_model::answer::respond::{Differences, FieldRequest, plate_of, solve};
use slipline_model::export::figures::response_figure;
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{Measure, show_frequency, show_place};
use slipline_plate::{POINTS_MAX, POINTS_MIN, plane, respond_range};

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

pub(super) fn run(arguments: &RespondArguments, as_json: bool) -> Result<(), Failure> {
    if arguments.two_dimensions && arguments.paper_mode {
        return Err(Failure::usage(
            "--paper-mode cannot be used with --2d: the paper's equation leaves out a term of the one-mode equation, and \
             the plate in two dimensions has all of them",
        ));
    }
    let file = arguments.plate.read()?;
    // The allowed frequencies are the paper's as well.
    let plate = plate_of(&file, arguments.paper_mode);
    let on_plate = format!(" on the plate {:?}", plate.name());
    let frequency_hz =
        arguments.freq.within("--freq", respond_range(&plate), Measure::Frequency, &on_plate)?;
    let figure = arguments.figure.as_ref();
    let figure_file = figure.map(|figure| figure.destination(arguments.force)).transpose()?;
    let asked = FieldRequest {
        frequency_hz,
        points: arguments.points,
        finger: arguments.finger.and_then(|argument| argument.0),
        paper_mode: arguments.paper_mode,
        two_dimensions: arguments.two_dimensions,
    };
    let solved = solve(&file, &asked).map_err(Failure::refused)?;
    let response = &solved.response;
    if let Some((figure, file)) = figure.zip(figure_file.as_ref()) {
        figure.write(file, &response_figure(response, plate.name()))?;
    }
    let peak = response.peak;
    let value = with_files(json!(solved.answer()), Destination::names(&figure_file));
    output::print(as_json, &value, |out| {
        let peak_line = peak.map_or_else(
            || "none: the wave has died out before its turning point".to_owned(),
            |peak| {
                let largest = if peak.is_largest { "" } else { ", not the largest on the plate" };
                let times = with_decimals(peak.amplitude, 3);
                format!("{}, {times} times the drive{largest}", show_place(peak.position_m))
            },
        );
        let width = plate.spec().turning_width.words();
        let mut lines = vec![
            ("Plate", plate.name().to_owned()),
            ("Frequency", show_frequency(response.frequency_hz)),
            ("Turning point", format!("{}, by the width {width}", show_place(response.turning_point_m))),
            ("Peak", peak_line),
            ("Edge width", format!("{} (peak to a tenth)", show_place(response.edge_width_m))),
            ("Places", response.position_m.len().to_string()),
        ];
        lines.extend(solved.differences.iter().flat_map(lines_of));
        output::lines(out, &lines)
    })
}

/// The differences between the field in two dimensions and that of the one-mode equation.
fn lines_of(Differences { comparison, reflection }: &Differences) -> [(&'static str, String); 3] {
    let plane::Comparison { nodes, .. } = comparison;
    let share = |reflection: &Option<f64>| {
        reflection.map_or_else(|| "unknown".to_owned(), |share| with_decimals(share, 2))
    };
    let [one_mode, in_plane] = reflection.each_ref().map(share);
    [
        ("Peak in 2-D", differs::peak(comparison)),
        ("Nodes", format!("{} (one mode: {})", nodes[1], nodes[0])),
        ("Reflection", format!("{in_plane} at the driven end (one mode: {one_mode})")),
    ]
}
