//! The half-width of the plate along x.
//!
//! The plate spans z = -W..+W. Beyond the plate's end the taper is continued, so that the tail of the wave decays as
//! on a longer plate.

use crate::definition::clamped_strip::of_turning_edges;
use crate::definition::error::{Origin, PlateError};
use crate::definition::giving_taper::GivingTaper;
use crate::definition::limits;
use crate::definition::log_width::LogWidth;
use crate::quantity::Range;

/// The law of the half-width W(x); x = 0 is the driven, wide end.
///
/// ```
/// use slipline_plate::{Plate, Taper, preset};
///
/// let mut spec = preset("membrane").unwrap().spec().clone();
/// spec.taper = Taper::Exponential { half_width_m: 0.05, rate_per_m: 4.62 };
/// let plate = Plate::new(spec).unwrap();
/// assert!((plate.half_width_m(0.15) - 0.05 * (-4.62_f64 * 0.15).exp()).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Taper {
    /// W = W0 e^(-d x): the turning point is linear in the logarithm of the frequency.
    Exponential {
        /// Half-width W0 at the driven end, metres (1e-5 to 10).
        half_width_m: f64,
        /// Rate d, 1/m (0.01 to 1000).
        rate_per_m: f64,
    },
    /// W falls linearly from x = 0 to the plate's end.
    Linear {
        /// Half-width at the driven end, metres (1e-5 to 10).
        half_width_m: f64,
        /// Half-width at the narrow end, metres (1e-5 to 0.999 `half_width_m`).
        end_half_width_m: f64,
    },
    /// Measured or drawn points, interpolated by a monotone cubic in ln W, which is exact for an exponential taper.
    Sampled {
        /// 2 to 10 000 pairs `[position_m, half_width_m]`. Positions rise from 0 to at least the plate's length in
        /// steps of at least 1e-6 m; half-widths fall from point to point and are 1e-5 to 10 m.
        points: Vec<[f64; 2]>,
    },
}

impl Taper {
    /// W(x) becomes `scale` W0 (W/W0)^`power`: it changes the width at the driven end by `scale` and ln(W0/W(L)) by
    /// `power`.
    pub(crate) fn stretched(&self, scale: f64, power: f64) -> Self {
        match self {
            Self::Exponential { half_width_m, rate_per_m } => {
                Self::Exponential { half_width_m: scale * half_width_m, rate_per_m: power * rate_per_m }
            }
            Self::Linear { half_width_m, end_half_width_m } => Self::Linear {
                half_width_m: scale * half_width_m,
                end_half_width_m: scale * half_width_m * (end_half_width_m / half_width_m).powf(power),
            },
            Self::Sampled { points } => {
                let start = points.first().map_or(1.0, |point| point[1]);
                let stretched = |[x, width]: &[f64; 2]| [*x, scale * start * (width / start).powf(power)];
                Self::Sampled { points: points.iter().map(stretched).collect() }
            }
        }
    }

    /// Checks that the taper narrows and that its half-widths are in range on a plate of the given length.
    pub(crate) fn validate(&self, length_m: f64) -> Result<(), PlateError> {
        match self {
            Self::Exponential { half_width_m, rate_per_m } => {
                let end = half_width_m * (-rate_per_m * length_m).exp();
                let narrowest = limits::HALF_WIDTH.low;
                if end < narrowest {
                    let steepest = Range::at_most((half_width_m / narrowest).ln() / length_m, "1/m");
                    let origin = Some(Origin::EndHalfWidth(end));
                    return Err(steepest.refuse("taper.rate_per_m", *rate_per_m, origin));
                }
                Ok(())
            }
            Self::Linear { half_width_m, end_half_width_m } => {
                let end = Range { high: 0.999 * half_width_m, ..limits::HALF_WIDTH };
                end.check("taper.end_half_width_m", *end_half_width_m)
            }
            Self::Sampled { points } => validate_points(points, length_m),
        }
    }
}

fn validate_points(points: &[[f64; 2]], length_m: f64) -> Result<(), PlateError> {
    limits::TAPER_POINTS.check("taper.points", points.len())?;
    for (index, [position_m, half_width_m]) in points.iter().copied().enumerate() {
        limits::TAPER_PLACE.check(format_args!("taper.points[{index}][0]"), position_m)?;
        limits::HALF_WIDTH.check(format_args!("taper.points[{index}][1]"), half_width_m)?;
        if let Some([before_m, wider_m]) = index.checked_sub(1).map(|before| points[before])
            && (position_m - before_m < 1e-6 || half_width_m >= wider_m)
        {
            return Err(PlateError::NotNarrowing { index, position_m, half_width_m });
        }
    }
    let (first, last) = (points[0][0], points[points.len() - 1][0]);
    Range::new(0.0, 0.0, "m").check_from(Origin::DrivenEnd, "taper.points[0][0]", first)?;
    if last < length_m * (1.0 - 1e-9) {
        let field = format!("taper.points[{}][0]", points.len() - 1);
        return Err(Range::at_least(length_m, "m").refuse(&field, last, Some(Origin::Length(length_m))));
    }
    Ok(())
}

/// Intervals over the plate of a curve that follows from a taper: its cubics are right to 1e-11 and better.
const INTERVALS: usize = 512;
/// How far the curve goes on before the driven end and beyond the plate's end, over the length.
const BEYOND: (f64, f64) = (0.05, 1.0);
/// It ends before the edges meet.
const REACH: f64 = 0.99;

/// The taper prepared for evaluation; the slopes of a sampled taper are computed once.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum WidthLaw {
    Exponential { log_width: f64, rate_per_m: f64 },
    Linear { half_width_m: f64, fall: f64 },
    Giving(GivingTaper),
    Curve { position: Vec<f64>, value: Vec<f64>, slope: Vec<f64> },
}

impl WidthLaw {
    pub(crate) fn new(taper: &Taper, length_m: f64) -> Self {
        match taper {
            Taper::Exponential { half_width_m, rate_per_m } => {
                Self::Exponential { log_width: half_width_m.ln(), rate_per_m: *rate_per_m }
            }
            Taper::Linear { half_width_m, end_half_width_m } => Self::Linear {
                half_width_m: *half_width_m,
                fall: (half_width_m - end_half_width_m) / length_m,
            },
            Taper::Sampled { points } => {
                let position: Vec<f64> = points.iter().map(|point| point[0]).collect();
                let value: Vec<f64> = points.iter().map(|point| point[1].ln()).collect();
                Self::curve(position, value)
            }
        }
    }

    /// The monotone curve through falling values of ln W at rising positions.
    pub(crate) fn curve(position: Vec<f64>, value: Vec<f64>) -> Self {
        let slope = monotone_slopes(&position, &value);
        Self::Curve { position, value, slope }
    }

    /// This half-width times `factor`.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Exponential { log_width, rate_per_m } => {
                Self::Exponential { log_width: log_width + factor.ln(), rate_per_m }
            }
            Self::Linear { half_width_m, fall } => {
                Self::Linear { half_width_m: half_width_m * factor, fall: fall * factor }
            }
            Self::Giving(taper) => Self::Giving(taper.scaled(factor)),
            Self::Curve { position, mut value, slope } => {
                value.iter_mut().for_each(|value| *value += factor.ln());
                Self::Curve { position, value, slope }
            }
        }
    }

    /// The half-width between edges that give by `give_m`: W + delta. Straight edges stay straight.
    ///
    /// Of `clamped` edges delta is how far they turn: the half-width is that of [`of_turning_edges`], W + delta to the first order. A
    /// narrow plate must be left at its end: W(L) + delta > 0.
    pub(crate) fn giving(&self, length_m: f64, give_m: f64, clamped: bool) -> Self {
        match self {
            law if give_m == 0.0 => law.clone(),
            law if clamped && give_m > 0.0 => law.mapped(length_m, law.reach_m(), |at| {
                let share = give_m / at.value.exp();
                let (wider, rise) = of_turning_edges(share);
                (at.value + wider.ln(), at.slope * (1.0 - share * rise))
            }),
            Self::Linear { half_width_m, fall } => {
                Self::Linear { half_width_m: half_width_m + give_m, fall: *fall }
            }
            law => {
                let reach_m = if give_m < 0.0 { law.place_of((-give_m).ln()) } else { f64::INFINITY };
                if let &Self::Exponential { log_width, rate_per_m } = law {
                    let range_m = range_m(length_m, reach_m);
                    return Self::Giving(GivingTaper { log_width, rate_per_m, give_m, range_m });
                }
                law.mapped(length_m, reach_m, |at| {
                    let cut_m = at.value.exp();
                    ((cut_m + give_m).ln(), at.slope * cut_m / (cut_m + give_m))
                })
            }
        }
    }

    /// The curve of another logarithm of a half-width, with its derivative, which follows from ln W and W'/W. It ends before
    /// `reach_m`, where the edges would meet.
    pub(crate) fn mapped(&self, length_m: f64, reach_m: f64, of: impl Fn(LogWidth) -> (f64, f64)) -> Self {
        let longest = length_m / INTERVALS as f64;
        let [start, end] = range_m(length_m, reach_m);
        let mut corners = vec![start, 0.0];
        if let Self::Curve { position, .. } = self {
            corners.extend(position.iter().filter(|place| **place > 0.0 && **place < end));
        }
        corners.extend([length_m, end]);
        corners.sort_by(f64::total_cmp);
        let (mut position, mut value, mut slope) = (Vec::new(), Vec::new(), Vec::new());
        let mut add = |x: f64| {
            let (here, rise) = of(self.at(x));
            position.push(x);
            value.push(here);
            slope.push(rise);
        };
        for pair in corners.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            // Two corners at one place: a sampled taper may end with the plate.
            if to - from < 1e-9 * length_m {
                continue;
            }
            let parts = ((to - from) / longest).ceil().max(1.0);
            (0..parts as usize).for_each(|part| add(from + (to - from) * part as f64 / parts));
        }
        add(end);
        Self::Curve { position, value, slope }
    }

    /// Place where the continued taper has zero width, metres: finite for a linear taper, whose edges meet.
    pub(crate) fn reach_m(&self) -> f64 {
        match self {
            Self::Linear { half_width_m, fall } => half_width_m / fall,
            _ => f64::INFINITY,
        }
    }

    pub(crate) fn at(&self, x: f64) -> LogWidth {
        match self {
            Self::Exponential { log_width, rate_per_m } => {
                LogWidth { value: log_width - rate_per_m * x, slope: -rate_per_m, curvature: 0.0 }
            }
            Self::Linear { half_width_m, fall } => {
                // Beyond the tip the width stays above zero: a caller gets a very narrow plate instead of NaN.
                let width = (half_width_m - fall * x).max(half_width_m * 1e-9);
                let slope = -fall / width;
                LogWidth { value: width.ln(), slope, curvature: -slope * slope }
            }
            Self::Giving(taper) => taper.at(x),
            Self::Curve { position, value, slope } => curve_at(position, value, slope, x),
        }
    }

    /// The position where ln W has fallen to `target`, metres; the taper is continued on both sides.
    pub(crate) fn place_of(&self, target: f64) -> f64 {
        match self {
            Self::Exponential { log_width, rate_per_m } => (log_width - target) / rate_per_m,
            Self::Linear { half_width_m, fall } => (half_width_m - target.exp()) / fall,
            Self::Giving(taper) => taper.place_of(target),
            Self::Curve { position, value, slope } => {
                let last = position.len() - 1;
                if target >= value[0] {
                    return position[0] + (target - value[0]) / slope[0].min(-1e-9);
                }
                if target <= value[last] {
                    return position[last] + (target - value[last]) / slope[last].min(-1e-9);
                }
                let (mut low, mut high) = (position[0], position[last]);
                for _ in 0..80 {
                    let middle = 0.5 * (low + high);
                    if self.at(middle).value > target { low = middle } else { high = middle }
                }
                0.5 * (low + high)
            }
        }
    }
}

/// Start and end of a law that follows from a taper whose edges meet at `reach_m`, metres.
fn range_m(length_m: f64, reach_m: f64) -> [f64; 2] {
    [-BEYOND.0 * length_m, (length_m * (1.0 + BEYOND.1)).min(REACH * reach_m).max(length_m)]
}

/// Slopes of the monotone cubic through the points: the weighted harmonic mean of Fritsch and Butland (1984, SIAM J.
/// Sci. Stat. Comput. 5, 300).
fn monotone_slopes(position: &[f64], value: &[f64]) -> Vec<f64> {
    let count = position.len();
    let step: Vec<f64> = position.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let secant: Vec<f64> = value.windows(2).zip(&step).map(|(pair, h)| (pair[1] - pair[0]) / h).collect();
    let mut slope = vec![0.0; count];
    for i in 1..count - 1 {
        let (before, after) = (2.0 * step[i] + step[i - 1], step[i] + 2.0 * step[i - 1]);
        // Where the values turn round, as a thickness may, the curve is level.
        if secant[i - 1] * secant[i] > 0.0 {
            slope[i] = (before + after) / (before / secant[i - 1] + after / secant[i]);
        }
    }
    // At the ends: the one-sided three-point formula, limited so that the curve is monotone beside them.
    let end = |near: f64, far: f64, h0: f64, h1: f64| {
        let raw = ((2.0 * h0 + h1) * near - h0 * far) / (h0 + h1);
        raw.clamp((3.0 * near).min(0.1 * near), (3.0 * near).max(0.1 * near))
    };
    if count == 2 {
        slope[0] = secant[0];
        slope[1] = secant[0];
    } else {
        slope[0] = end(secant[0], secant[1], step[0], step[1]);
        slope[count - 1] = end(secant[count - 2], secant[count - 3], step[count - 2], step[count - 3]);
    }
    slope
}

/// The interval of rising places that holds `x`, which lies within them. Most curves have places at equal distances: there the first
/// guess is right or next to it.
fn interval_of(position: &[f64], x: f64) -> usize {
    let last = position.len() - 1;
    let share = (x - position[0]) / (position[last] - position[0]);
    let guess = ((share * last as f64) as usize).min(last - 1);
    let near = guess.saturating_sub(1)..(guess + 2).min(last);
    let holds = |i: &usize| position[*i] <= x && x < position[*i + 1];
    near.into_iter()
        .find(holds)
        .unwrap_or_else(|| position.partition_point(|&place| place <= x).clamp(1, last) - 1)
}

fn curve_at(position: &[f64], value: &[f64], slope: &[f64], x: f64) -> LogWidth {
    let last = position.len() - 1;
    if x < position[0] || x >= position[last] {
        // Continued as an exponential taper with the end's slope.
        let end = if x < position[0] { 0 } else { last };
        return LogWidth {
            value: value[end] + slope[end] * (x - position[end]),
            slope: slope[end],
            curvature: 0.0,
        };
    }
    let left = interval_of(position, x);
    let right = left + 1;
    let h = position[right] - position[left];
    let t = (x - position[left]) / h;
    let rise = value[right] - value[left];
    // The cubic Hermite polynomial in powers of t.
    let (a, b) = (h * slope[left], h * slope[right]);
    let (c2, c3) = (3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise);
    LogWidth {
        value: value[left] + t * (a + t * (c2 + t * c3)),
        slope: (a + t * (2.0 * c2 + 3.0 * t * c3)) / h,
        curvature: (2.0 * c2 + 6.0 * t * c3) / (h * h),
    }
}
