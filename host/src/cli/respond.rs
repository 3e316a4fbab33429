//! `slipline respond`.

use super::destination::Destination;
use super::{Failure, RespondArguments, argument, differs, output};
use serde_json::{Value, json};
use slipline_model::export::figures::response_figure;
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity::{Measure, show_frequency, show_place};
use slipline_plate::{
    Complex64, Equation, Finger, Plate, Response, TurningWidth, plane, reflection, respond_range,
    respond_touched,
};

pub(super) fn run(arguments: &RespondArguments, as_json: bool) -> Result<(), Failure> {
    if arguments.two_dimensions && arguments.paper_mode {
        return Err(Failure::Usage(
            "--paper-mode cannot be used with --2d: the paper's equation leaves out a term of the one-mode equation, and \
             the plate in two dimensions has all of them"
                .to_owned(),
        ));
    }
    let mut plate = argument::plate(&arguments.plate.plate)?;
    let equation = if arguments.paper_mode { Equation::Paper } else { Equation::Corrected };
    if arguments.paper_mode {
        // The allowed frequencies are the paper's as well.
        plate = plate.in_vacuum().with_turning_width(TurningWidth::Plain);
    }
    let on_plate = format!(" on the plate {:?}", plate.name());
    let frequency_hz =
        arguments.freq.within("--freq", respond_range(&plate), Measure::Frequency, &on_plate)?;
    let figure = arguments.figure.as_ref();
    let figure_file = figure.map(|figure| figure.destination(arguments.force)).transpose()?;
    let finger = arguments.finger.and_then(|argument| argument.0);
    let one_mode = respond_touched(&plate, finger.as_ref(), frequency_hz, arguments.points, equation)
        .map_err(Failure::refused)?;
    let (response, differs) = if arguments.two_dimensions {
        let (response, differs) = in_two_dimensions(&plate, finger, one_mode, arguments.points)?;
        (response, Some(differs))
    } else {
        (one_mode, None)
    };
    if let Some((figure, file)) = figure.zip(figure_file.as_ref()) {
        figure.write(file, &response_figure(&response, plate.name()))?;
    }
    let peak = response.peak;
    let mut value = json!({
        "plate": plate.name(),
        "frequency_hz": response.frequency_hz,
        "paper_mode": arguments.paper_mode,
        "position_m": response.position_m,
        "amplitude": response.amplitude.iter().map(|f| json!({ "re": f.re, "im": f.im })).collect::<Vec<_>>(),
        "turning_width": plate.spec().turning_width.word(),
        "turning_point_m": response.turning_point_m,
        "peak_present": peak.is_some(),
        "peak_position_m": peak.map(|peak| peak.position_m),
        "peak_amplitude": peak.map(|peak| peak.amplitude),
        "edge_width_m": response.edge_width_m,
        "files": Destination::names(&figure_file),
    });
    if let Some(differs) = &differs {
        value["two_dimensions"] = differs.as_json();
    }
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
        lines.extend(differs.iter().flat_map(Differs::as_lines));
        output::lines(out, &lines)
    })
}

/// Differences between the field in two dimensions and that of the one-mode equation.
struct Differs {
    comparison: plane::Comparison,
    /// Magnitude of the reflection at the driven end, by the one-mode equation and in two dimensions.
    reflection: [Option<f64>; 2],
}

/// The field in two dimensions at the frequency of a field of the one-mode equation, and their differences.
fn in_two_dimensions(
    plate: &Plate,
    finger: Option<Finger>,
    one_mode: Response,
    points: usize,
) -> Result<(Response, Differs), Failure> {
    let setup = plane::Setup { finger, ..plane::Setup::of(plate) };
    let frequency_hz = one_mode.frequency_hz;
    let response = plane::respond(plate, frequency_hz, points, &setup).map_err(Failure::refused)?;
    let in_plane = plane::reflection(plate, frequency_hz, &setup).map_err(Failure::refused)?;
    let reflection = [reflection(plate, frequency_hz), Some(in_plane)].map(|r| r.map(Complex64::norm));
    let comparison = plane::Comparison::of(&one_mode, &response);
    Ok((response, Differs { comparison, reflection }))
}

impl Differs {
    fn as_json(&self) -> Value {
        let Self { comparison, reflection } = self;
        let mut value = differs::value(comparison);
        value["reflection"] = json!(reflection[1]);
        value["one_mode_reflection"] = json!(reflection[0]);
        value
    }

    fn as_lines(&self) -> [(&'static str, String); 3] {
        let plane::Comparison { nodes, .. } = self.comparison;
        let share = |reflection: Option<f64>| {
            reflection.map_or_else(|| "unknown".to_owned(), |share| with_decimals(share, 2))
        };
        let [one_mode, in_plane] = self.reflection.map(share);
        [
            ("Peak in 2-D", differs::peak(&self.comparison)),
            ("Nodes", format!("{} (one mode: {})", nodes[1], nodes[0])),
            ("Reflection", format!("{in_plane} at the driven end (one mode: {one_mode})")),
        ]
    }
}
