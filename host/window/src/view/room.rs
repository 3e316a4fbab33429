//! Which parts beside the stage there is room for. In a small window the panel and the row of plots take turns, so that
//! the plate keeps a size at which it can be watched and touched.

use crate::intent::{Asks as _, Intent, Intents};
use crate::settings::{Part, Settings};
use eframe::egui::{self, Vec2, vec2};

/// The least window for panel and plots at once, in points: the stage between them then has 440 x 270 points.
const BOTH: Vec2 = vec2(760.0, 480.0);
/// The share of an upright window's height that its panel has, below the stage.
const PANEL_BELOW: f32 = 0.45;

/// The least window whose calibration stands beside the stage and not over it, in points, and the width that it has there.
const LEAST_BESIDE: Vec2 = vec2(1000.0, 480.0);
pub(super) const BESIDE: f32 = 492.0;

/// Whether a window of this size in points has room for the calibration beside the stage, so that the plate stays in sight
/// while it is measured.
pub(super) fn has_room_beside(size: Vec2) -> bool {
    size.x >= LEAST_BESIDE.x && size.y >= LEAST_BESIDE.y
}

/// The parts that are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Room {
    pub(super) panel: bool,
    /// The lower row, with a plot or the log.
    pub(super) plots: bool,
    /// Whether there is room for one of the two only.
    pub(super) takes_turns: bool,
    /// The height of a panel below the stage, in points: in an upright window, such as on a telephone. `None` for a panel
    /// at its side.
    pub(super) below: Option<f32>,
}

impl Room {
    /// The parts for a window of this size in points; an open log takes the lower row.
    pub(super) fn of(size: Vec2, settings: &Settings, has_log: bool) -> Self {
        let takes_turns = size.x < BOTH.x || size.y < BOTH.y;
        let (panel, plots) = (settings.show_panel, settings.show_plots || has_log);
        let are_both = panel && plots && takes_turns;
        let plots_win = has_log || settings.in_front == Part::Plots;
        Self {
            panel: panel && !(are_both && plots_win),
            plots: plots && (!are_both || plots_win),
            takes_turns,
            below: (size.x < BOTH.x && size.y > size.x).then_some(PANEL_BELOW * size.y),
        }
    }

    /// The buttons that open the panel or the plots, where there is no room for both.
    pub(super) fn switch(self, ui: &mut egui::Ui, has_log: bool, intents: &mut Intents) {
        if !self.takes_turns {
            return;
        }
        let parts = [
            (self.panel, "Panel", Intent::ShowPanel as fn(bool) -> Intent),
            (self.plots && !has_log, "Plots", Intent::ShowPlots),
        ];
        for (is_shown, name, intent) in parts {
            let button = ui.selectable_label(is_shown, name);
            button
                .on_hover_text("This window has room for one of them (Ctrl+0: none)")
                .asks(intents, intent(!is_shown));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_window_shows_the_part_that_was_opened_last() {
        let shown = |size: [f32; 2], settings: &Settings| {
            let room = Room::of(Vec2::from(size), settings, false);
            (room.panel, room.plots)
        };
        let (small, low, usual) = ([640.0, 480.0], [1280.0, 400.0], [1280.0, 800.0]);
        let plots = Settings { in_front: Part::Plots, ..Settings::default() };
        let alone = Settings { show_panel: false, ..Settings::default() };
        for size in [small, low] {
            assert_eq!(shown(size, &Settings::default()), (true, false));
            assert_eq!(shown(size, &plots), (false, true));
            assert_eq!(shown(size, &alone), (false, true));
            let room = Room::of(Vec2::from(size), &Settings::default(), true);
            assert_eq!((room.panel, room.plots), (false, true), "the log has the room");
        }
        for settings in [&Settings::default(), &plots] {
            assert_eq!(shown(usual, settings), (true, true));
        }
    }

    #[test]
    fn an_upright_window_has_its_panel_below_the_stage() {
        let below = |size: [f32; 2]| Room::of(Vec2::from(size), &Settings::default(), false).below;
        assert_eq!(below([390.0, 844.0]), Some(PANEL_BELOW * 844.0));
        for size in [[640.0, 480.0], [844.0, 390.0], [800.0, 1200.0]] {
            assert_eq!(below(size), None, "{size:?}");
        }
    }
}
