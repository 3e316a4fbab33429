//! The row at the bottom: waveform (or the trace of the finger), spectrum, meters, log.

use crate::intent::Intents;
use crate::scene::Scene;
use crate::view::bars::{log, meters};
use crate::view::plots::{self, finger_trace};
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Rect, UiBuilder, pos2};

/// Usual height of the row, and its height in a low window, in points; in the lowest it takes [`LEAST_SHARE`] of it.
const HEIGHT: f32 = 194.0;
const LOW_HEIGHT: f32 = 140.0;
const LEAST_SHARE: f32 = 0.29;
/// In a window lower than this, in points, the row shrinks first, because the plate is more important.
const ROOMY: f32 = 620.0;

/// Height of the row in this window, in points.
pub(crate) fn height(ui: &egui::Ui) -> f32 {
    let window = ui.ctx().content_rect().height();
    let missing = (ROOMY - window).max(0.0);
    (HEIGHT - missing).max(LOW_HEIGHT.min(LEAST_SHARE * window))
}

/// Height of all meters with every counter, in points: in a lower row they may scroll.
const METERS: f32 = 170.0;

/// Shares of the width; each gap between two parts has a separator line.
const SHARES: [f32; 4] = [0.28, 0.28, 0.18, 0.26];
/// The shares in a window wider than [`WIDE`], in points, where meters and log have enough and the plots get the rest.
const WIDE_SHARES: [f32; 4] = [0.335, 0.335, 0.145, 0.185];
const WIDE: f32 = 1200.0;
/// The shares in a window narrower than [`NARROW`], in points, where meters and log need more of it.
const NARROW_SHARES: [f32; 4] = [0.25, 0.24, 0.245, 0.265];
const NARROW: f32 = 760.0;
const GAP: f32 = 21.0;

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let area = ui.available_rect_before_wrap();
    let shares = match area.width() {
        width if width < NARROW => NARROW_SHARES,
        width if width < WIDE => SHARES,
        _ => WIDE_SHARES,
    };
    let free = area.width() - GAP * (SHARES.len() - 1) as f32;
    let mut left = area.left();
    for (i, share) in shares.into_iter().enumerate() {
        let rect =
            Rect::from_min_max(pos2(left, area.top()), pos2((left + share * free).floor(), area.bottom()));
        // A separate child `Ui`: a column that needs more space than it has must not move its neighbours.
        let mut column = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(i));
        column.shrink_clip_rect(rect.expand(4.0));
        match i {
            // The finger does not change the drive, so its trace can stand where the drive did.
            0 if scene.finger.is_some() => finger_trace::show(&mut column, scene, intents),
            0 => plots::waveform(&mut column, scene, &mut view.plots, intents),
            1 => plots::spectrum(&mut column, scene, &mut view.plots, intents),
            2 => {
                // In a low row the last meters are reached by scrolling.
                let area = egui::ScrollArea::vertical().id_salt("meters").auto_shrink([false, false]);
                area.show(&mut column, |ui| {
                    if rect.height() < METERS {
                        theme::clear_of_bar(ui);
                    }
                    meters::show(ui, scene);
                });
            }
            _ => log::show(&mut column, scene, &mut view.log, intents),
        }
        left = rect.right() + GAP;
        if i + 1 < SHARES.len() {
            let x = (rect.right() + 0.5 * GAP).round() + 0.5;
            let stroke = ui.visuals().widgets.noninteractive.bg_stroke;
            ui.painter().vline(x, area.y_range(), stroke);
        }
    }
    ui.allocate_rect(area, egui::Sense::hover());
}
