//! What to know of a design before it is built: the sentences of those lights that depend on how it stands on a table. They need no
//! drive table, so a panel shows them as soon as the plate is designed.

use super::Design;
use crate::check::thresholds::{DRIFT_MM_PER_K, PRESS_MM};
use crate::quantity::number_format::significant;
use crate::quantity::show_length;

impl Design {
    /// Strain of the stretched film, and the shift of a boundary by one kelvin, metres; `None` for a plate that is no stretched
    /// film.
    #[must_use]
    pub fn strain(&self) -> Option<(f64, f64)> {
        let drift = self.plate.drift(self.middle_m())?;
        drift.strain.zip(drift.kelvin_m)
    }

    /// The middle of the span, metres.
    fn middle_m(&self) -> f64 {
        0.5 * (self.low.boundary_m + self.high.boundary_m)
    }

    /// The static deflection under a finger that presses with 0.5 N at the middle of the span, metres; `None` for a plate that
    /// is no membrane.
    #[must_use]
    pub fn press_m(&self) -> Option<f64> {
        self.plate.press_m(self.middle_m())
    }

    /// What to know before it is built, in sentences; `None` where there is nothing.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        let warm = self.strain().filter(|(_, shift_m)| 1e3 * shift_m > DRIFT_MM_PER_K.green).map(
            |(strain, shift_m)| {
                format!(
                    "This film is stretched by {} ppm alone and is a thermometer: in a frame that expands by 6 ppm per kelvin \
                     more or less than it, one kelvin moves the boundary by {}. Take a thinner film, a faster wave, or rubber.",
                    significant(1e6 * strain, 2),
                    show_length(shift_m)
                )
            },
        );
        let soft = self.press_m().filter(|press_m| 1e3 * press_m > PRESS_MM).map(|press_m| {
            format!(
                "A finger that presses with 0.5 N sinks in by {}, which stretches the sheet and moves the boundary: stroke it, or \
                 take more tension.",
                show_length(press_m)
            )
        });
        let shakes = self.frame.and_then(|frame| frame.caution());
        let all: Vec<String> = [warm, soft, shakes].into_iter().flatten().collect();
        (!all.is_empty()).then(|| all.join(" "))
    }
}
