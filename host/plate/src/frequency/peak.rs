//! The turning-point peak of an amplitude on a grid.

use crate::definition::plate::Plate;
use num_complex::Complex64;

/// The turning-point peak of an amplitude over x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Position, metres.
    pub position_m: f64,
    /// Height, in the unit of the amplitude.
    pub amplitude: f64,
    /// Whether it is the largest amplitude on the plate (with loss, the driven end may be larger).
    pub is_largest: bool,
}

impl Peak {
    /// The turning-point peak of a measured field: `field` holds the complex amplitude of a tone at positions uniform
    /// from 0 to the plate's end.
    ///
    /// `None` if the field has no such peak, if the frequency does not enter, or if there are fewer than 3 positions.
    pub fn of(field: &[Complex64], plate: &Plate, frequency_hz: f64) -> Option<Self> {
        let turning_point_m = plate.turning_point_m(frequency_hz)?;
        let kappa = plate.kappa_per_m(frequency_hz)?;
        let intervals = field.len().checked_sub(1).filter(|&intervals| intervals >= 2)?;
        find(field, plate.length_m() / intervals as f64, turning_point_m, kappa)
    }
}

/// Finds the last local maximum of |f| between 3.3/kappa before the turning point and 0.5/kappa beyond it.
///
/// The Airy peak lies 1.019/kappa before the turning point and the first node 2.338/kappa. Loss shifts the maximum
/// toward the drive and then removes it; a maximum farther away than 3.3/kappa belongs to another antinode. `None` if
/// |f| has no interior maximum there, or one less than 0.1 % above the minimum before it.
pub(crate) fn find(field: &[Complex64], step_m: f64, turning_point_m: f64, kappa: f64) -> Option<Peak> {
    let square: Vec<f64> = field.iter().map(Complex64::norm_sqr).collect();
    find_in_squares(&square, step_m, turning_point_m, kappa)
}

/// [`find`] on squared magnitudes.
pub(crate) fn find_in_squares(square: &[f64], step_m: f64, turning_point_m: f64, kappa: f64) -> Option<Peak> {
    let last = square.len().checked_sub(2)?;
    let near = turning_point_m - 3.3 / kappa;
    let far = turning_point_m + 0.5 / kappa;
    let index = |place: f64| (place / step_m).clamp(0.0, last as f64) as usize;
    let (first, end) = (index(near).max(1), index(far));
    let top = (first..=end).rev().find(|&i| square[i] >= square[i - 1] && square[i] > square[i + 1])?;
    let valley = square[..top].iter().rev().scan(square[top], |above, &value| {
        // Follow the amplitude toward the drive while it falls.
        (value <= *above).then(|| {
            *above = value;
            value
        })
    });
    let valley = valley.last().unwrap_or(square[top]);
    if valley > square[top] * (1.0 - 2e-3) {
        return None;
    }
    let (offset, height) = vertex(square, top);
    let amplitude = height.sqrt();
    let largest = square.iter().copied().fold(0.0, f64::max);
    Some(Peak {
        position_m: (top as f64 + offset) * step_m,
        amplitude,
        is_largest: height >= largest * (1.0 - 1e-6),
    })
}

/// |f| at a position between grid points, by quadratic interpolation of the complex f; 0 outside the grid.
pub(crate) fn amplitude_at(field: &[Complex64], step_m: f64, place_m: f64) -> f64 {
    let at = place_m / step_m;
    if !(at >= 0.0 && at <= (field.len() - 1) as f64) {
        return 0.0;
    }
    let middle = (at.round() as usize).clamp(1, field.len() - 2);
    let t = at - middle as f64;
    let f = |i: usize| field[i];
    let slope = (f(middle + 1) - f(middle - 1)) * 0.5;
    let curvature = f(middle + 1) - f(middle) * 2.0 + f(middle - 1);
    (f(middle) + slope * t + curvature * (0.5 * t * t)).norm()
}

/// Offset from the grid point `top`, in steps, and value of the maximum near it: of a quartic through five points, or
/// of a parabola through three at the ends of the grid.
fn vertex(square: &[f64], top: usize) -> (f64, f64) {
    let value = |i: usize| square[i];
    if top >= 2 && top + 2 < square.len() {
        let (a, b, c, d, e) = (value(top - 2), value(top - 1), value(top), value(top + 1), value(top + 2));
        // Central differences of fourth order give the Taylor polynomial about `top`.
        let first = (a - 8.0 * b + 8.0 * d - e) / 12.0;
        let second = (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 12.0;
        let third = (-a + 2.0 * b - 2.0 * d + e) / 2.0;
        let fourth = a - 4.0 * b + 6.0 * c - 4.0 * d + e;
        let slope = |t: f64| first + t * (second + t * (third / 2.0 + t * fourth / 6.0));
        let curvature_at = |t: f64| second + t * (third + t * fourth / 2.0);
        let mut t = 0.0;
        for _ in 0..8 {
            let curvature = curvature_at(t);
            if curvature < 0.0 {
                t = (t - slope(t) / curvature).clamp(-1.0, 1.0);
            }
        }
        return (t, c + t * (first + t * (second / 2.0 + t * (third / 6.0 + t * fourth / 24.0))));
    }
    let (b, c, d) = (value(top - 1), value(top), value(top + 1));
    let curvature = b - 2.0 * c + d;
    let t = if curvature < 0.0 { (0.5 * (b - d) / curvature).clamp(-1.0, 1.0) } else { 0.0 };
    (t, c - 0.25 * (b - d) * t)
}
