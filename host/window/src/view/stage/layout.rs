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
/// The time line of a recorded drag, with the space over it.
const TIME: f32 = 52.0;
/// A stage lower than this, in points, has no title and no time line.
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
    /// For the time line, if it is shown; else it has no height.
    pub(super) time: Rect,
}

impl Layout {
    pub(super) fn new(
        area: Rect,
        axis: Axis,
        half_width_m: f64,
        pixels_per_point: f32,
        hint_height: f32,
        has_time_line: bool,
    ) -> Self {
        let row = |top: f32, height: f32| {
            let top = (top * pixels_per_point).round() / pixels_per_point;
            let bottom = ((top + height) * pixels_per_point).round() / pixels_per_point;
            Rect::from_min_max(pos2(area.left(), top), pos2(area.right(), bottom))
        };
        // The lowest stage, beside the plots in the smallest window, has no line above the plate.
        let (title_height, time_height) =
            if area.height() < LOW { (0.0, 0.0) } else { (TITLE, if has_time_line { TIME } else { 0.0 }) };
        let title = row(area.top(), title_height);
        let hint = row(title.bottom(), hint_height);
        let label = row(hint.bottom(), LABEL);
        // In a window that is too low, the views overlap at their ends but stay in order.
        let rows = title_height + hint_height + LABEL + STRIP + SCALE + time_height;
        let free = (area.height() - rows - 2.0 * GAP).max(0.0);
        // The plate gets what it needs at scale; the envelope gets the rest.
        let wanted = 2.0 * half_width_m as f32 * axis.points_per_m() + 12.0;
        let plate = row(label.bottom(), wanted.clamp(0.35 * free, 0.7 * free).max(40.0));
        let envelope = row(plate.bottom() + GAP, (free - plate.height()).max(40.0));
        let strip = row(envelope.bottom() + GAP, STRIP);
        let scale = row(strip.bottom(), SCALE);
        let time = row(scale.bottom(), time_height);
        Self { axis, title, hint, label, plate, envelope, strip, scale, time }
    }
}
