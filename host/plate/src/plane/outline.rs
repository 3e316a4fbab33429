//! The half-width of the whole sheet along x: the plate with a lead-in before it, or a uniform strip.

use crate::definition::log_width::LogWidth;
use crate::definition::taper::WidthLaw;

/// Half of the length over which the corner between lead-in and taper is rounded, over the half-width there.
///
/// The lead-in is parallel and the plate narrows immediately, so W' has a jump. A deflection of finite bending energy
/// with w = 0 along both edges of such a corner has zero slope at it, which would stiffen the mesh far more than a
/// real corner. Real edges are milled with a radius. W' therefore varies linearly over 2.5 mm on both sides at W = 20
/// mm. This changes the half-width by less than |W'| W/32, and the test `the_corner_of_a_lead_in_may_be_rounded_less`
/// asserts that the result does not depend on it.
pub(super) const ROUNDING: f64 = 0.125;

/// Half-width over x.
#[derive(Debug, Clone)]
pub(super) enum Outline<'a> {
    /// ln W of a parallel strip.
    Uniform(f64),
    /// A plate from x = 0, and before it a strip of the half-width at x = 0.
    Plate {
        law: &'a WidthLaw,
        /// Half of the rounded length, metres; 0 without a lead-in.
        rounding_m: f64,
    },
}

impl<'a> Outline<'a> {
    /// A plate behind a lead-in of this length, with a rounded corner of `rounding` half-widths on both sides.
    pub(super) fn of(law: &'a WidthLaw, lead_in_m: f64, rounding: f64) -> Self {
        let rounding_m = (rounding * law.at(0.0).value.exp()).min(0.25 * lead_in_m);
        Self::Plate { law, rounding_m }
    }

    /// Positions where the law of the half-width changes, metres.
    pub(super) fn corners(&self) -> Vec<f64> {
        match self {
            Self::Plate { rounding_m, .. } if *rounding_m > 0.0 => vec![-rounding_m, 0.0, *rounding_m],
            _ => vec![0.0],
        }
    }

    pub(super) fn at(&self, x: f64) -> LogWidth {
        match self {
            Self::Uniform(value) => LogWidth { value: *value, slope: 0.0, curvature: 0.0 },
            Self::Plate { law, rounding_m } if x < *rounding_m => {
                let start = LogWidth { slope: 0.0, curvature: 0.0, ..law.at(0.0) };
                if x <= -rounding_m {
                    return start;
                }
                // The cubic with the strip's value and slope at its start and the taper's at its end.
                let (end, h) = (law.at(*rounding_m), 2.0 * rounding_m);
                let t = (x + rounding_m) / h;
                let (rise, b) = (end.value - start.value, h * end.slope);
                let (c2, c3) = (3.0 * rise - b, b - 2.0 * rise);
                LogWidth {
                    value: start.value + t * t * (c2 + t * c3),
                    slope: t * (2.0 * c2 + 3.0 * t * c3) / h,
                    curvature: (2.0 * c2 + 6.0 * t * c3) / (h * h),
                }
            }
            Self::Plate { law, .. } => law.at(x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rounded_corner_joins_strip_and_taper_with_value_and_slope() {
        let law = WidthLaw::Exponential { log_width: 0.02_f64.ln(), rate_per_m: 4.62 };
        let outline = Outline::of(&law, 0.06, ROUNDING);
        let step = 1e-7;
        for x in [-0.01, -0.0025, -0.001, 0.0, 0.0012, 0.0025, 0.1] {
            let (low, high) = (outline.at(x - step), outline.at(x + step));
            assert!((high.value - low.value).abs() < 1e-5, "{x}");
            assert!((high.slope - low.slope).abs() < 1e-2, "{x}");
            let slope = (high.value - low.value) / (2.0 * step);
            assert!((slope - outline.at(x).slope).abs() < 1e-3, "{x}: {slope}");
            let curvature = (high.slope - low.slope) / (2.0 * step);
            let is_at_a_join = (x.abs() - 0.0025).abs() < 1e-9;
            assert!(is_at_a_join || (curvature - outline.at(x).curvature).abs() < 1e-3, "{x}: {curvature}");
        }
        assert_eq!(outline.at(-0.06).value.exp(), 0.02);
        assert_eq!(outline.at(0.1), law.at(0.1));
    }
}
