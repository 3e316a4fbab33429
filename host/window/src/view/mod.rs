//! The views of the window. Every view takes the [`Scene`] and returns the user's requests as intents; no view
//! sends anything or changes the state it shows.
//!
//! ```text
//! bars/top_bar ........................... STOP
//! stage/: plate, envelope, felt strip (one x axis)     panels/side_panel: boundary, tones, texture, plate, device, play
//!    or plots/response: level, phase, residual, Nyquist
//! bars/bottom_row: plots/ (waveform, spectrum or finger trace), meters; or bars/log, bars/tour
//! bars/status_line: messages
//! ```
//! `fields` are the inputs that panels and dialogs share, `dialogs` what stands over the window. `ViewState` holds the
//! views' state between frames, as plain data; a view gets its own part of it (`kept`). `room` decides what fits the
//! window, `theme` has colours and fonts.

mod bars;
mod dialogs;
mod fields;
mod kept;
mod panels;
mod plots;
mod room;
mod stage;
mod state;
pub mod theme;

pub(crate) use kept::Brush;
pub(crate) use stage::arrow_step_m;
pub(crate) use state::{PlatePage, Tab, ViewState};

use crate::intent::{Dialog, Intents};
use crate::scene::Scene;
use bars::{bottom_row, log, status_line, top_bar, tour};
use eframe::egui;
use panels::side_panel;
use plots::response;

/// What is said while a file is held over the window.
const DROP: &str = "Drop to open a setup, plate, measurement, recording or picture";

/// Shows the whole window.
pub(crate) fn show(ui: &mut egui::Ui, scene: &Scene<'_>, view: &mut ViewState) -> Intents {
    let mut intents = Intents::new();
    let frame = egui::Frame::new().inner_margin(theme::MARGIN);
    egui::Panel::top("top")
        .frame(frame)
        .resizable(false)
        .show(ui, |ui| top_bar::show(ui, scene, &mut intents));
    let size = ui.ctx().content_rect().size();
    let room = room::Room::of(size, scene.settings, view.log.is_open);
    let low = frame.inner_margin(egui::Margin::symmetric(14, 0));
    egui::Panel::bottom("status")
        .frame(low)
        .exact_size(status_line::HEIGHT)
        .resizable(false)
        .show(ui, |ui| ui.horizontal_centered(|ui| status(ui, room, scene, view, &mut intents)));
    let is_calibrating = matches!(scene.dialog, Some(Dialog::Calibrate));
    // As high as the window: with the lower row under the stage alone, its first page is whole at 1280 x 720.
    if is_calibrating && room::has_room_beside(size) {
        // The calibration's pages lie here; see `dialogs`.
        egui::Panel::right("calibration").exact_size(room::BESIDE).resizable(false).show(ui, |_| ());
    } else if room.below.is_none() {
        panel(ui, room, scene, view, &mut intents);
    }
    if let Some(shown) = scene.tour {
        // In the place of the plots: what it speaks of is the stage and the panel.
        egui::Panel::bottom("tour")
            .frame(frame)
            .exact_size(tour::HEIGHT)
            .resizable(false)
            .show(ui, |ui| tour::show(ui, shown, &mut intents));
    } else if room.plots {
        egui::Panel::bottom("bottom")
            .frame(frame)
            .exact_size(bottom_row::height(ui))
            .resizable(false)
            .show(ui, |ui| bottom_row::show(ui, scene, view, &mut intents));
    }
    if room.below.is_some() {
        panel(ui, room, scene, view, &mut intents);
    }
    if view.tab != Tab::Texture {
        view.brush = Brush::default();
    }
    egui::CentralPanel::no_frame().frame(frame).show(ui, |ui| {
        // While the plate is measured or calibrated, and before, the plate is looked at.
        let is_measured = scene.measure.live.progress.is_none() && !scene.measure.shelf.entries().is_empty();
        if view.is_measuring() && is_measured && !is_calibrating {
            let page = ui.max_rect() + theme::MARGIN;
            theme::fill_page_around(ui, page, egui::Rect::from_pos(page.center()));
            response::show(ui, scene, &mut view.response);
        } else {
            stage::show(ui, scene, view, &mut intents);
        }
    });
    dialogs::show(ui, scene, view, &mut intents);
    if scene.stage_alone.is_none() && ui.input(|input| !input.raw.hovered_files.is_empty()) {
        drop_hint(ui);
    }
    intents
}

/// Over all of the window, while a file is held over it: what happens where it is dropped.
fn drop_hint(ui: &egui::Ui) {
    let palette = theme::palette(ui);
    let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop hint"));
    let (painter, window) = (ui.ctx().layer_painter(layer), ui.ctx().content_rect());
    painter.rect_filled(window, 0.0, palette.panel.gamma_multiply(0.7));
    let stroke = egui::Stroke::new(2.0, palette.accent);
    painter.rect_stroke(window.shrink(4.0), 6.0, stroke, egui::StrokeKind::Inside);
    let font = egui::FontId::proportional(20.0);
    painter.text(window.center(), egui::Align2::CENTER_CENTER, DROP, font, palette.text);
}

/// The status line between the buttons that open the parts of the window.
fn status(
    ui: &mut egui::Ui,
    room: room::Room,
    scene: &Scene<'_>,
    view: &mut ViewState,
    intents: &mut Intents,
) {
    // Where the stage is alone there is neither panel nor log.
    if scene.stage_alone.is_none() {
        room.switch(ui, view.log.is_open, intents);
        log::switch(ui, &mut view.log);
    }
    status_line::show(ui, scene, &mut view.notices, intents);
}

/// The panel at the side of the stage, or below it.
fn panel(
    ui: &mut egui::Ui,
    room: room::Room,
    scene: &Scene<'_>,
    view: &mut ViewState,
    intents: &mut Intents,
) {
    if !room.panel {
        return;
    }
    let side = match room.below {
        Some(height) => egui::Panel::bottom("below").exact_size(height),
        None => egui::Panel::right("side").exact_size(side_panel::WIDTH),
    };
    let frame = egui::Frame::new().inner_margin(theme::MARGIN);
    side.frame(frame).resizable(false).show(ui, |ui| side_panel::show(ui, scene, view, intents));
}
