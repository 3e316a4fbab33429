//! The row at the bottom: one plot, chosen by its tab, and the meters beside it. The log lies over all of the row while it is
//! open, so that it moves nothing.

use crate::intent::Intents;
use crate::scene::Scene;
use crate::view::bars::{log, meters};
use crate::view::kept::LowerPlot;
use crate::view::plots::{self, finger_trace, tabs::tabs};
use crate::view::state::ViewState;
use crate::view::theme;
use eframe::egui::{self, Rect, ScrollArea, UiBuilder, pos2};

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
const METERS_HEIGHT: f32 = 170.0;
/// Width of the meters beside a plot, and of the gap, in whose middle a separator line stands, in points.
const METERS: f32 = 176.0;
const GAP: f32 = 21.0;
/// In a row narrower than this, in points, the meters have a tab in place of a column.
const ROOM_FOR_METERS: f32 = 560.0;

pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState, intents: &mut Intents) {
    let area = ui.available_rect_before_wrap();
    if view.log.is_open {
        part(ui, area, "log", |ui| log::show(ui, scene, &mut view.log, intents));
    } else {
        let has_column = area.width() >= ROOM_FOR_METERS;
        let mut plot = area;
        if has_column {
            plot.max.x -= METERS + GAP;
            let beside = Rect::from_min_max(pos2(plot.right() + GAP, area.top()), area.max);
            part(ui, beside, "meters", |ui| scrolled_meters(ui, scene, true));
            let x = (plot.right() + 0.5 * GAP).round() + 0.5;
            let stroke = ui.visuals().widgets.noninteractive.bg_stroke;
            ui.painter().vline(x, area.y_range(), stroke);
        }
        part(ui, plot, "plot", |ui| chosen(ui, scene, view, has_column, intents));
    }
    ui.allocate_rect(area, egui::Sense::hover());
}

/// A part of the row. A separate child `Ui`: a part that needs more space than it has must not move its neighbours.
fn part(ui: &mut egui::Ui, rect: Rect, name: &str, show: impl FnOnce(&mut egui::Ui)) {
    let mut part = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(name));
    part.shrink_clip_rect(rect.expand(4.0));
    show(&mut part);
}

/// The plot of the chosen tab.
fn chosen(
    ui: &mut egui::Ui,
    scene: &Scene<'_>,
    view: &mut ViewState,
    has_column: bool,
    intents: &mut Intents,
) {
    let plots = &mut view.plots;
    match plots.open(scene.finger.is_some(), !has_column) {
        LowerPlot::Spectrum => plots::spectrum(ui, scene, plots, intents),
        LowerPlot::Finger => finger_trace::show(ui, scene, plots, intents),
        LowerPlot::Meters => {
            ui.horizontal(|ui| tabs(ui, plots));
            scrolled_meters(ui, scene, false);
        }
        LowerPlot::Waveform => plots::waveform(ui, scene, plots, intents),
    }
}

/// The meters; in a low row the last ones are reached by scrolling.
fn scrolled_meters(ui: &mut egui::Ui, scene: &Scene<'_>, has_heading: bool) {
    let is_low = ui.available_height() < METERS_HEIGHT;
    ScrollArea::vertical().id_salt("meters").auto_shrink([false, false]).show(ui, |ui| {
        if is_low {
            theme::clear_of_bar(ui);
        }
        meters::show(ui, scene, has_heading);
    });
}
