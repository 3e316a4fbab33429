//! The stiffness of a stretched film between clamped edges.
//!
//! A film of the bending stiffness D under the tension T obeys D lap lap w - T lap w = omega^2 sigma w. Far from an edge that
//! is a wave with T K^2 (1 + (s K)^2) = omega^2 sigma, s = sqrt(D/T). At an edge w and its normal slope are zero, which a wave
//! alone cannot meet: with w = (A cos az + B cosh bz) e^(jkx), a^2 = K^2 - k^2 and b^2 = K^2 + k^2 + 1/s^2, a strip of the
//! half-width W has
//!
//! ```text
//! a tan aW + b tanh bW = 0
//! ```
//! At its cut-off (k = 0) K depends on W and s alone. So the film is a membrane of the turning half-width (pi/2)/K, about
//! W - s, at every frequency: exact where a wave turns, and before that place k^2 is too small by the share slope - 1
//! ([`FilmEdge::slope`]) at most, 4.9 (s/W)^3 where s is small.

use crate::definition::error::{Consequence, PlateError};
use crate::definition::limits;
use crate::definition::taper::WidthLaw;
use std::f64::consts::FRAC_PI_2;

/// What a stretched film is made of. With the membrane's tension it gives the stiffness of bending beside that of the
/// tension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Young's modulus E, Pa (1000 to 1e13).
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio nu (0 to 0.499).
    pub poisson_ratio: f64,
    /// Thickness h, metres (1e-6 to 0.1).
    pub thickness_m: f64,
}

impl Film {
    /// Bending stiffness D = E h^3/(12 (1 - nu^2)), N m.
    #[must_use]
    pub fn stiffness_n_m(&self) -> f64 {
        self.youngs_modulus_pa * self.thickness_m.powi(3) / (12.0 * (1.0 - self.poisson_ratio.powi(2)))
    }

    /// Refuses a film that is too stiff at the farthest boundary, where its plate has this half-width; `field` is the name of its
    /// thickness and `edge_m` its s.
    pub(crate) fn check(&self, field: &str, edge_m: f64, half_width_m: f64) -> Result<(), PlateError> {
        let percent = FilmEdge::new(half_width_m / edge_m).missed_percent();
        if percent <= limits::FILM_PERCENT {
            return Ok(());
        }
        let thickest_m = self.thickest_m(limits::FILM_PERCENT, edge_m, half_width_m);
        let consequence = Consequence::Film { half_width_m, percent, thickest_m };
        Err(PlateError::unfit(field, self.thickness_m, consequence))
    }

    /// The thickness at which the wavenumber is `percent` too small where this film has the edge length `edge_m` and its plate
    /// this half-width, at the same wave speed: then s is proportional to the thickness.
    pub(crate) fn thickest_m(&self, percent: f64, edge_m: f64, half_width_m: f64) -> f64 {
        self.thickness_m * half_width_m / (edge_m * FilmEdge::widths_for(percent))
    }
}

/// The cut-off of a strip of a film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FilmEdge {
    /// K W at the cut-off: from pi/2 of a membrane to 2.36502 of a clamped plate.
    pub(crate) number: f64,
    /// b W there.
    pub(crate) outer: f64,
}

/// Steps of the searches for a root; Newton's method needs four or five.
const STEPS_MAX: usize = 60;
/// q of a clamped plate, which no film reaches.
const CLAMPED: f64 = 2.365_020_372_431_352;

/// r = x/(y tanh y) with its derivatives by x and by y.
fn ratio(x: f64, y: f64) -> [f64; 3] {
    let (tanh, sech) = (y.tanh(), y.cosh().recip());
    let r = x / (y * tanh);
    [r, r / x, -r * (1.0 / y + sech * sech / tanh)]
}

impl FilmEdge {
    /// The root for a strip whose half-width is `widths` times s: the root of x - pi/2 - atan(x/(y tanh y)), y^2 = x^2
    /// + widths^2.
    pub(crate) fn new(widths: f64) -> Self {
        let (mut low, mut high) = (FRAC_PI_2, CLAMPED);
        let mut x = if widths > 4.0 { FRAC_PI_2 * widths / (widths - 1.0) } else { 0.5 * (low + high) };
        for _ in 0..STEPS_MAX {
            let y = x.hypot(widths);
            let [r, by_x, by_y] = ratio(x, y);
            let value = x - FRAC_PI_2 - r.atan();
            *if value > 0.0 { &mut high } else { &mut low } = x;
            let slope = 1.0 - (by_x + by_y * x / y) / (1.0 + r * r);
            let next = x - value / slope;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - x).abs() < 4e-16 * x {
                break;
            }
            x = next;
        }
        Self { number: x, outer: x.hypot(widths) }
    }

    /// d ln(turning half-width)/d ln W at the same s.
    fn rise(self) -> f64 {
        let (x, y) = (self.number, self.outer);
        let [r, by_x, by_y] = ratio(x, y);
        let squared = y * y - x * x;
        // x' and y' by ln(widths): y y' = x x' + widths^2.
        let by_widths = -by_y * squared / y;
        1.0 - by_widths / (by_x + by_y * x / y - 1.0 - r * r) / x
    }

    /// W of the strip whose turning half-width is `turning_m`, metres, of a film of the edge length `edge_m`, and
    /// d ln(turning half-width)/d ln W there.
    pub(crate) fn outline_m(turning_m: f64, edge_m: f64) -> (f64, f64) {
        let number = FRAC_PI_2 / turning_m;
        let outer = number.hypot(edge_m.recip());
        let mut half_width_m = turning_m + edge_m;
        // tanh(b W) hardly depends on W: a few steps settle it.
        for _ in 0..STEPS_MAX {
            let bent = outer * (outer * half_width_m).tanh();
            half_width_m = (FRAC_PI_2 + (number / bent).atan()) / number;
        }
        (half_width_m, Self::new(half_width_m / edge_m).rise())
    }

    /// The least W/s at which the wavenumber of the law is too small by at most `percent`.
    pub(crate) fn widths_for(percent: f64) -> f64 {
        let (mut low, mut high) = (1.0_f64, 1e3);
        for _ in 0..STEPS_MAX {
            let middle = (low * high).sqrt();
            if Self::new(middle).missed_percent() > percent { low = middle } else { high = middle }
        }
        high
    }

    /// dk^2/dK^2 at the cut-off: 1 of a membrane, 1.81858 of a clamped plate. The law of the turning half-width has 1.
    pub(crate) fn slope(self) -> f64 {
        let (x, y) = (self.number, self.outer);
        let [r, by_x, by_y] = ratio(x, y);
        let along = (1.0 - by_x / (1.0 + r * r)) / x;
        let bent = -by_y / (1.0 + r * r) / y;
        (along + bent) / (along - bent)
    }

    /// Deficit of the law's wavenumber just before the turning point of a wave, %.
    pub(crate) fn missed_percent(self) -> f64 {
        100.0 * (self.slope().sqrt() - 1.0)
    }
}

/// ln of the half-width of the membrane that turns every wave where a film of the edge length `edge_m` does between the
/// edges of `outline`.
pub(crate) fn membrane_width(outline: &WidthLaw, length_m: f64, edge_m: f64) -> WidthLaw {
    outline.mapped(length_m, outline.reach_m(), |law| {
        let edge = FilmEdge::new(law.value.exp() / edge_m);
        (law.value + (FRAC_PI_2 / edge.number).ln(), law.slope * edge.rise())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::taper::Taper;

    /// a tan aW + b tanh bW of a strip with W = 1, for K^2, k^2 and 1/s^2.
    fn residual(axial: f64, along: f64, widths: f64) -> f64 {
        let (a, b) = ((axial - along).sqrt(), (axial + along + widths * widths).sqrt());
        a * a.tan() + b * b.tanh()
    }

    #[test]
    fn the_cut_off_is_the_root_of_the_strip_from_the_membrane_to_the_clamped_plate() {
        for widths in [1e-3, 0.3, 1.0, 3.0, 5.0, 9.0, 30.0, 1e3, 1e6] {
            let edge = FilmEdge::new(widths);
            let squared = edge.number.powi(2);
            let scale = edge.number * edge.number.tan();
            assert!((residual(squared, 0.0, widths) / scale).abs() < 1e-9, "{widths}: {edge:?}");
        }
        assert!((FilmEdge::new(1e-4).number - CLAMPED).abs() < 1e-6);
        assert!((FilmEdge::new(1e7).number / FRAC_PI_2 - 1.0).abs() < 2e-7);
    }

    #[test]
    fn the_slope_at_the_cut_off_matches_the_strip_and_approaches_the_clamped_plates() {
        for widths in [0.5, 3.0, 5.0, 9.0, 20.0] {
            let edge = FilmEdge::new(widths);
            let (axial, h) = (edge.number.powi(2), 1e-4);
            let by_k = residual(axial, h, widths) - residual(axial, -h, widths);
            let by_axial = residual(axial + h, 0.0, widths) - residual(axial - h, 0.0, widths);
            assert!((edge.slope() * by_k / by_axial + 1.0).abs() < 1e-6, "{widths}: {}", edge.slope());
        }
        assert!((FilmEdge::new(1e-3).slope() - 1.818_58).abs() < 1e-4);
    }

    #[test]
    fn the_curve_has_the_roots_of_every_place_and_their_derivatives() {
        let points = [[0.0, 0.05], [0.11, 0.031], [0.2, 0.024], [0.32, 0.011]];
        for taper in [
            Taper::Exponential { half_width_m: 0.05, rate_per_m: 4.62 },
            Taper::Linear { half_width_m: 0.05, end_half_width_m: 0.01 },
            Taper::Sampled { points: points.to_vec() },
        ] {
            let outline = WidthLaw::new(&taper, 0.32);
            let law = membrane_width(&outline, 0.32, 2e-3);
            let exact = |x: f64| {
                let half_width = outline.at(x).value.exp();
                (FRAC_PI_2 * half_width / FilmEdge::new(half_width / 2e-3).number).ln()
            };
            for x in [-0.003, 0.0, 1e-4, 0.0503, 0.1, 0.2177, 0.3199, 0.33] {
                let found = law.at(x);
                assert!((found.value - exact(x)).abs() < 1e-10, "{taper:?} {x}: {}", found.value - exact(x));
                let h = 1e-5;
                let slope = (exact(x + h) - exact(x - h)) / (2.0 * h);
                assert!((found.slope - slope).abs() < 1e-5 * slope.abs(), "{taper:?} {x}");
            }
            let place = law.place_of(exact(0.2177));
            assert!((place - 0.2177).abs() < 1e-9, "{taper:?}: {place}");
        }
    }
}
