//! Playback of the current drive: the drive that the device has acknowledged, its steady field on the plate,
//! the codes that the device sends, and the response of the simulated plate. The wave moves while a drive
//! sounds.

use super::{Screen, Sight};
use crate::instrument::outbox::Outbox;
use crate::instrument::shell::Attention;
use crate::instrument::work::Jobs;
use slipline_link::{Played, Snapshot};
use slipline_model::field::displacement_map::slow_factor;
use slipline_model::field::felt::Felt;
use slipline_model::field::steady_field::{SteadyField, SteadyTone};
use slipline_model::field::time_domain::{SimulatedField, TimeDomainJob};
use slipline_model::jobs::JobQueue;
use slipline_model::sounding;
use slipline_model::waveform::{Waveform, WaveformJob};
use slipline_plate::Plate;
use slipline_plate::feeling::Feeling;
use std::mem::take;
use std::sync::Arc;

/// Least time between two drives passed to the simulated plate during a drag, in seconds. A drag makes dozens
/// of drives a second; computing the plate for each would load a core, and most results would be obsolete
/// before they are done.
const BETWEEN_DRIVES_S: f64 = 0.3;

/// The state of the playback.
#[derive(Default)]
pub(super) struct Playback {
    /// The drive or chord that sounds; `None` at rest, and while combs measure the plate.
    pub(super) sounding: Option<Sounding>,
    /// Whether the device plays tones.
    is_played: bool,
    /// The codes the device sends.
    pub(super) waveform: Waveform,
    /// The latest result of the simulated plate; its drive may have ended.
    pub(super) measured: Option<SimulatedField>,
    /// The current drive while it has not been passed to the simulated plate.
    pub(super) unmeasured: Option<TimeDomainJob>,
    /// When a drive was last passed to the simulated plate, in seconds of the user's time.
    given_s: f64,
    /// How long the wave has moved, in seconds of the user's time.
    pub(super) wave_time_s: f64,
    /// Whether the paused wave is shown at a time that the user has chosen.
    pub(super) is_scrubbed: bool,
    waveforms: JobQueue<WaveformJob, Waveform>,
    time_domain: JobQueue<TimeDomainJob, SimulatedField>,
}

impl Playback {
    pub(super) fn new(jobs: &mut Jobs) -> Self {
        let (waveforms, time_domain) = (take(&mut jobs.waveforms), take(&mut jobs.time_domain));
        Self { waveforms, time_domain, ..Self::default() }
    }

    /// Asks the mirror to replay the journal up to now.
    fn follow(&mut self, snapshot: &Snapshot) {
        if let Some(job) = WaveformJob::of(snapshot) {
            self.waveforms.ask(job);
        }
    }

    /// Stores new results of the mirror and of the simulated plate.
    pub(super) fn take_results(&mut self, is_animated: bool) {
        if let Some(waveform) = self.waveforms.take()
            && (is_animated || self.waveform.window().is_none())
        {
            self.waveform = waveform;
        }
        self.measured = self.time_domain.take().or(self.measured.take());
    }

    /// Passes the current drive to the simulated plate.
    pub(super) fn simulate(&mut self, attention: &Attention) {
        let is_soon = attention.now_s < self.given_s + BETWEEN_DRIVES_S;
        if self.sounding.is_none() {
            self.unmeasured = None;
        } else if attention.is_dragging && is_soon {
            return;
        }
        if let Some(job) = self.unmeasured.take() {
            self.given_s = attention.now_s;
            self.time_domain.ask(job);
        }
    }

    /// The latest result of the simulated plate while a drive sounds on this plate, and whether it belongs to that drive:
    /// during a drag the points of the previous drive stay.
    pub(super) fn shown_measured(&self, plate: &Arc<Plate>) -> Option<(&SimulatedField, bool)> {
        let number = self.on(plate)?.number;
        self.measured.as_ref().map(|measured| (measured, measured.number == number))
    }

    /// What sounds, if it was solved for this plate.
    pub(super) fn on(&self, plate: &Arc<Plate>) -> Option<&Sounding> {
        self.sounding.as_ref().filter(|sounding| Arc::ptr_eq(&sounding.plate, plate))
    }

    /// Recomputes what is felt of the current drive.
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

impl Screen {
    /// The device's clock has advanced: asks the mirror to replay the codes up to now.
    pub(crate) fn follow_clock(&mut self, snapshot: &Snapshot) {
        if self.playback.is_played {
            self.playback.follow(snapshot);
        }
    }

    /// Solves the field of the drive that the device has acknowledged, if it has changed, and passes the
    /// drive to the simulated plate.
    pub(crate) fn update_playback(&mut self, sight: Sight<'_>, out: &mut Outbox) {
        let Sight { desk, drive, .. } = sight;
        let (snapshot, plate) = (drive.snapshot(), &self.plate);
        let acknowledged = sounding::sounding(snapshot);
        // At rest there is nothing to replay, but the change to rest itself must be replayed.
        if acknowledged.is_some() || self.playback.is_played {
            self.playback.follow(snapshot);
        }
        self.playback.is_played = acknowledged.is_some();
        // A comb is no drive of the setup: it measures the plate.
        let Some(acknowledged) = acknowledged.filter(|it| !matches!(it.played, Played::Comb(_))) else {
            self.playback.sounding = None;
            return;
        };
        // Another plate may have the same table: then the device does not change, but the field does.
        let has_table =
            drive.table_made().is_some_and(|made| made.device_table.crc() == acknowledged.table.crc());
        let is_new =
            self.playback.sounding.as_ref().is_none_or(|before| before.number != acknowledged.number);
        if !is_new && (self.playback.on(plate).is_some() || !has_table) {
            return;
        }
        // The device sounds a newer drive, so an earlier refusal no longer matters.
        out.driven();
        let alone = SteadyField::solve(plate, &acknowledged.tones);
        let felt = Felt::of(plate, &desk.setup().feeling, &alone);
        let steady = match self.load() {
            None => alone,
            finger => SteadyField::solve_touched(plate, &acknowledged.tones, finger.as_ref()),
        };
        self.playback.sounding =
            Some(Sounding { number: acknowledged.number, plate: Arc::clone(plate), steady, felt });
        let Some(identity) = &snapshot.device.identity else { return };
        let job = TimeDomainJob {
            number: acknowledged.number,
            plate: Arc::clone(plate),
            table: acknowledged.table,
            played: acknowledged.played,
            dac_bits: identity.dac_bits,
        };
        self.playback.unmeasured = sight.simulated_drive(&job);
        self.run_sheet(job, sight);
    }

    /// Runs the present drive again, because another plate is under the simulated device, or is known now.
    pub(crate) fn simulate_again(&mut self, sight: Sight<'_>) {
        self.playback.time_domain.cancel();
        self.playback.measured = None;
        let drive = self.background.driven.as_ref().and_then(|drive| sight.simulated_drive(drive));
        self.playback.unmeasured = drive.filter(|_| self.sounding().is_some());
    }

    /// Whether a drive sounds.
    #[must_use]
    pub const fn is_sounding(&self) -> bool {
        self.playback.sounding.is_some()
    }

    /// The field of the current drive, if it was solved for the plate on the screen.
    pub fn sounding(&self) -> Option<&SteadyField> {
        self.playback.on(&self.plate).map(|sounding| &sounding.steady)
    }

    /// Whether the device sends codes that are not known.
    #[must_use]
    pub fn is_waveform_unknown(&self) -> bool {
        let waveform = &self.playback.waveform;
        waveform.window().is_some() && !waveform.is_true()
    }

    /// Shows the wave at this time, in seconds of the plate; returns whether there is a wave, which then must
    /// be paused.
    pub fn scrub(&mut self, plate_time_s: f64) -> bool {
        let Some(sounding) = self.playback.on(&self.plate).filter(|_| plate_time_s.is_finite()) else {
            return false;
        };
        self.playback.wave_time_s = plate_time_s * slow_factor(&sounding.steady);
        self.playback.is_scrubbed = true;
        true
    }

    /// Advances the wave by `step_s` seconds of the user's time.
    pub(crate) fn move_on(&mut self, step_s: f64, sight: Sight<'_>) {
        self.playback.is_scrubbed = false;
        self.playback.wave_time_s += step_s;
        self.trace_finger(sight);
        self.advance_sheet(step_s);
    }
}

impl Sight<'_> {
    /// This drive on the plate under the simulated device, if that plate is known.
    fn simulated_drive(&self, drive: &TimeDomainJob) -> Option<TimeDomainJob> {
        let plate = self.lab.simulated_plate(self.desk.plate(), self.drive.snapshot())?;
        Some(TimeDomainJob { plate: Arc::clone(plate), ..drive.clone() })
    }
}
