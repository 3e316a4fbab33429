//! An exponential taper between edges that give: W = W0 e^(-d x) + delta, and its arcs, in closed form.
//!
//! A fit tries hundreds of plates whose edges give, each by another delta; a curve through its half-widths would have to be
//! made for each.

use crate::definition::log_width::{LogTurningWidth, LogWidth, arc_to_width};

/// The law within the ends of its range; outside it goes on as an exponential taper with the end's slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GivingTaper {
    /// ln W0, W0 in metres.
    pub(crate) log_width: f64,
    /// d, 1/m.
    pub(crate) rate_per_m: f64,
    /// delta, metres: above minus W at the end of the range.
    pub(crate) give_m: f64,
    /// Start and end of the range, metres.
    pub(crate) range_m: [f64; 2],
}

impl GivingTaper {
    /// The cut half-width at `x`, metres.
    fn cut_m(&self, x: f64) -> f64 {
        (self.log_width - self.rate_per_m * x).exp()
    }

    fn within(&self, x: f64) -> f64 {
        x.clamp(self.range_m[0], self.range_m[1])
    }

    /// This half-width times `factor`.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { log_width: self.log_width + factor.ln(), give_m: self.give_m * factor, ..self }
    }

    pub(crate) fn at(&self, x: f64) -> LogWidth {
        let inside = self.within(x);
        let cut_m = self.cut_m(inside);
        let width_m = cut_m + self.give_m;
        let slope = -self.rate_per_m * cut_m / width_m;
        if x == inside {
            let curvature = self.rate_per_m * self.rate_per_m * cut_m * self.give_m / (width_m * width_m);
            LogWidth { value: width_m.ln(), slope, curvature }
        } else {
            LogWidth { value: width_m.ln() + slope * (x - inside), slope, curvature: 0.0 }
        }
    }

    /// The position where ln W has fallen to `target`, metres.
    pub(crate) fn place_of(&self, target: f64) -> f64 {
        place_between(self.range_m, target, |x| {
            let LogWidth { value, slope, .. } = self.at(x);
            LogTurningWidth { value, slope }
        })
    }

    /// Half the arc at `x` within the range, metres: (W + delta) atan(s)/s with s = d W.
    fn arc_m(&self, x: f64) -> f64 {
        let cut_m = self.cut_m(x);
        (cut_m + self.give_m) * arc_to_width(self.rate_per_m * cut_m)
    }

    /// d ln(arc)/dx at `x` within the range, 1/m.
    fn arc_slope(&self, x: f64) -> f64 {
        let cut_m = self.cut_m(x);
        let s = self.rate_per_m * cut_m;
        let turned = s / ((1.0 + s * s) * s.atan());
        self.rate_per_m * (self.give_m / (cut_m + self.give_m) - turned)
    }

    /// ln of half the arc, and its slope.
    pub(crate) fn arc_at(&self, x: f64) -> LogTurningWidth {
        let inside = self.within(x);
        let slope = self.arc_slope(inside);
        LogTurningWidth { value: self.arc_m(inside).ln() + slope * (x - inside), slope }
    }

    /// 1 over half the arc, 1/m.
    pub(crate) fn reciprocal_arc_at(&self, x: f64) -> f64 {
        let inside = self.within(x);
        let reciprocal = self.arc_m(inside).recip();
        if x == inside { reciprocal } else { reciprocal * (-self.arc_slope(inside) * (x - inside)).exp() }
    }

    /// The position where ln of half the arc has fallen to `target`, metres.
    pub(crate) fn place_of_arc(&self, target: f64) -> f64 {
        place_between(self.range_m, target, |x| self.arc_at(x))
    }

    /// Whether its arcs fall all along: (1 + s^2) atan(s)/s - 1 grows with s faster than s, so that they fall everywhere if they do
    /// at the wide end.
    pub(crate) fn arcs_fall(&self) -> bool {
        self.arc_slope(self.range_m[0]) < 0.0
    }
}

/// Where a falling law has the value `target`: Newton's steps between the two ends that hold the place.
fn place_between([start_m, end_m]: [f64; 2], target: f64, law: impl Fn(f64) -> LogTurningWidth) -> f64 {
    for (end, is_beyond) in [(start_m, 1.0), (end_m, -1.0)] {
        let LogTurningWidth { value, slope } = law(end);
        if (target - value) * is_beyond >= 0.0 {
            return end + (target - value) / slope.min(-1e-9);
        }
    }
    let (mut low, mut high) = (start_m, end_m);
    let mut x = 0.5 * (low + high);
    for _ in 0..80 {
        let LogTurningWidth { value, slope } = law(x);
        if value > target {
            low = x;
        } else {
            high = x;
        }
        let step = (target - value) / slope;
        // The next step would be shorter than rounding.
        if step.abs() <= 1e-10 * (end_m - start_m) {
            return x + step;
        }
        let next = x + step;
        x = if low < next && next < high { next } else { 0.5 * (low + high) };
    }
    x
}

#[cfg(test)]
mod tests {
    use crate::definition::taper::{Taper, WidthLaw};
    use crate::definition::turning_width::{TurningLaw, TurningWidth};

    const LENGTH_M: f64 = 0.3;

    fn giving(taper: &Taper, give_m: f64) -> WidthLaw {
        WidthLaw::new(taper, LENGTH_M).giving(LENGTH_M, give_m, false)
    }

    #[test]
    fn it_is_the_curve_through_its_places_and_its_arcs_along_the_plate_and_beyond() {
        for (half_width_m, rate_per_m, give_m) in
            [(0.05, 4.62, 3e-4), (0.05, 4.62, -2e-3), (0.02, 8.0, 5e-3), (0.2, 6.0, -1e-3)]
        {
            let law = giving(&Taper::Exponential { half_width_m, rate_per_m }, give_m);
            assert!(matches!(law, WidthLaw::Giving(_)));
            let curve = law.mapped(LENGTH_M, f64::INFINITY, |at| (at.value, at.slope));
            let arcs = TurningLaw::new(&law, LENGTH_M, TurningWidth::Arc);
            assert!(matches!(arcs, TurningLaw::GivingArc(_)));
            let curved = TurningLaw::new(&curve, LENGTH_M, TurningWidth::Arc);
            for x in [-0.03, -0.01, 0.0, 0.07, 0.1234, 0.2999, 0.45] {
                let case = format!("{half_width_m} {rate_per_m} {give_m}: {x}");
                let (found, expected) = (law.at(x), curve.at(x));
                assert!((found.value - expected.value).abs() < 1e-9, "{case}: {found:?} {expected:?}");
                assert!((found.slope / expected.slope - 1.0).abs() < 1e-6, "{case}: {found:?} {expected:?}");
                assert!(
                    (law.place_of(found.value) - x).abs() < 1e-12,
                    "{case}: {}",
                    law.place_of(found.value)
                );
                let (found, expected) = (arcs.at(x), curved.at(x));
                assert!((found.value - expected.value).abs() < 1e-5, "{case}: {found:?} {expected:?}");
                assert!((found.slope / expected.slope - 1.0).abs() < 5e-4, "{case}: {found:?} {expected:?}");
                assert!(
                    (arcs.place_of(found.value) - x).abs() < 1e-12,
                    "{case}: {}",
                    arcs.place_of(found.value)
                );
                assert!((arcs.reciprocal_at(x).ln() + found.value).abs() < 1e-12, "{case}");
            }
        }
    }

    #[test]
    fn its_derivatives_are_those_of_w_plus_delta() {
        let law = giving(&Taper::Exponential { half_width_m: 0.05, rate_per_m: 4.62 }, 2e-3);
        let log = |x: f64| (0.05 * (-4.62 * x).exp() + 2e-3).ln();
        for x in [0.0, 0.1, 0.29] {
            let (at, h) = (law.at(x), 1e-4);
            assert!((at.value - log(x)).abs() < 1e-14);
            assert!((at.slope - (log(x + h) - log(x - h)) / (2.0 * h)).abs() < 1e-6, "{at:?}");
            let curvature = (log(x + h) - 2.0 * log(x) + log(x - h)) / (h * h);
            assert!((at.curvature - curvature).abs() < 1e-4, "{at:?} {curvature}");
        }
    }

    #[test]
    fn where_arcs_do_not_fall_it_keeps_the_shortest_so_far() {
        let law = giving(&Taper::Exponential { half_width_m: 0.3, rate_per_m: 300.0 }, 5e-3);
        let arcs = TurningLaw::new(&law, LENGTH_M, TurningWidth::Arc);
        assert!(matches!(arcs, TurningLaw::Width(_)));
        assert!(arcs.at(0.0).value > arcs.at(0.1).value);
    }
}
