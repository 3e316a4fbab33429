//! What the app hears of the device: what sounds by its own word, the picture of it on the plate, the codes it sends
//! and what the simulated plate does under them. The wave moves while there is something to hear.

use super::App;
use eframe::egui;
use slipline_model::autopilot;
use slipline_model::field::steady_field::Picture;
use slipline_model::field::time_domain::{self, Measured};
use slipline_model::waveform::{self, Live};
use slipline_plate::Plate;
use std::sync::Arc;
use std::time::Duration;

/// Time between two pictures of the moving wave.
const FRAME: Duration = Duration::from_millis(33);
/// Time between two looks at the meters while the wave stands.
const GLANCE: Duration = Duration::from_millis(500);

/// What has been heard.
#[derive(Default)]
pub(super) struct Hearing {
    /// What sounds; `None` at rest.
    pub(super) sounding: Option<Sounding>,
    /// The codes the device sends.
    pub(super) live: Live,
    /// The latest run of the simulated plate, perhaps under a drive that sounds no more.
    pub(super) measured: Option<Measured>,
    /// How long the wave has moved, in seconds of the user's time.
    pub(super) wave_time_s: f64,
}

/// A drive that the device has acknowledged, solved for a plate.
pub(super) struct Sounding {
    /// The number of the journal's entry.
    pub(super) number: u64,
    /// The plate it was solved for: the screen may show another, whose table is still to come.
    plate: Arc<Plate>,
    /// Its wave on that plate.
    pub(super) picture: Picture,
}

impl App {
    /// Has the mirror follow the device up to now.
    pub(super) fn follow(&mut self) {
        if let Some(job) = waveform::Job::of(&self.snapshot) {
            self.parts.live.ask(job);
        }
    }

    /// Solves for what the device has acknowledged, when that has changed, and has it tried on the simulated plate.
    pub(super) fn hear(&mut self) {
        let heard = autopilot::sounding(&self.snapshot);
        // At rest the mirror has nothing to follow; the change to rest itself is followed.
        if heard.is_some() || self.hearing.sounding.is_some() {
            self.follow();
        }
        let Some(heard) = heard else {
            self.hearing.sounding = None;
            return;
        };
        // Another plate with the very same table leaves the device as it is; the picture is another all the same.
        let has_table = self.screen_table().is_some_and(|made| made.device_table.crc() == heard.table.crc());
        let is_new = self.hearing.sounding.as_ref().is_none_or(|before| before.number != heard.number);
        if !is_new && (self.heard_on_screen().is_some() || !has_table) {
            return;
        }
        // What was refused before is settled: the device sounds something newer.
        self.notices.settle();
        let plate = Arc::clone(&self.setup.plate);
        let picture = Picture::solve(&plate, &heard.tones);
        self.hearing.sounding = Some(Sounding { number: heard.number, plate: Arc::clone(&plate), picture });
        let Some(identity) = &self.snapshot.identity else { return };
        let job = time_domain::Job {
            number: heard.number,
            plate,
            table: heard.table,
            drive: heard.drive,
            dac_bits: identity.dac_bits,
        };
        if identity.simulated {
            self.parts.trials.ask(job.clone());
        }
        self.run_sheet(job);
    }

    /// The wave of what sounds, if it was solved for the plate on the screen.
    pub(super) fn heard_on_screen(&self) -> Option<&Picture> {
        let sounding = self.hearing.sounding.as_ref()?;
        Arc::ptr_eq(&sounding.plate, &self.setup.plate).then_some(&sounding.picture)
    }

    /// What was measured, if it belongs to what sounds.
    pub(super) fn current_measured(&self) -> Option<&Measured> {
        let number = self.hearing.sounding.as_ref()?.number;
        self.hearing.measured.as_ref().filter(|measured| measured.number == number)
    }

    /// Takes what the mirror and the simulated plate have come to.
    pub(super) fn take_heard(&mut self) {
        if let Some(live) = self.parts.live.take()
            && (self.settings.animate || self.hearing.live.window().is_none())
        {
            self.hearing.live = live;
        }
        if let Some(measured) = self.parts.trials.take() {
            self.hearing.measured = Some(measured);
        }
    }

    /// Moves the wave on and asks for the next picture, but only while something moves.
    pub(super) fn advance(&mut self, ctx: &egui::Context) {
        let is_visible = ctx.input(|input| {
            let viewport = input.viewport();
            viewport.minimized != Some(true) && viewport.occluded != Some(true)
        });
        if self.hearing.sounding.is_none() || !is_visible {
            return;
        }
        if self.settings.animate {
            let step = ctx.input(|input| f64::from(input.stable_dt.min(0.1)));
            self.hearing.wave_time_s += step;
            self.advance_sheet(step);
            ctx.request_repaint_after(FRAME);
        } else {
            ctx.request_repaint_after(GLANCE);
        }
    }
}
