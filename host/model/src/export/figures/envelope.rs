//! The envelope along the plate: the prediction of the frequency domain, the result of the simulated plate, and
//! the boundary of each tone.

use super::drawing::Drawing;
use super::legend::Sample;
use super::page::{HUES, Pen, Place};
use super::plot::{Curve, Plot, TEXT, Upright};
use crate::field::simulation::Simulated;
use crate::field::steady_field::displacement_unit;

/// Places of the simulated plate per dot; with a dot at every place the dots would overlap.
const STEP: usize = 6;

/// Draws the RMS displacement along the plate with this name.
#[must_use]
pub fn envelope_figure(result: &Simulated, plate: &str) -> Drawing {
    let measured = result.rms_m.iter().map(|&rms_m| f64::from(rms_m));
    let predicted = result.predicted_rms_m.iter().copied();
    let highest_m = measured.clone().chain(predicted.clone()).fold(0.0, f64::max);
    let top_m = if highest_m > 0.0 { 1.08 * highest_m } else { 1e-6 };
    let (unit, unit_m) = displacement_unit(top_m);
    let points = |rms_m: &mut dyn Iterator<Item = f64>| -> Vec<Place> {
        let places = result.position_m.iter().zip(rms_m);
        places.map(|(&x_m, rms_m)| (x_m * 1e3, rms_m / unit_m)).collect()
    };
    let length_m = result.position_m.last().copied().unwrap_or(1.0);
    let boundaries = result.tones.iter().enumerate().map(|(number, tone)| Upright {
        name: (number == 0).then(|| "turning point".to_owned()),
        x: tone.predicted.turning_point_m * 1e3,
        pen: Pen::solid(HUES[5], 0.8),
    });
    let plot = Plot {
        x: (0.0, length_m * 1e3),
        y: (0.0, top_m / unit_m),
        x_name: "x from the driven end (mm)",
        y_name: &format!("RMS displacement ({unit})"),
        curves: vec![
            Curve {
                name: Some("simulated plate".to_owned()),
                sample: Sample::Dot(HUES[1], 1.2),
                points: points(&mut measured.clone()).into_iter().step_by(STEP).collect(),
            },
            Curve {
                name: Some("frequency domain".to_owned()),
                sample: Sample::Line(Pen::solid(HUES[0], 1.0)),
                points: points(&mut predicted.clone()),
            },
        ],
        uprights: boundaries.collect(),
        text: TEXT,
    };
    plot.printed(&format!("{plate}: RMS displacement along the plate"))
}
