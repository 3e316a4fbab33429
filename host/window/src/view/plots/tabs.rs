//! The tabs of the lower row, which shows one plot at a time, and the controls of the chosen plot at the right end of their row.

use crate::view::kept::{LowerPlot, PlotsView};
use crate::view::stage::aligned;
use eframe::egui;

pub(super) const WAVEFORM: &str = "Drive waveform";
pub(super) const WAVEFORM_HELP: &str =
    "What the DAC sends over time, in shares of its full scale, from the codes that the device makes";
pub(super) const SPECTRUM: &str = "Spectrum";
pub(super) const SPECTRUM_HELP: &str =
    "Levels of the drive over frequency, in dB of full scale; a peak for each tone";
pub(super) const FINGER: &str = "Finger trace";
pub(super) const FINGER_HELP: &str =
    "What the finger meets. A finger's impedance, and what it feels, are illustrative";

/// A row narrower than this, in points, has short tabs, and no Fit beside the menu of its plot.
const WIDE: f32 = 530.0;
/// Space in and between the tabs of such a row, in points.
const NARROW: f32 = 4.0;

/// What is shown, its name, its name in a narrow row, and its explanation.
const TABS: [(LowerPlot, &str, &str, &str); 4] = [
    (LowerPlot::Waveform, WAVEFORM, "Wave", WAVEFORM_HELP),
    (LowerPlot::Spectrum, SPECTRUM, SPECTRUM, SPECTRUM_HELP),
    (LowerPlot::Finger, FINGER, "Finger", FINGER_HELP),
    (LowerPlot::Meters, "Output", "Output", "Level, headroom, thermal load and errors of the device"),
];

/// Whether the row has room for whole names.
pub(super) fn is_wide(ui: &egui::Ui) -> bool {
    ui.available_width() >= WIDE
}

/// The tabs.
pub(crate) fn tabs(ui: &mut egui::Ui, plots: &mut PlotsView) {
    let is_wide = is_wide(ui);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = NARROW;
        if !is_wide {
            ui.spacing_mut().button_padding.x = NARROW;
        }
        for (plot, name, short, help) in TABS {
            if plot == LowerPlot::Meters && !plots.has_meters_tab {
                continue;
            }
            let is_chosen = plots.open == plot;
            let tab = ui.selectable_label(is_chosen, if is_wide { name } else { short });
            tab.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_chosen, name));
            if tab.on_hover_text(help).clicked() {
                plots.chosen = Some(plot);
            }
        }
    });
}

/// The tabs, and the controls of the plot of this name.
pub(super) fn headed<R>(
    ui: &mut egui::Ui,
    plots: &mut PlotsView,
    name: &str,
    controls: impl FnOnce(&mut egui::Ui, &mut PlotsView) -> R,
) -> R {
    let row = |ui: &mut egui::Ui| {
        let is_wide = is_wide(ui);
        tabs(ui, plots);
        if !is_wide {
            ui.spacing_mut().item_spacing.x = NARROW;
        }
        aligned::at_right(ui, |ui| controls(ui, plots))
    };
    ui.push_id(name, |ui| ui.horizontal(row).inner).inner
}
