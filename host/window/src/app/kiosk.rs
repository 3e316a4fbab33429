//! The stage alone: neither menus nor pages, STOP and state as everywhere. In the window for visitors scenes come in turn, each
//! with the demonstration until somebody comes; in a frame of another page, such as a paper's, the plate stays.
//!
//! A real plate is one plate, so with a real device the setup stays.

use super::demonstration::{Demonstration, has_input};
use super::{App, Lead};
use crate::view::Tab;
use eframe::egui;
use slipline_link::protocol::event::State;
use slipline_model::scenes::SCENES;
use slipline_model::setup::edit::Edit;

/// Time without input after which the next scene comes, in seconds.
const REST_S: f64 = 45.0;

/// The turn of the scenes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Kiosk {
    scene: usize,
    /// The time of the latest input, or of the scene's beginning.
    since_s: Option<f64>,
    /// What attracts visitors, again and again until one comes.
    pub(super) shows: Option<Demonstration>,
}

impl App {
    /// Shows the window to visitors.
    pub fn open_to_visitors(&mut self) {
        self.lead = Lead::Scenes(Kiosk::default());
        self.start_scene(0);
    }

    /// The turn of the scenes, while visitors see the window.
    pub(super) fn kiosk(&self) -> Option<Kiosk> {
        match self.lead {
            Lead::Scenes(kiosk) => Some(kiosk),
            Lead::User | Lead::Demonstration(_) | Lead::Frame => None,
        }
    }

    /// Shows plate and line alone, in a frame of another page.
    pub fn open_in_frame(&mut self) {
        self.lead = Lead::Frame;
    }

    /// Whether there are neither menus nor pages.
    pub(super) const fn is_stage_alone(&self) -> bool {
        matches!(self.lead, Lead::Scenes(_) | Lead::Frame)
    }

    /// What stands in place of the menus, where there are none: name and effect of the scene, or name and description of the
    /// plate.
    pub(super) fn stage_alone(&self) -> Option<(&str, &str)> {
        if !self.is_stage_alone() {
            return None;
        }
        let plate = &self.setup().plate;
        let scene = self.kiosk().and_then(|kiosk| SCENES.get(kiosk.scene));
        let of_plate = (plate.name(), plate.spec().description.as_str());
        Some(scene.map_or(of_plate, |scene| (scene.name, scene.description)))
    }

    /// Keeps to the stage, where it is alone.
    pub(super) fn keep_to_stage(&mut self) {
        if self.is_stage_alone() {
            self.dialog = None;
            (self.settings.show_panel, self.settings.show_plots) = (false, false);
            // The page that needs no room beside the stage.
            self.view.tab = Tab::Boundary;
        }
    }

    /// Begins the next scene for visitors when nobody has touched anything for a while.
    pub(super) fn turn_scenes(&mut self, ctx: &egui::Context) {
        let Some(kiosk) = self.kiosk() else { return };
        let (now_s, has_input) = ctx.input(|input| (input.time, has_input(input)));
        let since_s = kiosk.since_s.filter(|_| !has_input).unwrap_or(now_s);
        let shows = self.attract(ctx, kiosk.shows, has_input);
        self.lead = Lead::Scenes(Kiosk { since_s: Some(since_s), shows, ..kiosk });
        let left_s = since_s + REST_S - now_s;
        if left_s > 0.0 {
            return ctx.request_repaint_after(std::time::Duration::from_secs_f64(left_s));
        }
        let next = (kiosk.scene + 1) % SCENES.len();
        if let Some(under_way) = shows {
            self.put_back(under_way);
        }
        self.lead = Lead::Scenes(Kiosk { scene: next, since_s: Some(now_s), shows: None });
        if self.instrument.drive.snapshot().is_simulated() {
            self.start_scene(next);
            // The visitor who stopped the simulated plate has gone.
            let state = self.instrument.drive.snapshot().drive.status.map(|status| status.state);
            if matches!(state, Some(State::Armed | State::Idle)) {
                self.instrument.start();
            }
        }
    }

    /// Goes on with the demonstration that attracts visitors, begins it again at its end, and puts everything back when one comes.
    fn attract(
        &mut self,
        ctx: &egui::Context,
        shows: Option<Demonstration>,
        has_input: bool,
    ) -> Option<Demonstration> {
        let under_way = shows?;
        let next = if has_input { None } else { self.demonstrated(ctx, under_way) };
        if next.is_none() {
            self.put_back(under_way);
        }
        let goes_on = !has_input && self.instrument.screen.sounding().is_some();
        next.or_else(|| if goes_on { self.demonstration() } else { None })
    }

    /// Begins the scene of this number; in the first one, and for visitors in each, a finger lies on the plate.
    pub(super) fn start_scene(&mut self, number: usize) {
        if let Some(setup) = SCENES.get(number).and_then(slipline_model::scenes::Scene::setup) {
            self.instrument.edit(&Edit::New(Box::new(setup)));
            if number == 0 || self.kiosk().is_some() {
                self.rest_finger();
            }
            // A real plate is moved by nobody but its visitors.
            let snapshot = self.instrument.drive.snapshot();
            let shows = self.demonstration().filter(|_| snapshot.is_simulated() || !snapshot.is_connected());
            if let Lead::Scenes(kiosk) = &mut self.lead {
                kiosk.shows = shows;
            }
        }
    }
}
