//! The playback of what the device sounds: the drive that it has acknowledged, the steady field of that drive on
//! the plate, the codes that it sends, and the response of the simulated plate. The wave moves while something
//! sounds.

use super::App;
use crate::sound::SoundChoice;
use eframe::egui;
use slipline_model::field::displacement_map::slow_factor;
use slipline_model::field::felt::Felt;
use slipline_model::field::steady_field::{SteadyField, SteadyTone};
use slipline_model::field::time_domain::{Measured, TimeDomainJob};
use slipline_model::sounding;
use slipline_model::waveform::{Waveform, WaveformJob};
use slipline_plate::Plate;
use slipline_plate::feeling::Feeling;
use std::sync::Arc;
use std::time::Duration;

/// Time between two frames of the moving wave.
const FRAME: Duration = Duration::from_millis(33);
/// Time between two drives that the simulated plate is given during a drag, in seconds. A drag makes dozens a second;
/// to compute the plate for each would take a part of a core, and most would be replaced before they are done.
const BETWEEN_DRIVES_S: f64 = 0.3;
/// Time between two updates of the meters while the wave is paused.
const GLANCE: Duration = Duration::from_millis(500);

/// The state of the playback.
#[derive(Default)]
pub(super) struct Playback {
    /// What sounds; `None` at rest.
    pub(super) sounding: Option<Sounding>,
    /// The codes the device sends.
    pub(super) waveform: Waveform,
    /// The latest result of the simulated plate; its drive may have ended.
    pub(super) measured: Option<Measured>,
    /// What sounds, while the simulated plate has not been given it.
    unmeasured: Option<TimeDomainJob>,
    /// When the simulated plate was given a drive, in seconds of the user's time.
    given_s: f64,
    /// How long the wave has moved, in seconds of the user's time.
    pub(super) wave_time_s: f64,
    /// Whether the paused wave is shown at a time that the user has chosen.
    pub(super) is_scrubbed: bool,
}

impl Playback {
    /// What sounds, if it was solved for this plate.
    pub(super) fn on(&self, plate: &Arc<Plate>) -> Option<&Sounding> {
        self.sounding.as_ref().filter(|sounding| Arc::ptr_eq(&sounding.plate, plate))
    }

    /// Whether something is sent of which the codes are not known.
    pub(super) fn is_unknown(&self) -> bool {
        self.waveform.window().is_some() && !self.waveform.is_true()
    }

    /// What sounds is felt in another way now.
    pub(super) fn feel(&mut self, feeling: &Feeling) {
        if let Some(sounding) = &mut self.sounding {
            let tones: Vec<SteadyTone> = sounding.steady.tones.iter().map(|wave| wave.tone).collect();
            sounding.felt = Felt::of(&sounding.plate, feeling, &SteadyField::solve(&sounding.plate, &tones));
        }
    }
}

/// A drive that the device has acknowledged, solved for a plate.
pub(super) struct Sounding {
    /// The number of the journal's entry.
    pub(super) number: u64,
    /// The plate of the solution: the screen may already show another one, whose table is not on the device yet.
    pub(super) plate: Arc<Plate>,
    /// The steady field on that plate, with the finger if there is one.
    pub(super) steady: SteadyField,
    /// What is felt of it.
    pub(super) felt: Felt,
}

impl App {
    /// Asks the mirror to replay the journal up to now.
    pub(super) fn follow(&mut self) {
        if let Some(job) = WaveformJob::of(&self.snapshot) {
            self.parts.waveforms.ask(job);
        }
    }

    /// Solves the field of the drive that the device has acknowledged, if it has changed, and passes the drive to
    /// the simulated plate.
    pub(super) fn update_playback(&mut self) {
        let acknowledged = sounding::sounding(&self.snapshot);
        // At rest there is nothing to replay, but the change to rest itself must be replayed.
        if acknowledged.is_some() || self.playback.sounding.is_some() {
            self.follow();
        }
        let Some(acknowledged) = acknowledged else {
            self.playback.sounding = None;
            return;
        };
        // Another plate may have the same table: then the device does not change, but the field does.
        let has_table =
            self.screen_table().is_some_and(|made| made.device_table.crc() == acknowledged.table.crc());
        let is_new =
            self.playback.sounding.as_ref().is_none_or(|before| before.number != acknowledged.number);
        if !is_new && (self.sounding_on_screen().is_some() || !has_table) {
            return;
        }
        // The device sounds a newer drive, so an earlier refusal no longer matters.
        self.notices.driven();
        let plate = Arc::clone(&self.setup.plate);
        let alone = SteadyField::solve(&plate, &acknowledged.tones);
        let felt = Felt::of(&plate, &self.setup.feeling, &alone);
        let steady = match self.finger() {
            None => alone,
            finger => SteadyField::solve_touched(&plate, &acknowledged.tones, finger.as_ref()),
        };
        self.playback.sounding =
            Some(Sounding { number: acknowledged.number, plate: Arc::clone(&plate), steady, felt });
        let Some(identity) = &self.snapshot.identity else { return };
        let job = TimeDomainJob {
            number: acknowledged.number,
            plate,
            table: acknowledged.table,
            played: acknowledged.played,
            dac_bits: identity.dac_bits,
        };
        self.playback.unmeasured = identity.simulated.then(|| job.clone());
        self.run_sheet(job);
    }

    /// The field of what sounds, if it was solved for the plate on the screen.
    pub(super) fn sounding_on_screen(&self) -> Option<&SteadyField> {
        self.playback.on(&self.setup.plate).map(|sounding| &sounding.steady)
    }

    /// The result of the simulated plate, if it belongs to what sounds.
    pub(super) fn current_measured(&self) -> Option<&Measured> {
        let number = self.playback.sounding.as_ref()?.number;
        self.playback.measured.as_ref().filter(|measured| measured.number == number)
    }

    /// The latest result of the simulated plate while it sounds, and whether it belongs to what sounds: during a drag the
    /// points of the drive before stay.
    pub(super) fn shown_measured(&self) -> Option<(&Measured, bool)> {
        let number = self.playback.on(&self.setup.plate)?.number;
        self.playback.measured.as_ref().map(|measured| (measured, measured.number == number))
    }

    /// Takes new results of the mirror and of the simulated plate.
    pub(super) fn take_playback(&mut self) {
        if let Some(waveform) = self.parts.waveforms.take()
            && (self.settings.animate || self.playback.waveform.window().is_none())
        {
            self.playback.waveform = waveform;
        }
        if let Some(measured) = self.parts.time_domain.take() {
            self.playback.measured = Some(measured);
        }
    }

    /// Advances the wave and requests the next frame, but only while something moves.
    pub(super) fn advance(&mut self, ctx: &egui::Context) {
        self.measure(ctx.input(|input| input.time));
        self.move_on(ctx);
        self.play_sound();
    }

    /// Pauses the wave and shows it at this time, in seconds of the plate.
    pub(super) fn scrub(&mut self, plate_time_s: f64) {
        let Some(sounding) = self.playback.on(&self.setup.plate).filter(|_| plate_time_s.is_finite()) else {
            return;
        };
        self.playback.wave_time_s = plate_time_s * slow_factor(&sounding.steady);
        self.playback.is_scrubbed = true;
        self.settings.animate = false;
    }

    /// Gives the simulated plate what sounds, at `now_s` of the user's time.
    fn measure(&mut self, now_s: f64) {
        let is_soon = now_s < self.playback.given_s + BETWEEN_DRIVES_S;
        if self.playback.sounding.is_none() {
            self.playback.unmeasured = None;
        } else if self.grab.is_some() && is_soon {
            return;
        }
        if let Some(job) = self.playback.unmeasured.take() {
            self.playback.given_s = now_s;
            self.parts.time_domain.ask(job);
        }
    }

    fn move_on(&mut self, ctx: &egui::Context) {
        let is_visible = ctx.input(|input| {
            let viewport = input.viewport();
            viewport.minimized != Some(true) && viewport.occluded != Some(true)
        });
        if self.playback.sounding.is_none() {
            self.end_trace();
            return;
        }
        if !is_visible {
            return;
        }
        if self.settings.animate {
            let step = ctx.input(|input| f64::from(input.stable_dt.min(0.1))) * self.settings.speed;
            self.playback.is_scrubbed = false;
            self.playback.wave_time_s += step;
            self.trace_finger(ctx.input(|input| input.time));
            self.advance_sheet(step);
            ctx.request_repaint_after(FRAME);
        } else {
            let plays_drive = self.sound_choice() == SoundChoice::Drive;
            ctx.request_repaint_after(if plays_drive { FRAME } else { GLANCE });
        }
    }
}
