//! The drive in time and frequency, from the mirror.

use super::intent::{Intent, Intents};
use super::{Scene, ViewState, theme};
use crate::quantity::show_frequency;
use eframe::egui::{self, vec2};
use egui_plot::{Line, Plot, PlotPoints, VLine};

/// Whether the plots follow the signal or stay where the user has zoomed to.
#[derive(Default)]
pub(crate) struct PlotsView {
    reset_waveform: bool,
    reset_spectrum: bool,
}

/// Points of the waveform, at most.
const POINTS: usize = 900;
/// Turns of the slowest tone that the waveform shows.
const TURNS: f64 = 4.0;

/// The spectrum is drawn up to this multiple of the highest tone.
const HARMONICS: f64 = 3.0;
/// The spectrum is drawn down to here, in dB of full scale.
const FLOOR_DB: f64 = -120.0;

/// The frequencies that sound, in Hz; the setup's while nothing does.
fn pitches(scene: &Scene<'_>) -> Vec<f64> {
    let picture = scene.sounding.unwrap_or(scene.predicted);
    picture.tones.iter().map(|wave| wave.tone.frequency_hz).collect()
}

/// Whether the plots show anything: something sounds, or they are held.
fn is_shown(scene: &Scene<'_>) -> bool {
    scene.live.is_true() && (scene.sounding.is_some() || !scene.settings.animate)
}

fn head(ui: &mut egui::Ui, scene: &Scene<'_>, name: &str, intents: &mut Intents) -> bool {
    let mut is_reset = false;
    ui.horizontal(|ui| {
        theme::heading(ui, name);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let fit = ui.small_button("Fit");
            fit.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Fit {name}")));
            is_reset = fit
                .on_hover_text("Show all again (or double-click). Scroll with Ctrl to zoom, drag to move")
                .clicked();
            let word = if scene.settings.animate { "Pause" } else { "Go on" };
            let pause = ui.small_button(word);
            pause.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{word}: {name}"))
            });
            if pause.on_hover_text("Hold the plots and the wave (P)").clicked() {
                intents.push(Intent::Animate(!scene.settings.animate));
            }
        });
    });
    is_reset
}

/// What stands where there is nothing to draw.
fn nothing(ui: &mut egui::Ui, scene: &Scene<'_>) {
    let is_lost = scene.sounding.is_some() && !scene.live.is_true();
    let text = if is_lost { "not followed: stop and drive again" } else { "nothing is driven" };
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(ui.available_size(), egui::Sense::hover());
    ui.painter().rect_filled(rect, 4.0, palette.well);
    let font = egui::FontId::proportional(12.5);
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, text, font, palette.weak);
}

fn plot<'a>(name: &str, is_reset: bool, palette: &theme::Palette) -> Plot<'a> {
    let plot = Plot::new(name)
        .auto_bounds(true)
        .grid_color(palette.grid)
        .grid_fade(0.0)
        .grid_spacing(egui::Rangef::new(28.0, 120.0))
        .cursor_color(palette.weak)
        .show_background(true)
        .set_margin_fraction(vec2(0.0, 0.06))
        .allow_double_click_reset(true)
        .show_grid(true)
        .y_axis_min_width(34.0);
    if is_reset { plot.reset() } else { plot }
}

pub(super) fn waveform(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    view.plots.reset_waveform = head(ui, scene, "Drive waveform", intents);
    let Some(window) = scene.live.window().filter(|_| is_shown(scene)) else { return nothing(ui, scene) };
    let palette = theme::palette(ui);
    let slowest_hz = pitches(scene).into_iter().fold(f64::INFINITY, f64::min);
    let wanted = (TURNS / slowest_hz * window.sample_rate_hz) as usize;
    let shown = wanted.clamp(256, window.codes.len().max(256)).min(window.codes.len());
    // Begin at a rising zero, as an oscilloscope does, so that the picture stands still.
    let latest = window.codes.len() - shown;
    let trigger = (latest.saturating_sub(shown / 2)..latest)
        .rev()
        .find(|&i| i > 0 && window.codes[i - 1] < 2048 && window.codes[i] >= 2048)
        .unwrap_or(latest);
    let codes = &window.codes[trigger..trigger + shown];
    let (unit, scale) = if shown as f64 / window.sample_rate_hz < 2e-3 { ("µs", 1e6) } else { ("ms", 1e3) };
    let step = codes.len().div_ceil(POINTS).max(1);
    let points: Vec<[f64; 2]> = codes
        .iter()
        .step_by(step)
        .enumerate()
        .map(|(i, &code)| {
            [(i * step) as f64 / window.sample_rate_hz * scale, (f64::from(code) - 2048.0) / 2048.0]
        })
        .collect();
    let end = shown as f64 / window.sample_rate_hz * scale;
    let accent = palette.accent;
    plot("waveform", view.plots.reset_waveform, palette)
        .include_x(end)
        .include_y(-1.0)
        .include_y(1.0)
        .x_axis_formatter(move |mark, range| axis_label(mark.value, range, unit))
        .show(ui, |plot| {
            plot.line(Line::new("code, of full scale", PlotPoints::from(points)).color(accent).width(1.4));
        });
}

/// A mark of the x axis: its unit stands at zero, and what would be cut off at the right end is left out.
fn axis_label(value: f64, range: &std::ops::RangeInclusive<f64>, unit: &str) -> String {
    let span = range.end() - range.start();
    if value > range.end() - 0.05 * span {
        String::new()
    } else if value.abs() < 1e-9 * span {
        format!("0 {unit}")
    } else {
        trim(value)
    }
}

/// A number with as many decimals as it needs, at most three.
fn trim(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

pub(super) fn spectrum(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    view.plots.reset_spectrum = head(ui, scene, "Spectrum", intents);
    let lines = scene.live.spectrum();
    if lines.is_empty() || !is_shown(scene) {
        return nothing(ui, scene);
    }
    let palette = theme::palette(ui);
    let pitches = pitches(scene);
    let highest_hz = pitches.iter().copied().fold(0.0, f64::max).max(1.0);
    let (unit, scale) = if highest_hz >= 2000.0 { ("kHz", 1e-3) } else { ("Hz", 1.0) };
    let points: Vec<[f64; 2]> = lines
        .iter()
        .take_while(|line| line.frequency_hz <= HARMONICS * highest_hz)
        .map(|line| [line.frequency_hz * scale, line.level_db.max(FLOOR_DB)])
        .collect();
    let (accent, weak) = (palette.accent, palette.weak);
    plot("spectrum", view.plots.reset_spectrum, palette)
        .include_y(FLOOR_DB)
        .include_y(0.0)
        .x_axis_formatter(move |mark, range| axis_label(mark.value, range, unit))
        .show(ui, |plot| {
            for hertz in pitches {
                let line = VLine::new(show_frequency(hertz), hertz * scale);
                plot.vline(line.color(weak.gamma_multiply(0.5)).width(1.0));
            }
            plot.line(Line::new("dB of full scale", PlotPoints::from(points)).color(accent).width(1.2));
        });
}
