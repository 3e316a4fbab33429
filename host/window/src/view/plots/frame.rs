//! The frame of every plot of the window: its axes, their labels, the values under the pointer; zoom and motion are
//! [`super::steer`]'s.

use super::scale::{GRID, decade_label, decades, marks};
use super::steer::Ends;
use crate::view::stage::polyline::kept;
use crate::view::theme;
use eframe::egui::{self, FontId, Id, Rangef};
use egui_plot::{AxisHints, GridMark, HoverPosition, Plot, PlotPoint, PlotUi};
use slipline_plate::quantity::ticks;
use std::ops::RangeInclusive;

/// The button that shows all of a plot again.
pub(in crate::view) fn fit(ui: &mut egui::Ui, name: &str) -> bool {
    let fit = ui.small_button("Fit");
    fit.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Fit {name}")));
    fit.on_hover_text(
        "Show all again (or double-click). The wheel zooms, with Shift the values; drag to move",
    )
    .clicked()
}

/// The small menu of a plot, which `entries` shows; returns whether all is to be shown again.
pub(in crate::view) fn more(
    ui: &mut egui::Ui,
    name: &str,
    help: &str,
    entries: impl FnOnce(&mut egui::Ui) -> bool,
) -> bool {
    let button = egui::containers::menu::MenuButton::from_button(egui::Button::new("…").small());
    let (response, menu) = button.ui(ui, entries);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("More: {name}")));
    response.on_hover_text(help);
    menu.is_some_and(|menu| menu.inner)
}

/// The least distance of labels, in points: of the x axis, of the y axis.
const SPACING: (f64, f64) = (56.0, 26.0);
/// Space that a label of the x axis needs right of its tick mark, in points.
const HALF_LABEL: f64 = 16.0;

/// The axes of a plot.
pub(in crate::view) struct Frame {
    pub(in crate::view) name: &'static str,
    pub(in crate::view) x: Ends,
    pub(in crate::view) y: Ends,
    pub(in crate::view) unit: &'static str,
    /// From the values on the x axis to the unit; `None` for an axis that has the unit already. Then x is the decimal
    /// logarithm.
    pub(in crate::view) logarithmic: Option<f64>,
}

/// The zoom memory of a frame: each has its own, because a zoom makes no sense on other axes.
fn memory(frame: &Frame) -> Id {
    let Frame { name, x, y, logarithmic, .. } = *frame;
    Id::unique((name, [x.0, x.1, y.0, y.1].map(f64::to_bits), logarithmic.is_some()))
}

/// A plot in this frame; all of it is shown again if it is reset.
pub(in crate::view) fn plot<'a>(
    frame: &Frame,
    palette: &theme::Palette,
    is_reset: bool,
    values: impl Fn(PlotPoint) -> String + 'a,
) -> Plot<'a> {
    let Frame { name, x, y, unit, logarithmic } = *frame;
    let font = FontId::proportional(11.5);
    let x_axis = AxisHints::new_x()
        .label_spacing(Rangef::new(8.0, 9.0))
        .tick_label_color(palette.weak)
        .tick_label_font(font.clone())
        .formatter(move |mark, range| match logarithmic {
            Some(scale) => decade_label(mark, unit, scale),
            None => x_label(mark, range, unit),
        });
    let y_axis = AxisHints::new_y()
        .label_spacing(Rangef::new(8.0, 9.0))
        .tick_label_color(palette.weak)
        .tick_label_font(font)
        .min_thickness(34.0)
        .formatter(|mark, _| ticks::label(mark.value, mark.step_size));
    let plot = Plot::new(name)
        .id(memory(frame))
        .default_x_bounds(x.0, x.1)
        .default_y_bounds(y.0, y.1)
        .custom_x_axes(vec![x_axis])
        .custom_y_axes(vec![y_axis])
        .x_grid_spacer(move |input| match logarithmic {
            Some(_) => decades(&input, SPACING.0, HALF_LABEL),
            None => marks(&input, SPACING.0, HALF_LABEL),
        })
        .y_grid_spacer(|input| marks(&input, SPACING.1, 0.0))
        .label_formatter(move |at| {
            let (HoverPosition::NearDataPoint { position, .. } | HoverPosition::Elsewhere { position }) = at;
            Some(values(*position))
        })
        .grid_color(palette.grid)
        .grid_fade(0.0)
        .grid_spacing(Rangef::new(GRID, 120.0))
        .cursor_color(palette.weak)
        .show_background(true)
        .allow_double_click_reset(true)
        // Wheel and pointer are followed here, within the axes.
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_axis_zoom_drag(false)
        .allow_boxed_zoom(false)
        .show_grid(true);
    if is_reset { plot.reset() } else { plot }
}

/// The points of a curve that can be seen apart in this plot, as it is zoomed at present.
pub(in crate::view) fn seen_apart(plot: &PlotUi<'_>, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let at = points.iter().map(|[x, y]| plot.screen_from_plot(PlotPoint::new(*x, *y)));
    kept(&at.collect::<Vec<_>>()).into_iter().map(|number| points[number]).collect()
}

/// A label of the x axis; the first one has the unit.
fn x_label(mark: GridMark, range: &RangeInclusive<f64>, unit: &str) -> String {
    let label = ticks::label(mark.value, mark.step_size);
    if mark.value - mark.step_size < range.start() - 1e-6 * mark.step_size {
        format!("{label} {unit}")
    } else {
        label
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_grows_at_either_end_shows_all_of_it() {
        let frame = |x: Ends, y: Ends| Frame { name: "phase", x, y, unit: "Hz", logarithmic: None };
        let seen = memory(&frame((0.0, 1.0), (90.0, 540.0)));
        assert_eq!(memory(&frame((0.0, 1.0), (90.0, 540.0))), seen);
        for (x, y) in [
            ((0.0, 1.0), (0.0, 540.0)),
            ((0.0, 1.0), (90.0, 630.0)),
            ((0.5, 1.0), (90.0, 540.0)),
            ((0.0, 2.0), (90.0, 540.0)),
        ] {
            assert_ne!(memory(&frame(x, y)), seen, "{x:?} {y:?}: it would stay as it was zoomed before");
        }
    }
}
