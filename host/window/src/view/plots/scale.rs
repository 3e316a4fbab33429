//! The scales of the plots: linear or logarithmic marks.

use egui_plot::{GridInput, GridMark};
use slipline_plate::quantity::ticks::{self, Ticks};

/// The least distance of grid lines, in points.
pub(super) const GRID: f32 = 8.0;
/// Marks of a decade on a logarithmic axis.
const IN_A_DECADE: [f64; 3] = [1.0, 2.0, 5.0];
/// An axis that ends at less than this many times its start has linear marks, though it is logarithmic.
const NARROW: f64 = 8.0;

/// Round values along an axis for labels, at least two. The last `end` points get none.
pub(super) fn marks(input: &GridInput, spacing: f64, end: f64) -> Vec<GridMark> {
    let per_point = input.base_step_size / f64::from(GRID);
    let (low, high) = input.bounds;
    let ticks = Ticks::between(low, high - end * per_point, spacing * per_point);
    ticks.places.iter().map(|&value| GridMark { value, step_size: ticks.step }).collect()
}

/// Round frequencies along an axis of their decimal logarithm, at least `spacing` points apart.
pub(super) fn decades(input: &GridInput, spacing: f64, end: f64) -> Vec<GridMark> {
    let per_point = input.base_step_size / f64::from(GRID);
    let (low, high) = (input.bounds.0, input.bounds.1 - end * per_point);
    let least = spacing * per_point;
    let (from, to) = (10f64.powf(low), 10f64.powf(high));
    let places: Vec<f64> = if to < NARROW * from {
        // The step that fits at the upper end, where the marks lie closest.
        Ticks::between(from, to, (to * least).min(0.5 * (to - from))).places
    } else {
        let decades = low.floor() as i32..=high.ceil() as i32;
        decades.flat_map(|decade| IN_A_DECADE.map(|digit| digit * 10f64.powi(decade))).collect()
    };
    let mut marks: Vec<GridMark> = Vec::new();
    for value in places.into_iter().map(f64::log10).filter(|value| (low..=high).contains(value)) {
        if marks.last().is_none_or(|last| value - last.value >= least) {
            marks.push(GridMark { value, step_size: 1.0 });
        }
    }
    marks
}

/// The frequency at a mark of [`decades`], with at most three digits.
pub(super) fn decade_label(mark: GridMark, unit: &str, scale: f64) -> String {
    let value = 10f64.powf(mark.value) * scale;
    let step = 10f64.powf(value.log10().floor() - 2.0);
    let label = ticks::label(value, step.min(1.0));
    let label = if label.contains('.') { label.trim_end_matches('0').trim_end_matches('.') } else { &label };
    format!("{label} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_has_round_labels_at_every_zoom() {
        let input = |low: f64, high: f64| GridInput {
            bounds: (low.log10(), high.log10()),
            base_step_size: (high / low).log10() / 300.0 * f64::from(GRID),
        };
        let labels = |low, high| -> Vec<String> {
            let marks = decades(&input(low, high), 56.0, 0.0);
            marks.into_iter().map(|mark| decade_label(mark, "Hz", 1.0)).collect()
        };
        assert_eq!(labels(20.0, 650.0), ["20 Hz", "50 Hz", "100 Hz", "200 Hz", "500 Hz"]);
        assert_eq!(labels(1.0, 1e6).first().map(String::as_str), Some("1 Hz"));
        for (low, high) in [(100.0, 200.0), (136.0, 140.0), (20.0, 170.0)] {
            assert!(labels(low, high).len() >= 2, "{low} {high}: {:?}", labels(low, high));
        }
    }
}
