//! How loud, how much room is left, how warm, and how good the link is.

use super::{Scene, field::row, theme};
use crate::ticks;
use eframe::egui::{self, Color32, CornerRadius, Rect, RichText, Sense, vec2};

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>) {
    let palette = theme::palette(ui);
    ui.spacing_mut().item_spacing.y = 2.0;
    theme::heading(ui, "Output");
    let status = scene.snapshot.status.unwrap_or_default();
    let sum = f32::from(status.sum_per_mille) / 1000.0;
    let level = if sum > 0.0 { decibel(20.0 * sum.log10()) } else { "silent".to_owned() };
    let warn_from = |limit: f32, value: f32| if value >= limit { palette.warn } else { palette.accent };
    meter(ui, "Level", sum, &level, warn_from(0.95, sum), "The device's sum of tones, against full scale");
    let headroom = if sum > 0.0 { decibel(-20.0 * sum.min(1.0).log10()) } else { "all".to_owned() };
    let room = (1.0 - sum).clamp(0.0, 1.0);
    meter(ui, "Headroom", room, &headroom, palette.good, "What is left before the DAC would clip");
    let heat = f32::from(status.heat_per_mille) / 1000.0;
    let text = format!("{:.0} %", heat * 100.0);
    meter(
        ui,
        "Temperature",
        heat,
        &text,
        warn_from(0.8, heat),
        "The coil's computed warming, against its limit",
    );
    let foldback = if status.state == slipline_protocol::event::State::default() && status.now == 0 {
        1000
    } else {
        status.foldback_per_mille
    };
    ui.add_space(2.0);
    let clips = status.counters.clips;
    count(ui, "Clipped samples", clips);
    count(ui, "Underruns", status.counters.underruns);
    count(ui, "Retries", scene.snapshot.counters.retries);
    let crc = status.counters.crc_errors.saturating_add(scene.snapshot.decoder.damaged);
    count(ui, "CRC errors", crc);
    if foldback < 1000 {
        let text = RichText::new(format!("{:.0} %", f32::from(foldback) / 10.0)).color(palette.warn);
        row(ui, "Held back (heat)", text);
    }
}

/// A level in dB; never `-0.0`.
pub(super) fn decibel(value: f32) -> String {
    format!("{} dB", ticks::label(f64::from(value), 0.1))
}

fn count(ui: &mut egui::Ui, name: &str, value: u32) {
    let palette = theme::palette(ui);
    let colour = if value > 0 { palette.warn } else { palette.text };
    row(ui, name, RichText::new(value.to_string()).color(colour));
}

fn meter(ui: &mut egui::Ui, name: &str, share: f32, text: &str, colour: Color32, help: &str) {
    let palette = theme::palette(ui);
    row(ui, name, text);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 6.0), Sense::hover());
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
    fn a_level_of_nothing_has_no_sign() {
        assert_eq!([decibel(-0.0), decibel(-0.04), decibel(-0.06)], ["0.0 dB", "0.0 dB", "-0.1 dB"]);
    }
}
