//! Which parts beside the stage there is room for. In a small window the panel and the row of plots take turns, so that
//! the plate keeps a size at which it can be watched and touched.

use crate::intent::{Intent, Intents};
use crate::settings::{Part, Settings};
use eframe::egui::{self, Vec2, vec2};

/// The least window for panel and plots at once, in points: the stage between them then has 440 x 270 points.
const BOTH: Vec2 = vec2(760.0, 480.0);
/// Height of the row of buttons that open one or the other, in points.
const SWITCH: f32 = 34.0;

/// The parts that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Room {
    pub(super) panel: bool,
    pub(super) plots: bool,
    /// Whether there is room for one of the two only.
    pub(super) takes_turns: bool,
}

impl Room {
    /// The parts for a window of this size in points. Messages stand in the panel, so one opens it.
    pub(super) fn of(size: Vec2, settings: &Settings, has_message: bool) -> Self {
        let takes_turns = size.x < BOTH.x || size.y < BOTH.y;
        let (panel, plots) = (settings.show_panel || has_message, settings.show_plots);
        let are_both = panel && plots && takes_turns;
        let plots_win = settings.in_front == Part::Plots && !has_message;
        Self {
            panel: panel && !(are_both && plots_win),
            plots: plots && (!are_both || plots_win),
            takes_turns,
        }
    }

    /// The buttons that open the panel or the plots, where there is no room for both.
    pub(super) fn switch(self, ui: &mut egui::Ui, frame: egui::Frame, intents: &mut Intents) {
        if !self.takes_turns {
            return;
        }
        let bar = egui::Panel::bottom("parts").frame(frame.inner_margin(egui::Margin::symmetric(14, 4)));
        bar.exact_size(SWITCH).resizable(false).show(ui, |ui| {
            ui.horizontal_centered(|ui| {
                let parts = [
                    (self.panel, "Panel", Intent::ShowPanel as fn(bool) -> Intent),
                    (self.plots, "Plots", Intent::ShowPlots),
                ];
                for (is_shown, name, intent) in parts {
                    let button = ui.selectable_label(is_shown, name);
                    if button.on_hover_text("This window has room for one of them (Ctrl+0: none)").clicked() {
                        intents.push(intent(!is_shown));
                    }
                }
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_window_shows_the_part_that_was_opened_last_and_a_message_before_all() {
        let shown = |size: [f32; 2], settings: &Settings, has_message| {
            let room = Room::of(Vec2::from(size), settings, has_message);
            (room.panel, room.plots)
        };
        let (small, low, usual) = ([640.0, 480.0], [1280.0, 400.0], [1280.0, 800.0]);
        let plots = Settings { in_front: Part::Plots, ..Settings::default() };
        let alone = Settings { show_panel: false, ..Settings::default() };
        for size in [small, low] {
            assert_eq!(shown(size, &Settings::default(), false), (true, false));
            assert_eq!(shown(size, &plots, false), (false, true));
            assert_eq!(shown(size, &plots, true), (true, false));
            assert_eq!(shown(size, &alone, false), (false, true));
        }
        for settings in [&Settings::default(), &plots] {
            assert_eq!(shown(usual, settings, false), (true, true));
        }
    }
}
