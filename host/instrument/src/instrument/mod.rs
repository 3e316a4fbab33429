//! The instrument: a plate and a device in use, in four rooms.
//!
//! ```text
//! shell --events--> Instrument --Request--> link
//!   ^                 | ^  <--Snapshot-- link
//!   +-- Shown, Output-+ |
//!                      Jobs (a thread each, or at once)
//!
//! Desk    the setup, undo, comparison, recorder             knows no other room
//! Drive   link, snapshot, autopilot, the plate's table      knows no other room
//! Lab     measurements, hold, calibration, rig              acts on Desk and Drive
//! Screen  prediction, playback, background work, brush      looks at Desk, Drive and Lab
//! ```
//! A room's fields are its own; another room, and the shell, use its named methods. What follows in several rooms from one
//! event is here: [`Instrument::take_reports`] and [`Instrument::turn`] show the order, `edits` what follows from a change of the
//! setup, `actions` what the user does.
//!
//! A shell calls [`Instrument::attend`], [`Instrument::take_reports`] and [`Instrument::turn`] for every frame, passes the
//! user's actions on (to a room, where one is enough), carries out the [`Output`]s and draws what is [`Shown`].

mod actions;
mod before_after;
mod desk;
mod drive;
mod edits;
mod exports;
mod held_lines;
mod lab;
mod outbox;
mod screen;
mod shell;
mod shown;
mod tour;
mod work;

pub use before_after::CalibrationSide;
pub use desk::{Desk, DragRecorder};
pub use drive::{DeviceIntent, Drive, SAFE_MODE, fault_sentence};
pub use lab::{CalibrateIntent, MeasureDraft, MeasureIntent, SoFar};
pub use outbox::{Notice, Outbox};
pub use screen::Screen;
pub use shell::{Attention, Link, Output, Page};
pub use shown::{
    Asked, AskedContent, AskedTable, Awaited, Background, CalibrateScene, DesignState, HoldScene, LiveScene,
    MeasureScene, Progress, SelftestScene, Shown, TextureScene, Waiting,
};
pub use tour::{TourScene, TourStep};
pub use work::Jobs;

use crate::bench::Bench;
use crate::changes::Changes;
use before_after::Calibrated;
use drive::News;
use lab::{Lab, Reach};
use screen::Sight;
use slipline_model::field::line::Line;
use slipline_model::setup::Setup;
use slipline_model::setup::edit::Edit;
use tour::Tour;

/// A plate and a device in use.
pub struct Instrument {
    /// The setup and what changes it.
    pub desk: Desk,
    /// The device, and the drive that it should play.
    pub drive: Drive,
    lab: Lab,
    /// What the views show, and the work for it.
    pub screen: Screen,
    /// Messages and actions for the shell.
    pub out: Outbox,
    attention: Attention,
    calibrated: Calibrated,
    tour: Option<Tour>,
}

impl Instrument {
    /// An instrument with this setup, not connected to a device.
    #[must_use]
    pub fn new(link: Box<dyn Link>, mut jobs: Jobs, bench: Bench, setup: Setup) -> Self {
        Self {
            drive: Drive::new(link, &setup.plate, &mut jobs),
            lab: Lab::new(&setup.plate, bench, &mut jobs),
            screen: Screen::new(&setup.plate, &mut jobs),
            desk: Desk::new(setup),
            attention: Attention::default(),
            out: Outbox::default(),
            calibrated: Calibrated::default(),
            tour: None,
        }
    }

    /// Stores the state of the shell: what it shows, and what the user holds.
    pub fn attend(&mut self, attention: Attention) {
        self.attention = attention;
    }

    /// Handles the reports of link and jobs since the last call.
    pub fn take_reports(&mut self) {
        match self.drive.take_snapshot() {
            News::None => {}
            News::Clock => self.screen.follow_clock(self.drive.snapshot()),
            News::Changes(changes) => {
                let is_awaited = |ticket| self.lab.awaits(ticket);
                self.drive.report(&changes, self.desk.setup(), is_awaited, &mut self.out);
                self.follow_device(&changes);
            }
        }
        if self.drive.take_table() {
            self.screen.keep_edges(Vec::new());
            self.hold_lines();
            self.follow_device(&Changes::default());
        }
        let (lab, mut reach) = self.reach();
        lab.take_results(&mut reach);
        if let Some((gesture, edit)) = self.screen.take_results(self.attention.is_animated) {
            self.follow_drawing(gesture, &edit);
        }
    }

    /// The device or its table has changed: sends what is due, then shows what sounds.
    fn follow_device(&mut self, changes: &Changes) {
        self.drive.run_autopilot(changes, self.desk.setup(), self.attention.uploads);
        let (screen, sight, out) = self.sight_of_screen();
        screen.update_playback(sight, out);
    }

    /// Advances what is under way, room by room: a replay; the level hold and a measurement; work for the screen; a drawing's
    /// tones; and the limit of a drive.
    pub fn turn(&mut self) {
        self.replay();
        let load = self.screen.load();
        let (lab, mut reach) = self.reach();
        lab.turn(load, &mut reach);
        if let Some(plate) = self.lab.take_measured_plate() {
            self.edit(&Edit::Plate(plate));
        }
        let has_other_truth = self.lab.take_other_truth();
        let (screen, sight, out) = self.sight_of_screen();
        if has_other_truth {
            screen.simulate_again(sight);
        }
        screen.turn(sight, out);
        self.send_drawing();
        self.advance_tour();
        self.drive.pause_unwatched(&mut self.out);
        // Every message is in the log, too.
        for (severity, text) in self.out.take_unlogged() {
            self.drive.note(severity, text);
        }
    }

    /// Everything that a shell shows.
    pub fn shown(&self) -> Shown<'_> {
        let shown = self.screen.shown(self.sight(), &self.out);
        Shown { calibration_side: self.calibration_side(), tour: self.tour_scene(), ..shown }
    }

    /// The line of the tone in a slot.
    pub fn line(&self, slot: u8) -> Option<&Line> {
        self.screen.line(slot, self.sight())
    }

    const fn sight(&self) -> Sight<'_> {
        Sight { desk: &self.desk, drive: &self.drive, lab: &self.lab, attention: &self.attention }
    }

    /// The lab, and what it acts on.
    fn reach(&mut self) -> (&mut Lab, Reach<'_>) {
        let Self { desk, drive, lab, attention, out, .. } = self;
        (lab, Reach { desk, drive, attention, out })
    }

    /// The screen, what it looks at, and where its messages go.
    fn sight_of_screen(&mut self) -> (&mut Screen, Sight<'_>, &mut Outbox) {
        let Self { desk, drive, lab, screen, attention, out, .. } = self;
        (screen, Sight { desk, drive, lab, attention }, out)
    }
}

#[cfg(test)]
mod tests;
