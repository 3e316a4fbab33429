//! The plots of waveform and spectrum, from the codes of the mirror.

pub(crate) mod finger_trace;
pub(crate) mod frame;
pub(crate) mod response;
mod scale;
mod so_far;
pub(crate) mod steer;
pub(crate) mod tabs;

use crate::intent::{Asks as _, Intent, Intents};
use crate::scene::Scene;
use crate::view::kept::{PlotsAxes, PlotsContent, PlotsView};
use crate::view::theme;
use eframe::egui::{self, Align2, FontId, pos2};
use egui_plot::{Line, PlotPoint, PlotPoints, PlotResponse, VLine};
use frame::{Frame, fit, plot, seen_apart};
use slipline_model::field::steady_field::magnification;
use slipline_model::waveform::level_at;
use slipline_plate::order;
use slipline_plate::quantity::show_frequency;
use steer::steer;
use tabs::{SPECTRUM, SPECTRUM_HELP, WAVEFORM, WAVEFORM_HELP, headed};

/// What a logarithmic axis is for.
pub(crate) const LOGARITHMIC_HELP: &str = "Every decade equally wide, so that low tones are separated";

/// Most points of the waveform plot.
const POINTS: usize = 900;
/// Periods of the plate's slowest tone that the waveform shows.
const TURNS: f64 = 4.0;
/// Fewest codes that the waveform shows.
const LEAST_CODES: f64 = 64.0;
/// The spectrum is drawn up to this multiple of the plate's highest tone.
const HARMONICS: f64 = 3.0;
/// A logarithmic axis begins at this share of the plate's lowest tone.
const LOWEST: f64 = 0.1;
/// The spectrum is drawn down to here, in dB of full scale.
const FLOOR_DB: f64 = -120.0;
/// Tones down to here get a label in the spectrum, in dB of full scale.
const PEAK_FLOOR_DB: f64 = -80.0;
/// Rows of a label from its peak, negative above it, the best first.
const ROWS: [i32; 6] = [0, -1, 1, 2, 3, 4];

/// The ranges of the plots for the plate on the screen.
fn axes(scene: &Scene<'_>) -> PlotsAxes {
    let (low_hz, high_hz) = scene.setup.plate.band_hz();
    let rate_hz = scene.waveform.window().map_or(f64::INFINITY, |window| window.sample_rate_hz);
    PlotsAxes {
        span_s: (TURNS / low_hz).max(LEAST_CODES / rate_hz),
        top_hz: (HARMONICS * high_hz).min(0.5 * rate_hz),
        bottom_hz: LOWEST * low_hz,
    }
}

/// The present content. Paused plots keep theirs.
fn look<'a>(scene: &Scene<'_>, view: &'a mut PlotsView) -> &'a PlotsContent {
    let now = || {
        let steady = scene.sounding.unwrap_or(scene.predicted);
        let pitches = steady.tones.iter().map(|wave| wave.tone.frequency_hz).collect();
        PlotsContent { axes: axes(scene), pitches }
    };
    if scene.settings.animate {
        view.shown = None;
    }
    view.shown.get_or_insert_with(now)
}

/// Whether the plots show anything: something sounds, or they are paused.
fn is_shown(scene: &Scene<'_>) -> bool {
    scene.waveform.is_true() && (scene.sounding.is_some() || !scene.settings.animate)
}

/// The heading of a plot with its controls; `more` adds to its menu. Returns whether all is to be shown again.
fn head(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    (plots, name): (&mut PlotsView, &str),
    intents: &mut Intents,
    more: impl FnOnce(&mut egui::Ui, &mut PlotsView),
) -> bool {
    let is_wide = tabs::is_wide(ui);
    headed(ui, plots, name, |ui, plots| {
        pause(ui, scene, name, intents);
        let is_fitted = is_wide && fit(ui, name);
        let help = "Hold a curve to compare, and the scales of this plot";
        let is_fitted_there = frame::more(ui, name, help, |ui| {
            let is_fitted = !is_wide && fit(ui, name);
            more(ui, plots);
            is_fitted
        });
        is_fitted || is_fitted_there
    })
}

/// The switch that holds the present curve behind the later ones.
fn hold(ui: &mut egui::Ui, held: &mut Option<Vec<[f64; 2]>>, now: impl FnOnce() -> Option<Vec<[f64; 2]>>) {
    let mut is_held = held.is_some();
    let switch = ui.checkbox(&mut is_held, "Hold to compare");
    if switch.on_hover_text("Keep the present curve behind the later ones").changed() {
        *held = if is_held { now() } else { None };
    }
}

/// The button that holds all plots and the wave; `name` is the plot's that it belongs to.
pub(crate) fn pause(ui: &mut egui::Ui, scene: &Scene<'_>, name: &str, intents: &mut Intents) {
    let word = if scene.settings.animate { "Pause" } else { "Resume" };
    let pause = ui.small_button(word);
    pause.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{word}: {name}")));
    pause
        .on_hover_text("Pause the plots and the wave (P)")
        .asks(intents, Intent::Animate(!scene.settings.animate));
}

/// The text in place of an empty plot of the drive.
fn nothing(ui: &mut egui::Ui, scene: &Scene<'_>) {
    let is_lost = scene.sounding.is_some() && !scene.waveform.is_true();
    let lost = if scene.snapshot.is_holding() { HELD } else { "not followed: stop and drive again" };
    if is_lost { empty(ui, lost) } else { at_rest(ui, scene) }
}

/// The text of an empty plot while the device holds levels and changes the drive by itself.
const HELD: &str = "not known while levels are held";
/// In the place of a plot while the setup does not sound: the measurement under way, or why nothing is drawn.
pub(crate) fn at_rest(ui: &mut egui::Ui, scene: &Scene<'_>) {
    let live = &scene.measure.live;
    match &live.so_far {
        Some(so_far) => so_far::show(ui, so_far),
        None if live.progress.is_some() => empty(ui, "the plate is being measured"),
        None => empty(ui, "nothing is driven"),
    }
}

/// An empty plot, and why it is empty.
pub(crate) fn empty(ui: &mut egui::Ui, text: &str) {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(ui.available_size(), egui::Sense::hover());
    ui.painter().rect_filled(rect, 4.0, palette.well);
    let font = egui::FontId::proportional(12.5);
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, text, font, palette.weak);
}

/// A note at the top of a plot: that a curve is held, and how much is magnified.
fn note(ui: &egui::Ui, shown: &PlotResponse<()>, is_held: bool, factor: f64) {
    let palette = theme::palette(ui);
    let mut words = Vec::new();
    if factor > 1.0 {
        words.push(format!("×{factor}"));
    }
    if is_held {
        words.push("held: thin line".to_owned());
    }
    let frame = shown.transform.frame();
    let place = pos2(frame.right() - 4.0, frame.top() + 2.0);
    let font = FontId::proportional(11.5);
    ui.painter().text(place, Align2::RIGHT_TOP, words.join("   "), font, palette.weak);
}

/// A curve that is held, drawn thin.
fn held_line(points: Vec<[f64; 2]>, palette: &theme::Palette) -> Line<'static> {
    Line::new("held", PlotPoints::from(points)).color(palette.weak).width(1.0).allow_hover(false)
}

pub(crate) fn waveform(ui: &mut egui::Ui, scene: &Scene<'_>, plots: &mut PlotsView, intents: &mut Intents) {
    let axes = look(scene, plots).axes;
    let window = scene.waveform.window().filter(|_| is_shown(scene));
    let codes = window.map(|window| {
        let wanted = (axes.span_s * window.sample_rate_hz).ceil() as usize;
        let shown = wanted.min(window.codes.len());
        // Begin at a rising zero crossing, as an oscilloscope does, so that the plot stands still.
        let latest = window.codes.len() - shown;
        let trigger = (latest.saturating_sub(shown / 2)..latest)
            .rev()
            .find(|&i| i > 0 && window.codes[i - 1] < 2048 && window.codes[i] >= 2048)
            .unwrap_or(latest);
        (&window.codes[trigger..trigger + shown], window.sample_rate_hz)
    });
    let curve = || {
        let (codes, rate_hz) = codes?;
        let step = codes.len().div_ceil(POINTS).max(1);
        let shares = codes.iter().step_by(step).map(|&code| (f64::from(code) - 2048.0) / 2048.0);
        Some(shares.enumerate().map(|(i, share)| [(i * step) as f64 / rate_hz, share]).collect())
    };
    let is_reset = head(ui, scene, (&mut *plots, WAVEFORM), intents, |ui, plots| {
        hold(ui, &mut plots.held_waveform, curve);
        ui.checkbox(&mut plots.is_magnified, "Magnify to fit")
            .on_hover_text("Show a weak drive larger; the factor is written in the plot");
    });
    let Some(points): Option<Vec<[f64; 2]>> = curve() else { return nothing(ui, scene) };
    let palette = theme::palette(ui);
    let largest = points.iter().map(|point| point[1].abs()).fold(0.0, f64::max);
    let factor = if plots.is_magnified { magnification(largest) } else { 1.0 };
    let (unit, scale) = if axes.span_s < 2e-3 { ("µs", 1e6) } else { ("ms", 1e3) };
    let scaled =
        |points: &[[f64; 2]]| points.iter().map(|[time_s, share]| [time_s * scale, *share]).collect();
    let (x, y) = ((0.0, axes.span_s * scale), (-1.15 / factor, 1.15 / factor));
    let frame = Frame { name: "waveform", x, y, unit, logarithmic: None };
    let values = move |at: PlotPoint| format!("{:.2} {unit}\n{:.3} of full scale", at.x, at.y);
    let plot = plot(&frame, palette, is_reset, values);
    let held: Option<Vec<[f64; 2]>> = plots.held_waveform.as_deref().map(scaled);
    let is_held = held.is_some();
    let points: Vec<[f64; 2]> = scaled(&points);
    let shown = plot.show(ui, |plot| {
        steer(plot, [x, y]);
        held.into_iter().for_each(|held| plot.line(held_line(held, palette)));
        let points = seen_apart(plot, &points);
        let line = Line::new("code, of full scale", PlotPoints::from(points));
        plot.line(line.color(palette.accent).width(1.4));
    });
    theme::describe(&shown.response, "Plot of the drive waveform", WAVEFORM_HELP);
    note(ui, &shown, is_held, factor);
}

pub(crate) fn spectrum(ui: &mut egui::Ui, scene: &Scene<'_>, plots: &mut PlotsView, intents: &mut Intents) {
    let PlotsContent { axes, pitches } = look(scene, plots);
    let (axes, pitches) = (*axes, pitches.clone());
    let lines = if is_shown(scene) { scene.waveform.spectrum() } else { &[] };
    let curve = || {
        let within = lines.iter().take_while(|line| line.frequency_hz <= axes.top_hz);
        let points = within.map(|line| [line.frequency_hz, line.level_db.max(FLOOR_DB)]).collect();
        (!lines.is_empty()).then_some(points)
    };
    let is_reset = head(ui, scene, (&mut *plots, SPECTRUM), intents, |ui, plots| {
        hold(ui, &mut plots.held_spectrum, curve);
        ui.checkbox(&mut plots.is_logarithmic, "Logarithmic frequency").on_hover_text(LOGARITHMIC_HELP);
    });
    let Some(points): Option<Vec<[f64; 2]>> = curve() else { return nothing(ui, scene) };
    let palette = theme::palette(ui);
    let (unit, scale) = if axes.top_hz >= 5000.0 { ("kHz", 1e-3) } else { ("Hz", 1.0) };
    let is_logarithmic = plots.is_logarithmic;
    let place = move |hertz: f64| {
        if is_logarithmic { hertz.max(axes.bottom_hz).log10() } else { hertz * scale }
    };
    let start = if is_logarithmic { axes.bottom_hz } else { 0.0 };
    let x = (place(start), place(axes.top_hz));
    let y = (FLOOR_DB, 12.0);
    let frame = Frame { name: "spectrum", x, y, unit, logarithmic: is_logarithmic.then_some(scale) };
    let plot = plot(&frame, palette, is_reset, move |at| {
        let hertz = if is_logarithmic { 10f64.powf(at.x) } else { at.x / scale };
        format!("{}\n{:.1} dB", show_frequency(hertz), at.y)
    });
    let placed = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let shown = points.iter().filter(|[hertz, _]| *hertz >= start);
        shown.map(|[hertz, level_db]| [place(*hertz), *level_db]).collect()
    };
    let held = plots.held_spectrum.as_deref().map(placed);
    let is_held = held.is_some();
    let points = placed(&points);
    let (accent, weak) = (palette.accent, palette.weak);
    let shown = plot.show(ui, |plot| {
        steer(plot, [x, y]);
        for &hertz in &pitches {
            let line = VLine::new(show_frequency(hertz), place(hertz));
            plot.vline(line.color(weak.gamma_multiply(0.5)).width(1.0).allow_hover(false));
        }
        held.into_iter().for_each(|held| plot.line(held_line(held, palette)));
        let points = seen_apart(plot, &points);
        plot.line(Line::new("dB of full scale", PlotPoints::from(points)).color(accent).width(1.2));
    });
    theme::describe(&shown.response, "Plot of the spectrum", SPECTRUM_HELP);
    note(ui, &shown, is_held, 1.0);
    let level = |&hertz: &f64| Some((hertz, level_at(lines, hertz).filter(|level| *level > PEAK_FLOOR_DB)?));
    let mut tones: Vec<(f64, f64)> = pitches.iter().filter_map(level).collect();
    order::sort_by(&mut tones, |a, b| b.1.total_cmp(&a.1));
    label_tones(ui, &shown, tones.into_iter().map(|(hertz, level_db)| (place(hertz), level_db, hertz)));
}

/// Writes the frequency of each tone (x, y and Hz) at its peak, the strongest first: over it, or in the first row above or
/// below where there is room.
fn label_tones(ui: &egui::Ui, shown: &PlotResponse<()>, tops: impl Iterator<Item = (f64, f64, f64)>) {
    let palette = theme::palette(ui);
    let (frame, bounds) = (*shown.transform.frame(), *shown.transform.bounds());
    let painter = ui.painter().with_clip_rect(frame);
    let mut taken: Vec<egui::Rect> = Vec::new();
    for (x, y, hertz) in tops.filter(|(x, ..)| bounds.range_x().contains(x)) {
        let font = FontId::proportional(11.0);
        let galley = painter.layout_no_wrap(show_frequency(hertz), font, palette.text);
        let at = shown.transform.position_from_point(&PlotPoint::new(x, y));
        let size = galley.size();
        let left = (at.x - 0.5 * size.x).min(frame.right() - size.x).max(frame.left());
        let top = (at.y - size.y - 1.0).max(frame.top());
        let rect = egui::Rect::from_min_size(pos2(left, top), size);
        let row = |n: i32| rect.translate(egui::vec2(0.0, n as f32 * size.y));
        let is_free = |rect: &egui::Rect| {
            frame.y_range().contains(rect.top())
                && frame.y_range().contains(rect.bottom())
                && taken.iter().all(|other| !other.expand2(egui::vec2(2.0, -0.5)).intersects(*rect))
        };
        if let Some(rect) = ROWS.map(row).into_iter().find(is_free) {
            // The lines of its neighbours do not cross its digits.
            painter.rect_filled(rect, 2.0, palette.well.gamma_multiply(0.8));
            painter.galley(rect.min, galley, palette.text);
            taken.push(rect);
        }
    }
}
