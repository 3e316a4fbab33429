//! Level, phase and residual over the frequency, one under the other over one axis.

use super::curves::Curves;
use crate::view::plots::{
    frame::{Frame, plot},
    steer::steer,
};
use crate::view::theme;
use eframe::egui::{self, Align2, FontId, Id, pos2};
use egui_plot::{FilledArea, HLine, Line, LineStyle, PlotPoints, PlotUi};
use slipline_model::response::Entry;
use slipline_plate::order;
use slipline_plate::quantity::{show_frequency, ticks};

/// One of the plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Strip {
    /// Magnitude in dB, with the noise of the chosen measurement.
    Level,
    /// Unwrapped phase.
    Phase,
    /// The measurement over the plate's model, in dB.
    Residual,
}

/// A frequency axis of one frequency gets this much to both sides, as a share.
const NARROW: f64 = 0.01;

impl Strip {
    const fn title(self) -> &'static str {
        match self {
            Self::Level => "Level, dB",
            Self::Phase => "Phase, degrees",
            Self::Residual => "Measured over model, dB",
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Level => "response level",
            Self::Phase => "response phase",
            Self::Residual => "response residual",
        }
    }
}

/// Shows a strip; the last one has the labels of the frequencies.
pub(super) fn show(ui: &mut egui::Ui, curves: &Curves<'_>, strip: Strip, is_last: bool, is_reset: bool) {
    let palette = theme::palette(ui);
    let (low_hz, high_hz) = curves.hertz;
    let share = if high_hz > (1.0 + NARROW) * low_hz { 1.0 } else { 1.0 + NARROW };
    let x = (curves.place(low_hz / share), curves.place(high_hz * share));
    let y = match strip {
        Strip::Level => curves.level_db,
        Strip::Phase => curves.phase_deg,
        Strip::Residual => (-curves.residual_db, curves.residual_db),
    };
    let frame = Frame { name: strip.name(), x, y, unit: curves.unit().0, logarithmic: curves.logarithmic() };
    let values = |at: egui_plot::PlotPoint| read_out(curves, strip, at.x, at.y);
    let linked = Id::unique(("response", x.0.to_bits(), x.1.to_bits()));
    let plot = plot(&frame, palette, is_reset, values).show_axes([is_last, true]);
    let plot = plot.link_axis(linked, [true, false]).link_cursor(linked, [true, false]);
    let inks: Vec<egui::Color32> = curves.shown.iter().map(|entry| curves.ink(ui, entry)).collect();
    let shown = plot.show(ui, |plot| {
        steer(plot, [x, y]);
        match strip {
            Strip::Level => {
                noise(plot, curves, palette);
                each(plot, curves, &inks, |entry| entry.bode.level_db.iter().map(|db| Some(*db)).collect());
                model(plot, curves, palette, |model| &model.level_db);
            }
            Strip::Phase => {
                each(plot, curves, &inks, |entry| entry.bode.phase_deg.clone());
                model(plot, curves, palette, |model| &model.phase_deg);
            }
            Strip::Residual => residual(plot, curves, palette),
        }
    });
    let corner = *shown.transform.frame();
    let font = FontId::proportional(11.5);
    let painter = ui.painter().with_clip_rect(corner);
    let at = |x: f32| pos2(x, corner.top() + 2.0);
    let title =
        painter.text(at(corner.left() + 5.0), Align2::LEFT_TOP, strip.title(), font.clone(), palette.weak);
    let legend = match (strip, &curves.model) {
        (Strip::Level, Some(model)) if model.comparison.level_db != 0.0 => "model: dashed, level fitted",
        (Strip::Level | Strip::Phase, Some(_)) => "model: dashed",
        (Strip::Residual, Some(_)) => "shade: 95 % of the noise",
        (Strip::Residual, None) => "no model of the plate yet",
        (_, None) => "",
    };
    let legend = painter.layout_no_wrap(legend.to_owned(), font, palette.weak);
    let left = corner.right() - 5.0 - legend.size().x;
    if left > title.right() + 8.0 {
        painter.galley(at(left), legend, palette.weak);
    }
    let summary = summary(curves, strip);
    theme::describe(&shown.response, &summary, HELP);
}

const HELP: &str =
    "The chosen measurement bright, the others dim, and the plate's model as a line, over the frequency";

/// The description of a plot for a screen reader.
fn summary(curves: &Curves<'_>, strip: Strip) -> String {
    let (low, high) = curves.hertz;
    let over = format!("{} to {}", show_frequency(low), show_frequency(high));
    format!("{} of {} measurements from {over}", strip.title(), curves.shown.len())
}

fn lines(
    plot: &mut PlotUi<'_>,
    name: &str,
    pieces: Vec<Vec<[f64; 2]>>,
    dress: impl Fn(Line<'static>) -> Line<'static>,
) {
    for piece in pieces {
        plot.line(dress(Line::new(name.to_owned(), PlotPoints::from(piece)).allow_hover(false)));
    }
}

/// A curve of every measurement that is shown; the chosen one comes last, on top.
fn each(
    plot: &mut PlotUi<'_>,
    curves: &Curves<'_>,
    inks: &[egui::Color32],
    values: impl Fn(&Entry) -> Vec<Option<f64>>,
) {
    let mut entries: Vec<(&&Entry, &egui::Color32)> = curves.shown.iter().zip(inks).collect();
    order::sort_by_key(&mut entries, |(entry, _)| {
        curves.chosen.is_some_and(|chosen| chosen.number == entry.number)
    });
    for (entry, ink) in entries {
        let pieces = curves.pieces(&entry.bode, values(entry).into_iter());
        lines(plot, &entry.name, pieces, |line| line.color(*ink).width(curves.width(entry)));
    }
}

fn model<'a>(
    plot: &mut PlotUi<'_>,
    curves: &'a Curves<'_>,
    palette: &theme::Palette,
    values: impl Fn(&'a super::curves::Model<'_>) -> &'a Vec<Option<f64>>,
) {
    let (Some(chosen), Some(model)) = (curves.chosen, &curves.model) else { return };
    let pieces = curves.pieces(&chosen.bode, values(model).iter().copied());
    lines(plot, "model", pieces, |line| {
        line.color(palette.text).width(1.4).style(LineStyle::Dashed { length: 6.0 })
    });
}

/// The noise of the chosen measurement, filled from below.
fn noise(plot: &mut PlotUi<'_>, curves: &Curves<'_>, palette: &theme::Palette) {
    let Some(chosen) = curves.chosen else { return };
    let x: Vec<f64> = chosen.bode.frequency_hz.iter().map(|hertz| curves.place(*hertz)).collect();
    let floor = vec![curves.level_db.0; x.len()];
    let noise: Vec<f64> = chosen.bode.noise_db.iter().map(|db| db.max(curves.level_db.0)).collect();
    let area = FilledArea::new("noise", &x, &floor, &noise).fill_color(palette.weak.gamma_multiply(0.25));
    plot.add(area.allow_hover(false));
}

fn residual(plot: &mut PlotUi<'_>, curves: &Curves<'_>, palette: &theme::Palette) {
    plot.hline(HLine::new("none", 0.0).color(palette.weak).width(1.0).allow_hover(false));
    let (Some(chosen), Some(model)) = (curves.chosen, &curves.model) else { return };
    let x: Vec<f64> = chosen.bode.frequency_hz.iter().map(|hertz| curves.place(*hertz)).collect();
    let spread: Vec<f64> = chosen.bode.spread_db.iter().map(|db| db.min(curves.residual_db)).collect();
    let below: Vec<f64> = spread.iter().map(|db| -db).collect();
    let area = FilledArea::new("noise", &x, &below, &spread).fill_color(palette.weak.gamma_multiply(0.25));
    plot.add(area.allow_hover(false));
    let most = curves.residual_db;
    let off = model.comparison.off_db.iter().map(|off| off.map(|off| off.clamp(-most, most)));
    let ink = if model.comparison.is_other_plate() { palette.wrong } else { palette.good };
    let pieces = curves.pieces(&chosen.bode, off);
    lines(plot, "residual", pieces, |line| line.color(ink).width(1.6));
}

/// The values of the chosen measurement under the pointer; without one, those of the axes.
fn read_out(curves: &Curves<'_>, strip: Strip, x: f64, y: f64) -> String {
    let decibel = |db: f64| format!("{} dB", ticks::label(db, 0.1));
    let degrees = |deg: f64| format!("{}°", ticks::label(deg, 1.0));
    let Some((chosen, i)) = curves.chosen.zip(curves.nearest(x)) else {
        let value = if strip == Strip::Phase { degrees(y) } else { decibel(y) };
        return format!("{}\n{value}", show_frequency(curves.hertz_at(x)));
    };
    let bode = &chosen.bode;
    let mut lines = vec![show_frequency(bode.frequency_hz[i])];
    let model = curves.model.as_ref();
    match strip {
        Strip::Level => {
            lines.push(format!("measured {}", decibel(bode.level_db[i])));
            lines.extend(model.and_then(|it| it.level_db[i]).map(|db| format!("model {}", decibel(db))));
            lines.push(format!("noise {}", decibel(bode.noise_db[i])));
            let room = chosen.measurement.points[i].headroom_db;
            lines.extend(room.map(|db| format!("headroom {}", decibel(db))));
        }
        Strip::Phase => {
            lines.push(
                bode.phase_deg[i].map_or("noise".to_owned(), |deg| format!("measured {}", degrees(deg))),
            );
            lines.extend(model.and_then(|it| it.phase_deg[i]).map(|deg| format!("model {}", degrees(deg))));
        }
        Strip::Residual => {
            let off = model.and_then(|it| it.comparison.off_db[i]);
            lines.push(off.map_or("no model".to_owned(), |db| format!("off by {}", decibel(db))));
            lines.push(format!("noise ±{}", decibel(bode.spread_db[i])));
        }
    }
    lines.join("\n")
}
