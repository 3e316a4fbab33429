//! The response in the complex plane. Time counts as e^(-j omega t): a lag turns to the left.

use super::curves::Curves;
use crate::view::plots::{
    frame::{Frame, plot},
    steer::steer_evenly,
};
use crate::view::theme;
use eframe::egui::{self, Align2, FontId, pos2};
use egui_plot::{Line, LineStyle, PlotPoint, PlotPoints};
use slipline_plate::quantity::{show_frequency, ticks};

/// Half of the plane's height, over the largest magnitude of measurements and model.
const ROOM: f64 = 1.12;
/// A smaller change of the plot's shape is only rounding.
const DIFFERS: f64 = 5e-3;
const TITLE: &str = "Nyquist, of the largest";

/// Shows the plane; `aspect` is the plot's width over its height as it was shown last.
pub(super) fn show(ui: &mut egui::Ui, curves: &Curves<'_>, is_reset: bool, aspect: &mut f64) {
    let palette = theme::palette(ui);
    // Both axes have one scale.
    let room = ROOM * curves.reach;
    let half = (room * aspect.max(1.0), room * aspect.recip().max(1.0));
    let (x, y) = ((-half.0, half.0), (-half.1, half.1));
    let frame = Frame { name: "nyquist", x, y, unit: "Re", logarithmic: None };
    let plot = plot(&frame, palette, is_reset, |at| read_out(curves, at));
    let inks: Vec<egui::Color32> = curves.shown.iter().map(|entry| curves.ink(ui, entry)).collect();
    let shown = plot.show(ui, |plot| {
        steer_evenly(plot, [x, y]);
        for (entry, ink) in curves.shown.iter().zip(&inks) {
            let points = entry.measurement.points.iter();
            let curve: Vec<[f64; 2]> = points.map(|point| curves.of_largest(point.response)).collect();
            let line = Line::new(entry.name.clone(), PlotPoints::from(curve)).allow_hover(false);
            plot.line(line.color(*ink).width(curves.width(entry)));
        }
        if let Some(model) = &curves.model {
            let answers = model.comparison.predicted.iter().flatten();
            let curve: Vec<[f64; 2]> = answers.map(|answer| curves.of_largest(*answer)).collect();
            let line = Line::new("model", PlotPoints::from(curve)).allow_hover(false);
            plot.line(line.color(palette.text).width(1.2).style(LineStyle::Dashed { length: 6.0 }));
        }
    });
    let seen = *shown.transform.frame();
    let now = f64::from(seen.width() / seen.height().max(1.0)).clamp(0.1, 10.0);
    if (now / *aspect - 1.0).abs() > DIFFERS {
        *aspect = now;
        ui.ctx().request_discard("the shape of the plane has changed");
    }
    let font = FontId::proportional(11.5);
    let place = pos2(seen.left() + 5.0, seen.top() + 2.0);
    ui.painter().text(place, Align2::LEFT_TOP, TITLE, font, palette.weak);
    let summary = format!("{TITLE} of {} measurements", curves.shown.len());
    theme::describe(&shown.response, &summary, HELP);
}

const HELP: &str = "Measurements and model in the complex plane: a resonance is a circle";

/// The frequency and the value of the chosen measurement's nearest point.
fn read_out(curves: &Curves<'_>, at: PlotPoint) -> String {
    let number = |value: f64| ticks::label(value, 0.01);
    let Some(chosen) = curves.chosen else { return format!("{} {}j", number(at.x), number(at.y)) };
    let points = chosen.measurement.points.iter();
    let near = points.map(|point| (point.frequency_hz, curves.of_largest(point.response)));
    let nearest = near.min_by(|a, b| {
        let away = |[x, y]: [f64; 2]| (x - at.x).hypot(y - at.y);
        away(a.1).total_cmp(&away(b.1))
    });
    nearest.map_or_else(String::new, |(hertz, [re, im])| {
        format!("{}\nRe {}\nIm {}", show_frequency(hertz), number(re), number(im))
    })
}
