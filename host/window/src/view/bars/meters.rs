//! The meters: level, headroom, thermal load and quality of the link.

use crate::scene::Scene;
use crate::view::fields::field::{UNKNOWN, row};
use crate::view::theme;
use eframe::egui::{self, Color32, CornerRadius, Rect, RichText, Sense, vec2};
use slipline_instrument::concern::is_real;
use slipline_plate::quantity::ticks;
use theme::Palette;

/// Shows them, under a heading unless a tab has their name.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, has_heading: bool) {
    let palette = theme::palette(ui);
    ui.spacing_mut().item_spacing.y = 1.0;
    if has_heading {
        // As high as the neighbouring headings, which have buttons.
        ui.horizontal(|ui| theme::heading(ui, "Output"));
    }
    let warn_from = |limit: f32, value: f32| if value >= limit { palette.warn } else { palette.accent };
    // Without a device the values are unknown.
    let status = scene.snapshot.drive.status;
    let meter = |ui: &mut egui::Ui, name: &str, known: Option<Meter>, help: &str| {
        meter(ui, name, known.unwrap_or_else(|| Meter::unknown(palette)), help);
    };
    let sum = status.map(|status| f32::from(status.sum_per_mille) / 1000.0);
    // Beyond it the DAC's output flattens the peaks.
    let linear = scene.snapshot.linear_share() as f32;
    let level = sum.map(|sum| {
        let text = if sum > 0.0 { decibel(20.0 * sum.log10()) } else { "silent".to_owned() };
        Meter { share: sum, text, colour: warn_from(0.95 * linear, sum) }
    });
    meter(ui, "Level", level, "The device's sum of tones, against full scale");
    let room = sum.map(|sum| {
        // A device that is linear up to full scale cannot be beyond it, but for a rounding.
        let is_beyond = linear < 1.0 && sum > linear;
        let used = if is_beyond { sum / linear } else { (sum / linear).min(1.0) };
        let text = if sum > 0.0 { decibel(-20.0 * used.log10()) } else { "all".to_owned() };
        Meter { share: 1.0 - used, text, colour: if is_beyond { palette.warn } else { palette.good } }
    });
    meter(ui, "Headroom", room, "What is left before the DAC's output would no longer be linear");
    let load = status.map(|status| {
        let heat = f32::from(status.heat_per_mille) / 1000.0;
        let held = f32::from(status.foldback_per_mille) / 10.0;
        // Before its first block a device has not reported its thermal limit.
        let is_held = status.now > 0 && status.foldback_per_mille < 1000;
        let held = if is_held { format!(", held to {held:.0} %") } else { String::new() };
        // A simulated coil is not warm.
        let warns = if is_real(scene.snapshot) { 0.8 } else { f32::INFINITY };
        Meter { share: heat, text: format!("{:.0} %{held}", heat * 100.0), colour: warn_from(warns, heat) }
    });
    meter(ui, "Thermal load", load, "The coil's computed warming, against its limit");
    ui.add_space(1.0);
    let counters = status.map(|status| status.counters);
    let here = scene.snapshot.link.decoder.damaged;
    let counts = [
        (
            "Clipped samples",
            counters.map(|counters| counters.clips),
            "Samples that did not fit the DAC since the device started: lower the levels",
        ),
        (
            "Underruns",
            counters.map(|counters| counters.underruns),
            "Times the DAC ran out of samples since the device started",
        ),
        (
            "Retries",
            status.map(|_| scene.snapshot.link.counters.retries),
            "Commands that were sent again because no answer came: a bad cable or a busy port",
        ),
        (
            "CRC errors",
            counters.map(|counters| counters.crc_errors.saturating_add(here)),
            "Messages that arrived damaged, here or at the device; they were not acted on",
        ),
    ];
    if counts.iter().all(|(_, value, _)| *value == Some(0)) {
        let help = "No clipped samples, underruns, retries or CRC errors since the device started";
        row(ui, "Errors", "none").on_hover_text(help);
        return;
    }
    // Past events, or unknown values.
    for (name, value, help) in counts.into_iter().filter(|(_, value, _)| *value != Some(0)) {
        count(ui, name, value, help);
    }
}

/// A level in dB; never `-0.0`.
pub(crate) fn decibel(value: f32) -> String {
    format!("{} dB", ticks::label(f64::from(value), 0.1))
}

fn count(ui: &mut egui::Ui, name: &str, value: Option<u32>, help: &str) {
    let palette = theme::palette(ui);
    let colour = if value.unwrap_or(0) > 0 { palette.warn } else { palette.text };
    let value = value.map_or(UNKNOWN.to_owned(), |value| value.to_string());
    row(ui, name, RichText::new(value).color(colour)).on_hover_text(help);
}

/// The content of a meter.
struct Meter {
    share: f32,
    text: String,
    colour: Color32,
}

impl Meter {
    fn unknown(palette: &Palette) -> Self {
        Self { share: 0.0, text: UNKNOWN.to_owned(), colour: palette.line }
    }
}

fn meter(ui: &mut egui::Ui, name: &str, meter: Meter, help: &str) {
    let palette = theme::palette(ui);
    let Meter { share, text, colour } = meter;
    row(ui, name, text.as_str());
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 5.0), Sense::hover());
    let radius = CornerRadius::same(3);
    ui.painter().rect_filled(rect, radius, palette.line);
    let filled = Rect::from_min_size(rect.min, vec2(rect.width() * share.clamp(0.0, 1.0), rect.height()));
    ui.painter().rect_filled(filled, radius, colour);
    let name = format!("{name}: {text}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, &name));
    response.on_hover_text(help);
}

#[cfg(test)]
mod tests {
    use super::decibel;

    #[test]
    fn a_level_of_zero_has_no_sign() {
        assert_eq!([decibel(-0.0), decibel(-0.04), decibel(-0.06)], ["0.0 dB", "0.0 dB", "-0.1 dB"]);
    }
}
