//! A measurement under way, in the place of a plot of the drive: the answers so far, each a dot, over the curve of the plate's model.

use super::frame::{Frame, plot};
use super::steer::steer;
use crate::scene::SoFar;
use crate::view::theme;
use eframe::egui::{self, Align2, FontId, pos2};
use egui_plot::{Line, PlotPoints, Points};
use slipline_plate::quantity::{show_frequency, ticks};

/// The highest level of the axis, dB of the model's highest; the lowest one is a multiple of the step, with this room below the model.
const HIGHEST_DB: f64 = 10.0;
const STEP_DB: f64 = 10.0;
/// Frequencies from here on are written in kilohertz.
const KILOHERTZ_FROM: f64 = 5000.0;
/// Radius of an answer, in points.
const DOT: f32 = 3.0;

pub(super) fn show(ui: &mut egui::Ui, so_far: &SoFar<'_>) {
    let palette = theme::palette(ui);
    let Some((low, high)) = so_far.planned.first().zip(so_far.planned.last()) else { return };
    let is_high = high.frequency_hz >= KILOHERTZ_FROM;
    let (unit, scale) = if is_high { ("kHz", 1e-3) } else { ("Hz", 1.0) };
    let x = (scale * low.frequency_hz, scale * high.frequency_hz);
    let levels = so_far.levels_db();
    let lowest_db = levels.model.iter().map(|at| at[1]).fold(-STEP_DB, f64::min);
    let y = (STEP_DB * (lowest_db / STEP_DB - 1.0).floor(), HIGHEST_DB);
    let frame = Frame { name: "measured so far", x, y, unit, logarithmic: None };
    let values = move |at: egui_plot::PlotPoint| {
        format!("{}\n{} dB", show_frequency(at.x / scale), ticks::label(at.y, 0.1))
    };
    let placed = |points: Vec<[f64; 2]>| -> PlotPoints<'_> {
        points.into_iter().map(|[hertz, level_db]| [scale * hertz, level_db.max(y.0)]).collect()
    };
    let shown = plot(&frame, palette, false, values).show(ui, |plot| {
        steer(plot, [x, y]);
        let model = Line::new("model", placed(levels.model)).color(palette.accent).width(1.4);
        plot.line(model.allow_hover(false));
        let measured = Points::new("measured", placed(levels.measured)).color(palette.text).radius(DOT);
        plot.points(measured.allow_hover(false));
    });
    let words = words(so_far);
    let corner = *shown.transform.frame();
    let painter = ui.painter().with_clip_rect(corner);
    let at = pos2(corner.right() - 5.0, corner.top() + 2.0);
    painter.text(at, Align2::RIGHT_TOP, &words, FontId::proportional(11.5), palette.weak);
    theme::describe(&shown.response, &words, "Level at the sensor over frequency, dB of the model's highest");
}

/// The number of answers so far, and what is drawn.
fn words(so_far: &SoFar<'_>) -> String {
    let (measured, all) = (so_far.measured.len(), so_far.planned.len());
    if measured == 0 {
        return format!("model: line; the first of {all} answers is awaited");
    }
    format!("model: line; measured: {measured} of {all}, level fitted")
}
