//! The plots of waveform and spectrum, from the codes of the mirror.

use super::{Scene, ViewState, aligned, theme};
use crate::intent::{Intent, Intents};
use eframe::egui::{self, FontId, Id, Rangef};
use egui_plot::{AxisHints, GridInput, GridMark, Line, Plot, PlotPoints, VLine};
use slipline_plate::quantity::{
    show_frequency,
    ticks::{self, Ticks},
};
use std::ops::RangeInclusive;

/// The state of the plots.
#[derive(Default)]
pub(crate) struct PlotsView {
    /// The content; frozen while the plots are paused.
    shown: Option<Shown>,
}

/// The content of the plots besides the codes.
struct Shown {
    axes: Axes,
    /// The frequencies that sound, in Hz; at rest the setup's.
    pitches: Vec<f64>,
}

/// Most points of the waveform plot.
const POINTS: usize = 900;
/// Periods of the plate's slowest tone that the waveform shows.
const TURNS: f64 = 4.0;
/// Fewest codes that the waveform shows.
const LEAST_CODES: f64 = 64.0;
/// The spectrum is drawn up to this multiple of the plate's highest tone.
const HARMONICS: f64 = 3.0;
/// The spectrum is drawn down to here, in dB of full scale.
const FLOOR_DB: f64 = -120.0;

/// The ranges of the plots. They depend on the plate, not on the tone, so that they do not change while a boundary
/// is dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axes {
    /// Duration of the waveform, in seconds.
    span_s: f64,
    /// The end of the spectrum, in Hz.
    top_hz: f64,
}

impl Axes {
    fn of(scene: &Scene<'_>) -> Self {
        let (low_hz, high_hz) = scene.setup.plate.band_hz();
        let rate_hz = scene.waveform.window().map_or(f64::INFINITY, |window| window.sample_rate_hz);
        Self {
            span_s: (TURNS / low_hz).max(LEAST_CODES / rate_hz),
            top_hz: (HARMONICS * high_hz).min(0.5 * rate_hz),
        }
    }
}

/// The present content. Paused plots keep theirs.
fn look<'a>(scene: &Scene<'_>, view: &'a mut PlotsView) -> &'a Shown {
    let now = || {
        let steady = scene.sounding.unwrap_or(scene.predicted);
        let pitches = steady.tones.iter().map(|wave| wave.tone.frequency_hz).collect();
        Shown { axes: Axes::of(scene), pitches }
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

fn head(ui: &mut egui::Ui, scene: &Scene<'_>, name: &str, intents: &mut Intents) -> bool {
    aligned::headed(ui, name, |ui| {
        pause(ui, scene, name, intents);
        let fit = ui.small_button("Fit");
        fit.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Fit {name}")));
        fit.on_hover_text("Show all again (or double-click). Scroll with Ctrl to zoom, drag to move")
            .clicked()
    })
}

/// The button that holds all plots and the wave; `name` is the plot's that it belongs to.
pub(super) fn pause(ui: &mut egui::Ui, scene: &Scene<'_>, name: &str, intents: &mut Intents) {
    let word = if scene.settings.animate { "Pause" } else { "Go on" };
    let pause = ui.small_button(word);
    pause.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{word}: {name}")));
    if pause.on_hover_text("Hold the plots and the wave (P)").clicked() {
        intents.push(Intent::Animate(!scene.settings.animate));
    }
}

/// The text in place of an empty plot of the drive.
fn nothing(ui: &mut egui::Ui, scene: &Scene<'_>) {
    let is_lost = scene.sounding.is_some() && !scene.waveform.is_true();
    empty(ui, if is_lost { "not followed: stop and drive again" } else { AT_REST });
}

/// What an empty plot says while nothing sounds.
pub(super) const AT_REST: &str = "nothing is driven";

/// An empty plot, and why it is empty.
pub(super) fn empty(ui: &mut egui::Ui, text: &str) {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(ui.available_size(), egui::Sense::hover());
    ui.painter().rect_filled(rect, 4.0, palette.well);
    let font = egui::FontId::proportional(12.5);
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, text, font, palette.weak);
}

/// The least distance of labels, in points: of the x axis, of the y axis.
const SPACING: (f64, f64) = (56.0, 26.0);
/// Space that a label of the x axis needs right of its tick mark, in points.
const HALF_LABEL: f64 = 16.0;

/// A plot from 0 to `end` in this unit. Each `end` has its own zoom memory, because a zoom makes no sense on other
/// axes.
fn plot<'a>(name: &str, end: f64, unit: &'static str, y: (f64, f64), palette: &theme::Palette) -> Plot<'a> {
    let font = FontId::proportional(11.5);
    let x_axis = AxisHints::new_x()
        .label_spacing(Rangef::new(8.0, 9.0))
        .tick_label_color(palette.weak)
        .tick_label_font(font.clone())
        .formatter(move |mark, range| x_label(mark, range, unit));
    let y_axis = AxisHints::new_y()
        .label_spacing(Rangef::new(8.0, 9.0))
        .tick_label_color(palette.weak)
        .tick_label_font(font)
        .min_thickness(34.0)
        .formatter(|mark, _| ticks::label(mark.value, mark.step_size));
    Plot::new(name)
        .id(Id::unique((name, end.to_bits())))
        .default_x_bounds(0.0, end)
        .default_y_bounds(y.0, y.1)
        .custom_x_axes(vec![x_axis])
        .custom_y_axes(vec![y_axis])
        .x_grid_spacer(|input| marks(&input, SPACING.0, HALF_LABEL))
        .y_grid_spacer(|input| marks(&input, SPACING.1, 0.0))
        .grid_color(palette.grid)
        .grid_fade(0.0)
        .grid_spacing(Rangef::new(GRID, 120.0))
        .cursor_color(palette.weak)
        .show_background(true)
        .allow_double_click_reset(true)
        .show_grid(true)
}

/// The least distance of grid lines, in points.
const GRID: f32 = 8.0;

/// Round values along an axis for labels, at least two. The last `end` points get none.
fn marks(input: &GridInput, spacing: f64, end: f64) -> Vec<GridMark> {
    let per_point = input.base_step_size / f64::from(GRID);
    let (low, high) = input.bounds;
    let ticks = Ticks::between(low, high - end * per_point, spacing * per_point);
    ticks.places.iter().map(|&value| GridMark { value, step_size: ticks.step }).collect()
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

pub(super) fn waveform(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let is_reset = head(ui, scene, "Drive waveform", intents);
    let Shown { axes, .. } = look(scene, &mut view.plots);
    let Some(window) = scene.waveform.window().filter(|_| is_shown(scene)) else { return nothing(ui, scene) };
    let palette = theme::palette(ui);
    let wanted = (axes.span_s * window.sample_rate_hz).ceil() as usize;
    let shown = wanted.min(window.codes.len());
    // Begin at a rising zero crossing, as an oscilloscope does, so that the plot stands still.
    let latest = window.codes.len() - shown;
    let trigger = (latest.saturating_sub(shown / 2)..latest)
        .rev()
        .find(|&i| i > 0 && window.codes[i - 1] < 2048 && window.codes[i] >= 2048)
        .unwrap_or(latest);
    let codes = &window.codes[trigger..trigger + shown];
    let (unit, scale) = if axes.span_s < 2e-3 { ("µs", 1e6) } else { ("ms", 1e3) };
    let step = codes.len().div_ceil(POINTS).max(1);
    let points: Vec<[f64; 2]> = codes
        .iter()
        .step_by(step)
        .enumerate()
        .map(|(i, &code)| {
            [(i * step) as f64 / window.sample_rate_hz * scale, (f64::from(code) - 2048.0) / 2048.0]
        })
        .collect();
    let accent = palette.accent;
    let plot = plot("waveform", axes.span_s * scale, unit, (-1.15, 1.15), palette);
    let plot = if is_reset { plot.reset() } else { plot };
    plot.show(ui, |plot| {
        plot.line(Line::new("code, of full scale", PlotPoints::from(points)).color(accent).width(1.4));
    });
}

pub(super) fn spectrum(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let is_reset = head(ui, scene, "Spectrum", intents);
    let lines = scene.waveform.spectrum();
    let Shown { axes, pitches } = look(scene, &mut view.plots);
    if lines.is_empty() || !is_shown(scene) {
        return nothing(ui, scene);
    }
    let palette = theme::palette(ui);
    let (unit, scale) = if axes.top_hz >= 5000.0 { ("kHz", 1e-3) } else { ("Hz", 1.0) };
    let points: Vec<[f64; 2]> = lines
        .iter()
        .take_while(|line| line.frequency_hz <= axes.top_hz)
        .map(|line| [line.frequency_hz * scale, line.level_db.max(FLOOR_DB)])
        .collect();
    let (accent, weak) = (palette.accent, palette.weak);
    let plot = plot("spectrum", axes.top_hz * scale, unit, (FLOOR_DB, 7.0), palette);
    let plot = if is_reset { plot.reset() } else { plot };
    plot.show(ui, |plot| {
        for &hertz in pitches.iter() {
            let line = VLine::new(show_frequency(hertz), hertz * scale);
            plot.vline(line.color(weak.gamma_multiply(0.5)).width(1.0));
        }
        plot.line(Line::new("dB of full scale", PlotPoints::from(points)).color(accent).width(1.2));
    });
}
