//! Figures of quality of a texture.

use super::target::{STILL_FROM_EDGE_WIDTHS, Target, Wanted};

/// Deviation of a field from its target, and for solid areas its ripple and contrast.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Figures {
    /// Root mean square error of the RMS amplitude over the places with weight, over the largest wanted amplitude; 0 is
    /// exact.
    pub rms_error: f64,
    /// Solid areas: ratio of largest to smallest RMS amplitude from 10 mm to 1.3 edge widths before the turning point,
    /// dB. `None` for other targets.
    pub ripple_db: Option<f64>,
    /// Solid areas: ratio of the mean square there to that 1.4 edge widths past the turning point, or at the plate's
    /// end if that is nearer, dB. `None` for other targets.
    pub contrast_db: Option<f64>,
}

impl Figures {
    /// The figures of a field with these mean squares at the palette's places, in units of the largest wanted mean
    /// square.
    pub(crate) fn of(squares: &[f64], places_m: &[f64], target: &Target) -> Self {
        let counted = || target.weight.iter().map(|&weight| if weight > 0.0 { 1.0 } else { 0.0 });
        let errors =
            squares.iter().zip(&target.wanted).map(|(square, wanted)| (square.sqrt() - wanted).powi(2));
        let sum: f64 = errors.zip(counted()).map(|(error, counts)| error * counts).sum();
        let rms_error = (sum / counted().sum::<f64>()).sqrt();
        let (Wanted::Solid { turning_point_m, edge_width_m }, Some(even)) =
            (target.wanted_kind, target.even_m())
        else {
            return Self { rms_error, ripple_db: None, contrast_db: None };
        };
        let area: Vec<f64> = places_m
            .iter()
            .zip(squares)
            .filter(|(x, _)| even.contains(x))
            .map(|(_, &square)| square)
            .collect();
        let (low, high) =
            area.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &s| (low.min(s), high.max(s)));
        let mean = area.iter().sum::<f64>() / area.len() as f64;
        let still_m = turning_point_m + STILL_FROM_EDGE_WIDTHS * edge_width_m;
        let still = interpolated(squares, places_m, still_m.min(places_m[places_m.len() - 1]));
        Self {
            rms_error,
            ripple_db: Some(10.0 * (high / low).log10()),
            contrast_db: Some(10.0 * (mean / still).log10()),
        }
    }
}

/// The value at `x` on the plate, by linear interpolation of the logarithm, because the field falls by decades there.
fn interpolated(values: &[f64], places_m: &[f64], x: f64) -> f64 {
    let after = places_m.partition_point(|&place| place < x).clamp(1, places_m.len() - 1);
    let before = after - 1;
    let share = (x - places_m[before]) / (places_m[after] - places_m[before]);
    let log = |at: usize| values[at].max(f64::MIN_POSITIVE).ln();
    (log(before) * (1.0 - share) + log(after) * share).exp()
}
