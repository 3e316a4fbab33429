//! The rows of the stage: hint, flag, plate, envelope, strip and scale over one x axis.

use crate::axis::Axis;
use eframe::egui::{Rect, pos2};

/// Space left of the plate for the envelope's scale, and right of it for the last label, in points.
pub(super) const MARGIN: (f32, f32) = (58.0, 22.0);
const TITLE: f32 = 26.0;
pub(super) const LABEL: f32 = 26.0;
const STRIP: f32 = 30.0;
const SCALE: f32 = 34.0;
pub(super) const GAP: f32 = 8.0;
/// The least height of the plate, in points, and its largest share of the stage's height.
const PLATE_LEAST: f32 = 64.0;
/// The height without which plate and envelope cannot be touched, in points.
const KNOB: f32 = 40.0;
const PLATE_MOST: f32 = 1.0 / 3.0;
/// A stage lower than this, in points, has no title.
const LOW: f32 = 225.0;

/// The rectangles of the three views.
pub(super) struct Layout {
    pub(super) axis: Axis,
    pub(super) title: Rect,
    /// For the hint, where it has no room beside the flag.
    pub(super) hint: Rect,
    pub(super) label: Rect,
    pub(super) plate: Rect,
    pub(super) envelope: Rect,
    pub(super) strip: Rect,
    pub(super) scale: Rect,
}

impl Layout {
    pub(super) fn new(
        area: Rect,
        axis: Axis,
        half_width_m: f64,
        pixels_per_point: f32,
        hint_height: f32,
    ) -> Self {
        let row = |top: f32, height: f32| {
            let top = (top * pixels_per_point).round() / pixels_per_point;
            let bottom = ((top + height) * pixels_per_point).round() / pixels_per_point;
            Rect::from_min_max(pos2(area.left(), top), pos2(area.right(), bottom))
        };
        // The lowest stage, beside the plots in the smallest window, has no line above the plate.
        let title_height = if area.height() < LOW { 0.0 } else { TITLE };
        let title = row(area.top(), title_height);
        let hint = row(title.bottom(), hint_height);
        let label = row(hint.bottom(), LABEL);
        // In a window that is too low, the views overlap at their ends but stay in order.
        let rows = title_height + hint_height + LABEL + STRIP + SCALE;
        let free = (area.height() - rows - 2.0 * GAP).max(0.0);
        // The curve comes first: the plate gets what it needs at scale, but no more than this share of the stage.
        let wanted = 2.0 * half_width_m as f32 * axis.points_per_m() + 12.0;
        let most = (PLATE_MOST * area.height()).min(0.5 * free).max(KNOB);
        let least = PLATE_LEAST.min(0.4 * free).max(KNOB);
        let plate = row(label.bottom(), wanted.clamp(least.min(most), most));
        let envelope = row(plate.bottom() + GAP, (free - plate.height()).max(KNOB));
        let strip = row(envelope.bottom() + GAP, STRIP);
        let scale = row(strip.bottom(), SCALE);
        Self { axis, title, hint, label, plate, envelope, strip, scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Rangef;

    #[test]
    fn a_plate_takes_at_most_a_third_of_the_stage_and_the_curve_the_rest() {
        for (width, height) in
            [(900.0, 560.0), (900.0, 420.0), (440.0, 270.0), (360.0, 200.0), (300.0, 460.0)]
        {
            for half_width_m in [0.005, 0.05, 0.2] {
                let area = Rect::from_min_max(pos2(0.0, 0.0), pos2(width, height));
                let axis = Axis::new(0.34, Rangef::new(MARGIN.0, width - MARGIN.1), 1.0);
                let layout = Layout::new(area, axis, half_width_m, 1.0, 0.0);
                let what = format!("{width} x {height}, {half_width_m} m: {}", layout.plate);
                assert!(layout.plate.height() <= height / 3.0 + 1.0, "{what}");
                assert!(layout.envelope.height() >= layout.plate.height() - 1.0, "{what}");
                assert!(layout.scale.bottom() <= height + 1.0, "{what}");
            }
        }
    }
}
