//! The rig of the simulated device: its plate and sensor, put together in the background.

use super::MeasureDraft;
use crate::bench::Bench;
use crate::instrument::outbox::Outbox;
use crate::instrument::work::Jobs;
use crate::jobs::rig::{RigJob, RigPrepared};
use crate::measure::KnownDrive;
use crate::rig::{RigError, RigHand, secret};
use slipline_model::jobs::JobQueue;
use slipline_plate::{Finger, Plate};
use std::mem::take;
use std::sync::Arc;

/// The rig of the simulated device.
#[derive(Default)]
pub(super) struct Rig {
    bench: Bench,
    queue: JobQueue<RigJob, RigPrepared>,
    /// The unknown plate of the rig; `None` for the one on the screen.
    secret: Option<Secret>,
    /// Number of unknown plates drawn so far.
    draws: u64,
    /// Whether another plate is under the simulated device, or is known now, since that was last asked.
    has_other_truth: bool,
    /// The rig on the bench.
    standing: Option<Stands>,
    /// What starts once the rig is put together.
    pub(super) awaited_for: Option<Awaiting>,
    /// The rig that is being put together.
    looked_for: Option<RigJob>,
    /// A rig that could not be put together: only the user can request it again.
    pub(super) refused: Option<RigJob>,
}

/// What waits for the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Awaiting {
    /// A measurement, for this place of the calibration, 0 or 1, if any.
    Measurement(Option<usize>),
    /// The measurement of the drive's harmonics.
    Harmonics,
    /// The test of the amplifier.
    Selftest,
}

/// An unknown plate, and the plates on the screen that describe it.
struct Secret {
    truth: Arc<Plate>,
    /// The plate from which it was drawn, and those that were calibrated on it.
    models: Vec<Arc<Plate>>,
    /// Whether a measurement of it was made.
    is_measured: bool,
}

/// The rig on the bench.
struct Stands {
    job: RigJob,
    /// The hand that moves its sensor.
    hand: RigHand,
    /// Sensor value at the end of its input's range.
    full_scale: f64,
    /// Data-sheet values of its drive.
    drive: KnownDrive,
}

impl Rig {
    /// The rig on this bench.
    pub(super) fn on(bench: Bench, jobs: &mut Jobs) -> Self {
        Self { bench, queue: take(&mut jobs.rigs), ..Self::default() }
    }

    /// Whether its plate is unknown to the user.
    pub(super) const fn is_secret(&self) -> bool {
        self.secret.is_some()
    }

    /// The number of the unknown plate, if there is one.
    pub(super) fn draw(&self) -> Option<u64> {
        self.is_secret().then_some(self.draws)
    }

    /// The unknown plate, and whether it was measured.
    pub(super) fn truth(&self) -> Option<(&Arc<Plate>, bool)> {
        self.secret.as_ref().map(|secret| (&secret.truth, secret.is_measured))
    }

    /// The unknown plate remains the actual one for this plate, which was calibrated on it.
    pub(super) fn is_described_by(&mut self, calibrated: &Arc<Plate>) {
        if let Some(secret) = &mut self.secret {
            secret.models.push(Arc::clone(calibrated));
        }
    }

    /// Data-sheet values of its drive.
    pub(super) fn known_drive(&self) -> Option<KnownDrive> {
        self.standing.as_ref().map(|standing| standing.drive)
    }

    /// Puts an unknown plate on the rig, or the one on the screen.
    pub(super) fn choose(&mut self, is_secret: bool, plate: &Arc<Plate>, out: &mut Outbox) {
        self.secret = None;
        if is_secret {
            self.draws += 1;
            match secret(plate, self.draws) {
                Ok(truth) => {
                    let (truth, models) = (Arc::new(truth), vec![Arc::clone(plate)]);
                    self.secret = Some(Secret { truth, models, is_measured: false });
                }
                Err(error) => out.fail(format!("No plate like this one was found: {error}")),
            }
        }
        self.has_other_truth = true;
    }

    /// A measurement of its plate was made.
    pub(super) fn note_measured(&mut self) {
        if let Some(secret) = self.secret.as_mut().filter(|secret| !secret.is_measured) {
            secret.is_measured = true;
            self.has_other_truth = true;
        }
    }

    /// Draws another unknown plate if the present one does not belong to the plate on the screen.
    pub(super) fn renew(&mut self, plate: &Arc<Plate>, out: &mut Outbox) {
        let is_foreign = |secret: &Secret| !secret.models.iter().any(|model| Arc::ptr_eq(model, plate));
        if self.secret.as_ref().is_some_and(is_foreign) {
            self.choose(true, plate, out);
        }
    }

    /// Whether another plate is under the simulated device, or is known now, since the last call.
    pub(super) const fn take_other_truth(&mut self) -> bool {
        std::mem::replace(&mut self.has_other_truth, false)
    }

    /// The rig for this measurement of the plate on the screen.
    pub(super) fn wanted(&self, plate: &Arc<Plate>, draft: &MeasureDraft, sample_rate_hz: f64) -> RigJob {
        let truth = self.secret.as_ref().map_or(plate, |secret| &secret.truth);
        let MeasureDraft { place_m, kind, body, .. } = *draft;
        let truth = Arc::clone(truth);
        RigJob { truth, sensor: kind, place_m, sample_rate_hz, full_scale: None, finger: None, body }
    }

    /// Whether the wanted rig is on the bench; moves its sensor to the wanted place.
    pub(super) fn is_standing(&self, wanted: &RigJob) -> bool {
        let standing = self.standing.as_ref().filter(|standing| standing.job.serves(wanted));
        standing.is_some_and(|standing| {
            standing.hand.place_m() == wanted.place_m || standing.hand.put_sensor(wanted.place_m).is_ok()
        })
    }

    /// Requests a rig, unless it is being put together or is known to fail.
    pub(super) fn look_for(&mut self, wanted: RigJob) {
        let known = [&self.looked_for, &self.refused];
        if !known.into_iter().flatten().any(|known| known.serves(&wanted)) {
            self.looked_for = Some(wanted.clone());
            self.queue.ask(wanted);
        }
    }

    /// Puts this finger on its plate, or takes it off. Returns whether the plate is as wanted.
    pub(super) fn touch(&mut self, finger: Option<Finger>) -> bool {
        if self.bench.is_passing_over() {
            return false;
        }
        let Some(standing) = self.standing.as_ref().filter(|standing| standing.job.finger != finger) else {
            return true;
        };
        let (full_scale, place_m) = (Some(standing.full_scale), standing.hand.place_m());
        // A finger and a sensor that weighs are not simulated together.
        let body = standing.job.body.filter(|_| finger.is_none());
        let wanted = RigJob { finger, body, full_scale, place_m, ..standing.job.clone() };
        self.look_for(wanted);
        false
    }

    /// Lets the rig rest, or resumes its sampling.
    pub(super) fn rest(&self, is_resting: bool) {
        self.bench.rest(is_resting);
    }

    /// Taps on its plate.
    pub(super) fn tap(&self) {
        self.bench.tap();
    }

    /// Puts a finished rig on the bench, without a step while a level is held.
    pub(super) fn take(&mut self, is_held: bool) -> Result<(), RigError> {
        let Some(RigPrepared { job, result }) = self.queue.take() else { return Ok(()) };
        if self.looked_for.take().is_none_or(|looked_for| !looked_for.serves(&job)) {
            return Ok(());
        }
        let rig = result.inspect_err(|_| self.refused = Some(job.clone()))?;
        if is_held {
            self.bench.pass_over_to(&rig, job.sample_rate_hz);
        } else {
            self.bench.put(&rig);
        }
        let (hand, full_scale, drive) = (rig.hand(), rig.sensor_full_scale(), rig.known_drive());
        self.standing = Some(Stands { job, hand, full_scale, drive });
        Ok(())
    }
}
