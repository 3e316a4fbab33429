//! The row at the bottom: waveform, spectrum, meters, log.

use super::intent::Intents;
use super::{Scene, ViewState, log, meters, plots};
use eframe::egui::{self, Rect, UiBuilder, pos2};

/// Height of the row, in points.
pub(super) const HEIGHT: f32 = 216.0;

pub(super) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let area = ui.available_rect_before_wrap();
    // Shares of the width; the gaps between them hold a line each.
    let shares = [0.28, 0.28, 0.18, 0.26];
    let gap = 21.0;
    let free = area.width() - gap * (shares.len() - 1) as f32;
    let mut left = area.left();
    for (i, share) in shares.into_iter().enumerate() {
        let rect =
            Rect::from_min_max(pos2(left, area.top()), pos2((left + share * free).floor(), area.bottom()));
        ui.scope_builder(UiBuilder::new().max_rect(rect).id_salt(i), |ui| {
            ui.set_clip_rect(ui.clip_rect().intersect(rect.expand(4.0)));
            match i {
                0 => plots::waveform(ui, scene, view, intents),
                1 => plots::spectrum(ui, scene, view, intents),
                2 => meters::show(ui, scene),
                _ => log::show(ui, scene, view, intents),
            }
        });
        left = rect.right() + gap;
        if i + 1 < shares.len() {
            let x = (rect.right() + 0.5 * gap).round() + 0.5;
            let stroke = ui.visuals().widgets.noninteractive.bg_stroke;
            ui.painter().vline(x, area.y_range(), stroke);
        }
    }
    ui.allocate_rect(area, egui::Sense::hover());
}
