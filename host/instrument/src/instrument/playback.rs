//! Playback of the current drive: the drive that the device has acknowledged, its steady field on the plate,
//! the codes that the device sends, and the response of the simulated plate. The wave moves while a drive
//! sounds.

use super::Instrument;
use slipline_model::field::displacement_map::slow_factor;
use slipline_model::field::felt::Felt;
use slipline_model::field::steady_field::{SteadyField, SteadyTone};
use slipline_model::field::time_domain::{SimulatedField, TimeDomainJob};
use slipline_model::sounding;
use slipline_model::waveform::{Waveform, WaveformJob};
use slipline_plate::Plate;
use slipline_plate::feeling::Feeling;
use std::sync::Arc;

/// Least time between two drives passed to the simulated plate during a drag, in seconds. A drag makes dozens
/// of drives a second; computing the plate for each would load a core, and most results would be obsolete
/// before they are done.
const BETWEEN_DRIVES_S: f64 = 0.3;

/// The state of the playback.
#[derive(Default)]
pub(crate) struct Playback {
    /// What sounds; `None` at rest.
    pub(crate) sounding: Option<Sounding>,
    /// The codes the device sends.
    pub(crate) waveform: Waveform,
    /// The latest result of the simulated plate; its drive may have ended.
    pub(crate) measured: Option<SimulatedField>,
    /// The current drive while it has not been passed to the simulated plate.
    pub(crate) unmeasured: Option<TimeDomainJob>,
    /// When a drive was last passed to the simulated plate, in seconds of the user's time.
    given_s: f64,
    /// How long the wave has moved, in seconds of the user's time.
    pub(crate) wave_time_s: f64,
    /// Whether the paused wave is shown at a time that the user has chosen.
    pub(crate) is_scrubbed: bool,
}

impl Playback {
    /// What sounds, if it was solved for this plate.
    pub(crate) fn on(&self, plate: &Arc<Plate>) -> Option<&Sounding> {
        self.sounding.as_ref().filter(|sounding| Arc::ptr_eq(&sounding.plate, plate))
    }

    /// Recomputes what is felt of the current drive.
    pub(crate) fn feel(&mut self, feeling: &Feeling) {
        if let Some(sounding) = &mut self.sounding {
            let tones: Vec<SteadyTone> = sounding.steady.tones.iter().map(|wave| wave.tone).collect();
            sounding.felt = Felt::of(&sounding.plate, feeling, &SteadyField::solve(&sounding.plate, &tones));
        }
    }
}

/// A drive that the device has acknowledged, solved for a plate.
pub(crate) struct Sounding {
    /// The number of the journal's entry.
    pub(crate) number: u64,
    /// The plate of the solution: the screen may already show another one, whose table is not on the device yet.
    pub(crate) plate: Arc<Plate>,
    /// The steady field on that plate, with the finger if there is one.
    pub(crate) steady: SteadyField,
    /// What is felt of it.
    pub(crate) felt: Felt,
}

impl Instrument {
    /// Asks the mirror to replay the journal up to now.
    pub(crate) fn follow(&mut self) {
        if let Some(job) = WaveformJob::of(&self.snapshot) {
            self.jobs.waveforms.ask(job);
        }
    }

    /// Solves the field of the drive that the device has acknowledged, if it has changed, and passes the
    /// drive to the simulated plate.
    pub(crate) fn update_playback(&mut self) {
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
        let steady = match self.load() {
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
        self.playback.unmeasured = self.simulated_drive(&job);
        self.run_sheet(job);
    }

    /// The field of the current drive, if it was solved for the plate on the screen.
    pub fn sounding_on_screen(&self) -> Option<&SteadyField> {
        self.playback.on(&self.setup.plate).map(|sounding| &sounding.steady)
    }

    /// The result of the simulated plate, if it belongs to the current drive.
    pub fn current_measured(&self) -> Option<&SimulatedField> {
        let number = self.playback.sounding.as_ref()?.number;
        self.playback.measured.as_ref().filter(|measured| measured.number == number)
    }

    /// The latest result of the simulated plate while a drive sounds, and whether it belongs to that drive:
    /// during a drag the points of the previous drive stay.
    pub(crate) fn shown_measured(&self) -> Option<(&SimulatedField, bool)> {
        let number = self.playback.on(&self.setup.plate)?.number;
        self.playback.measured.as_ref().map(|measured| (measured, measured.number == number))
    }

    /// Stores new results of the mirror and of the simulated plate.
    pub(crate) fn take_playback(&mut self) {
        if let Some(waveform) = self.jobs.waveforms.take()
            && (self.attention.is_animated || self.playback.waveform.window().is_none())
        {
            self.playback.waveform = waveform;
        }
        if let Some(measured) = self.jobs.time_domain.take() {
            self.playback.measured = Some(measured);
        }
    }

    /// Shows the wave at this time, in seconds of the plate; returns whether there is a wave, which then must
    /// be paused.
    pub fn scrub(&mut self, plate_time_s: f64) -> bool {
        let Some(sounding) = self.playback.on(&self.setup.plate).filter(|_| plate_time_s.is_finite()) else {
            return false;
        };
        self.playback.wave_time_s = plate_time_s * slow_factor(&sounding.steady);
        self.playback.is_scrubbed = true;
        true
    }

    /// Passes the current drive to the simulated plate, at `now_s` of the user's time.
    pub(crate) fn measure(&mut self, now_s: f64) {
        let is_soon = now_s < self.playback.given_s + BETWEEN_DRIVES_S;
        if self.playback.sounding.is_none() {
            self.playback.unmeasured = None;
        } else if self.attention.is_dragging && is_soon {
            return;
        }
        if let Some(job) = self.playback.unmeasured.take() {
            self.playback.given_s = now_s;
            self.jobs.time_domain.ask(job);
        }
    }

    /// Advances the wave by `step_s` seconds of the user's time.
    pub fn move_on(&mut self, step_s: f64) {
        self.playback.is_scrubbed = false;
        self.playback.wave_time_s += step_s;
        self.trace_finger(self.attention.now_s);
        self.advance_sheet(step_s);
    }
}
