//! Zoom and motion of a plot: the wheel zooms along x about the pointer, with Shift along y; a drag moves what is shown.
//! Neither leaves the full range of the axes.

use eframe::egui;
use egui_plot::PlotUi;

/// Points of wheel motion that zoom by e.
const WHEEL: f64 = 200.0;
/// The most that an axis is magnified.
const MOST: f64 = 1000.0;

/// The ends of an axis, or the part of it that is shown.
pub(in crate::view) type Ends = (f64, f64);

/// The part of `full` that is shown after a zoom by `factor` about `at` and a motion by `by`.
fn steered(full: Ends, now: Ends, at: f64, factor: f64, by: f64) -> Ends {
    let whole = full.1 - full.0;
    let before = (now.1 - now.0).clamp(whole / MOST, whole);
    let span = (before / factor).clamp(whole / MOST, whole);
    if span >= whole {
        return full;
    }
    // The value under the pointer stays there.
    let start = at - (at - now.0) * (span / before) + by;
    // Not `clamp`: of the whole axis the rounded ends may have changed places.
    let start = start.min(full.1 - span).max(full.0);
    (start, start + span)
}

/// Zooms and moves the plot as wheel and pointer say, in the ranges `full` of x and y.
pub(in crate::view) fn steer(plot: &mut PlotUi<'_>, full: [Ends; 2]) {
    steer_by(plot, full, |along, across| [along, across]);
}

/// As [`steer`], for axes of one scale: both are zoomed alike.
pub(in crate::view) fn steer_evenly(plot: &mut PlotUi<'_>, full: [Ends; 2]) {
    steer_by(plot, full, |along, across| [along * across; 2]);
}

fn steer_by(plot: &mut PlotUi<'_>, full: [Ends; 2], factors: fn(f64, f64) -> [f64; 2]) {
    let bounds = plot.plot_bounds();
    let now = [(bounds.min()[0], bounds.max()[0]), (bounds.min()[1], bounds.max()[1])];
    let is_over = plot.response().contains_pointer();
    let (wheel, pinch) = plot.ctx().input(|input| (input.smooth_scroll_delta, input.zoom_delta()));
    let factors = if is_over {
        factors((f64::from(wheel.y) / WHEEL).exp() * f64::from(pinch), (f64::from(wheel.x) / WHEEL).exp())
    } else {
        [1.0; 2]
    };
    let is_dragged = plot.response().dragged_by(egui::PointerButton::Primary);
    let by = if is_dragged { plot.pointer_coordinate_drag_delta() } else { egui::Vec2::ZERO };
    let pointer = plot.pointer_coordinate();
    let at = pointer.map_or([0.0; 2], |at| [at.x, at.y]);
    let next = [(0, -f64::from(by.x)), (1, -f64::from(by.y))]
        .map(|(axis, by)| steered(full[axis], now[axis], at[axis], factors[axis], by));
    if next[0] != now[0] {
        plot.set_plot_bounds_x(next[0].0..=next[0].1);
    }
    if next[1] != now[1] {
        plot.set_plot_bounds_y(next[1].0..=next[1].1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: Ends = (-10.0, 30.0);

    #[test]
    fn a_zoom_keeps_what_is_under_the_pointer_and_ends_at_the_axes() {
        for (at, factor) in [(0.0, 2.0), (5.0, 4.0), (29.0, 1.5)] {
            let (low, high) = steered(FULL, FULL, at, factor, 0.0);
            assert!((high - low - 40.0 / factor).abs() < 1e-9);
            assert!(((at - low) / (high - low) - (at + 10.0) / 40.0).abs() < 1e-9, "{at}");
        }
        assert_eq!(steered(FULL, (0.0, 10.0), 5.0, 1e-6, 0.0), FULL);
        for i in 0..1000 {
            let full = (f64::from(i).ln_1p(), 3.0 + f64::from(i).sqrt());
            let seen = steered(full, full, 2.0, 1.0, 0.0);
            assert!(seen.0 == full.0 && (seen.1 - full.1).abs() < 1e-12, "{full:?}");
        }
        let (low, high) = steered(FULL, FULL, 5.0, 1e9, 0.0);
        assert!(low < 5.0 && 5.0 < high && (high - low - 0.04).abs() < 1e-9);
    }

    #[test]
    fn a_motion_ends_at_the_axes() {
        assert_eq!(steered(FULL, (0.0, 10.0), 0.0, 1.0, 3.0), (3.0, 13.0));
        assert_eq!(steered(FULL, (0.0, 10.0), 0.0, 1.0, -99.0), (-10.0, 0.0));
        assert_eq!(steered(FULL, (0.0, 10.0), 0.0, 1.0, 99.0), (20.0, 30.0));
        assert_eq!(steered(FULL, (-50.0, 50.0), 0.0, 1.0, 0.0), FULL);
    }
}
