//! `slipline respond`.

use super::{Failure, RespondArguments, argument, output};
use serde_json::json;
use slipline_model::export::figures::response_figure;
use slipline_plate::number_format::with_decimals;
use slipline_plate::quantity::{Measure, show_frequency, show_place};
use slipline_plate::{Equation, respond, respond_range};

pub(super) fn run(arguments: &RespondArguments, as_json: bool) -> Result<(), Failure> {
    let plate = argument::plate(&arguments.plate.plate)?;
    let equation = if arguments.paper_mode { Equation::Paper } else { Equation::Corrected };
    let on_plate = format!(" on the plate {:?}", plate.name());
    let frequency_hz =
        arguments.freq.within("--freq", respond_range(&plate), Measure::Frequency, &on_plate)?;
    let figure = arguments.figure.as_ref();
    let figure_file = figure.map(|figure| figure.destination(arguments.force)).transpose()?;
    let response = respond(&plate, frequency_hz, arguments.points, equation).map_err(Failure::usage)?;
    if let Some((figure, file)) = figure.zip(figure_file) {
        figure.write(&file, &response_figure(&response, plate.name()))?;
    }
    let peak = response.peak;
    let value = json!({
        "plate": plate.name(),
        "frequency_hz": response.frequency_hz,
        "paper_mode": arguments.paper_mode,
        "position_m": response.position_m,
        "amplitude": response.amplitude.iter().map(|f| json!({ "re": f.re, "im": f.im })).collect::<Vec<_>>(),
        "turning_point_m": response.turning_point_m,
        "peak_present": peak.is_some(),
        "peak_position_m": peak.map(|peak| peak.position_m),
        "peak_amplitude": peak.map(|peak| peak.amplitude),
        "edge_width_m": response.edge_width_m,
    });
    output::print(as_json, &value, |out| {
        let peak_line = peak.map_or_else(
            || "none: the wave has died out before its turning point".to_owned(),
            |peak| {
                let largest = if peak.is_largest { "" } else { ", not the largest on the plate" };
                let times = with_decimals(peak.amplitude, 3);
                format!("{}, {times} times the drive{largest}", show_place(peak.position_m))
            },
        );
        output::lines(
            out,
            &[
                ("Plate", plate.name().to_owned()),
                ("Frequency", show_frequency(response.frequency_hz)),
                ("Turning point", show_place(response.turning_point_m)),
                ("Peak", peak_line),
                ("Edge width", format!("{} (peak to a tenth)", show_place(response.edge_width_m))),
                ("Places", response.position_m.len().to_string()),
            ],
        )
    })
}
