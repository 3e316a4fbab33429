//! Differences of two computations of one plate.

use crate::frequency::Response;
use crate::quantity::decibels;

/// A node is a minimum of |f| that is at most this fraction of the maxima on both sides of it.
const NODE_DEPTH: f64 = 0.95;

/// The differences of the second of two fields from the first, at one frequency.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Comparison {
    /// Position of the second peak minus that of the first, metres; `None` if one of them has none.
    pub peak_shift_m: Option<f64>,
    /// Level of the second peak over that of the first, dB.
    pub level_db: Option<f64>,
    /// Minima of |f| between drive and peak (or turning point, without a peak) of each.
    pub nodes: [usize; 2],
}

impl Comparison {
    /// Compares two fields on points dense enough to resolve the nodes (10 per wavelength).
    #[must_use]
    pub fn of(first: &Response, second: &Response) -> Self {
        let peaks = first.peak.zip(second.peak);
        Self {
            peak_shift_m: peaks.map(|(first, second)| second.position_m - first.position_m),
            level_db: peaks.map(|(first, second)| decibels(second.amplitude / first.amplitude)),
            nodes: [first, second].map(nodes),
        }
    }
}

/// Minima of |f| before the peak, with a higher maximum on both sides. The driven end itself counts as a maximum.
fn nodes(response: &Response) -> usize {
    let end_m = response.peak.map_or(response.turning_point_m, |peak| peak.position_m);
    let before: Vec<f64> = response
        .position_m
        .iter()
        .zip(&response.amplitude)
        .take_while(|(position_m, _)| **position_m <= end_m)
        .map(|(_, f)| f.norm())
        .collect();
    let Some(&start) = before.first() else { return 0 };
    // The lowest value since the last maximum, or the highest since the last minimum.
    let (mut count, mut high, mut low, mut falls) = (0, start, start, true);
    for &amplitude in &before {
        if falls {
            low = low.min(amplitude);
            if low < NODE_DEPTH * high.min(amplitude) {
                count += 1;
                (falls, high) = (false, amplitude);
            } else if amplitude > high {
                (high, low) = (amplitude, amplitude);
            }
        } else {
            high = high.max(amplitude);
            if amplitude < NODE_DEPTH * high {
                (falls, low) = (true, amplitude);
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Complex64, Peak};

    /// |cos(k x)| over x = 0..0.1 with its peak at 0.1, its nodes filled to `floor`.
    fn response(nodes: f64, floor: f64, amplitude: f64, peak_m: Option<f64>) -> Response {
        let position_m: Vec<f64> = (0..=400).map(|i| f64::from(i) * 0.1 / 400.0).collect();
        let wave =
            |x: &f64| Complex64::new((nodes * std::f64::consts::PI * x / 0.1).cos(), floor) * amplitude;
        Response {
            frequency_hz: 100.0,
            amplitude: position_m.iter().map(wave).collect(),
            position_m,
            turning_point_m: 0.1,
            edge_width_m: 0.01,
            peak: peak_m.map(|position_m| Peak { position_m, amplitude, is_largest: true }),
            amplitude_at_turning_point: 0.0,
        }
    }

    #[test]
    fn fields_differ_by_place_level_and_nodes() {
        let differs =
            Comparison::of(&response(4.0, 0.1, 1.0, Some(0.1)), &response(7.0, 0.0, 2.0, Some(0.098)));
        assert!((differs.peak_shift_m.unwrap() + 0.002).abs() < 1e-12);
        assert!((differs.level_db.unwrap() - 6.0206).abs() < 1e-4);
        assert_eq!(differs.nodes, [4, 7]);
    }

    #[test]
    fn what_has_no_peak_has_no_shift_and_filled_nodes_are_none() {
        let differs = Comparison::of(&response(4.0, 0.1, 1.0, None), &response(4.0, 4.0, 1.0, Some(0.1)));
        assert_eq!((differs.peak_shift_m, differs.level_db, differs.nodes), (None, None, [4, 0]));
    }
}
