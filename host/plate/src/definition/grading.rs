//! The thickness along a plate, and its effect on the power and the turning point of a wave.

use crate::definition::log_width::LogWidth;
use crate::definition::plate::Plate;
use crate::definition::turning_width::TurningLaw;

impl Plate {
    /// Thickness of a plate in bending at `x`, metres; `None` for other plates.
    pub fn thickness_m(&self, x: f64) -> Option<f64> {
        let driven_m = self.spec().model.bending()?.thickness_m;
        Some(driven_m * self.thickness_ratio(x))
    }

    /// Whether the thickness changes along the plate.
    pub fn is_graded(&self) -> bool {
        self.grading.is_some()
    }

    /// Thickness at `x` over that at the driven end.
    pub(crate) fn thickness_ratio(&self, x: f64) -> f64 {
        self.grading.as_ref().map_or(1.0, |grading| grading.log(x).value.exp())
    }

    /// ln of the weight S of the amplitude equation, and its derivatives: the half-width times (h/h0)^2, with the
    /// thickness h0 at the driven end. The power of a wave is proportional to S k.
    pub(crate) fn weight_at(&self, x: f64) -> LogWidth {
        let width = self.width.at(x);
        let Some(grading) = &self.grading else { return width };
        let thickness = grading.log(x);
        LogWidth {
            value: width.value + 2.0 * thickness.value,
            slope: width.slope + 2.0 * thickness.slope,
            curvature: width.curvature + 2.0 * thickness.curvature,
        }
    }

    /// ln of the turning half-width s sqrt(h0/h) at `x`, in metres, and its derivative, 1/m. A wave turns where q/K
    /// equals this half-width, with K at the driven end.
    pub(crate) fn turning_at(&self, x: f64) -> (f64, f64) {
        let turning = self.turning_law().at(x);
        (turning.value, turning.slope)
    }

    /// The law of the turning half-width.
    pub(super) fn turning_law(&self) -> &TurningLaw {
        self.grading.as_ref().map_or(&self.turning, |grading| grading.turning())
    }
}
