//! The rig of the simulated device: its plate and sensor, put together in the background.

use super::Instrument;
use super::MeasureDraft;
use crate::hold::Standing;
use crate::jobs::rig::{RigJob, RigPrepared};
use crate::measure::KnownDrive;
use crate::rig::{RigHand, secret};
use slipline_link::Port;
use slipline_plate::{Finger, Plate};
use std::sync::Arc;

/// The rig of the simulated device.
#[derive(Default)]
pub(crate) struct Rig {
    /// The unknown plate of the rig; `None` for the one on the screen.
    secret: Option<Secret>,
    /// Number of unknown plates drawn so far.
    draws: u64,
    /// The rig on the bench.
    standing: Option<Stands>,
    /// The measurement that starts once the rig is put together.
    pub(crate) awaited_for: Option<Option<usize>>,
    /// The rig that is being put together to show its sensor's signal, or for another finger.
    looked_for: Option<RigJob>,
    /// A rig that could not be put together: only the user can request it again.
    pub(crate) refused: Option<RigJob>,
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
    /// Whether it is put together for a measurement.
    pub(crate) const fn is_awaited(&self) -> bool {
        self.awaited_for.is_some()
    }

    /// Whether its plate is unknown to the user.
    pub(crate) const fn is_secret(&self) -> bool {
        self.secret.is_some()
    }

    /// The unknown plate, and whether it was measured.
    pub(crate) fn truth(&self) -> Option<(&Arc<Plate>, bool)> {
        self.secret.as_ref().map(|secret| (&secret.truth, secret.is_measured))
    }

    /// Keeps the unknown plate under a plate that was calibrated on it.
    pub(crate) fn is_described_by(&mut self, calibrated: &Arc<Plate>) {
        if let Some(secret) = &mut self.secret {
            secret.models.push(Arc::clone(calibrated));
        }
    }

    /// Data-sheet values of its drive.
    pub(crate) fn known_drive(&self) -> Option<KnownDrive> {
        self.standing.as_ref().map(|standing| standing.drive)
    }

    /// The finger on its plate, if there is one.
    fn finger(&self) -> Option<Finger> {
        self.standing.as_ref()?.job.finger
    }
}

impl Instrument {
    /// Has the simulated device use an unknown plate, or the one on the screen.
    pub(crate) fn choose_truth(&mut self, is_secret: bool) {
        let rig = &mut self.live.rig;
        rig.secret = None;
        if is_secret {
            rig.draws += 1;
            let plate = &self.setup.plate;
            match secret(plate, rig.draws) {
                Ok(truth) => {
                    let (truth, models) = (Arc::new(truth), vec![Arc::clone(plate)]);
                    rig.secret = Some(Secret { truth, models, is_measured: false });
                }
                Err(error) => self.fail(format!("No plate like this one was found: {error}")),
            }
        }
        self.simulate_again();
    }

    /// A measurement of the plate under the simulated device was made.
    pub(crate) fn note_measured(&mut self) {
        if let Some(secret) = self.live.rig.secret.as_mut().filter(|secret| !secret.is_measured) {
            secret.is_measured = true;
            self.simulate_again();
        }
    }

    /// Draws another unknown plate if the one under the simulated device does not belong to the plate on the screen.
    pub(crate) fn renew_truth(&mut self) {
        let is_foreign =
            |secret: &Secret| !secret.models.iter().any(|model| Arc::ptr_eq(model, &self.setup.plate));
        if self.live.rig.secret.as_ref().is_some_and(is_foreign) {
            self.choose_truth(true);
        }
    }

    fn rig_job(&self) -> RigJob {
        let truth = self.live.rig.secret.as_ref().map_or(&self.setup.plate, |secret| &secret.truth);
        let MeasureDraft { place_m, kind, .. } = self.live.draft;
        RigJob {
            truth: Arc::clone(truth),
            sensor: kind,
            place_m,
            sample_rate_hz: self.sample_rate_hz(),
            full_scale: None,
            finger: None,
        }
    }

    /// Whether the wanted rig is on the bench; moves its sensor to the wanted place.
    pub(crate) fn is_rig_standing(&self) -> bool {
        let job = self.rig_job();
        let standing = self.live.rig.standing.as_ref().filter(|standing| standing.job.serves(&job));
        standing.is_some_and(|standing| {
            standing.hand.place_m() == job.place_m || standing.hand.put_sensor(job.place_m).is_ok()
        })
    }

    pub(crate) fn put_rig_together(&mut self, answers: Option<usize>) {
        self.live.rig.awaited_for = Some(answers);
        self.live.rig.refused = None;
        self.jobs.rigs.ask(self.rig_job());
    }

    /// Whether the device is this program's simulated device, whose inputs are wired to the rig.
    pub(crate) fn is_at_bench(&self) -> bool {
        self.snapshot.is_simulated() && self.snapshot.port == Some(Port::Simulated)
    }

    /// Puts the rig of a simulated device on the bench for a look at its sensor.
    pub(crate) fn put_rig_up(&mut self) {
        if self.is_at_bench() && !self.is_rig_standing() {
            self.look_for_rig(self.rig_job());
        }
    }

    /// Requests a rig, unless it is being put together or is known to fail.
    fn look_for_rig(&mut self, job: RigJob) {
        let Rig { looked_for, refused, .. } = &mut self.live.rig;
        let is_known = [&*looked_for, &*refused].into_iter().flatten().any(|known| known.serves(&job));
        if !is_known {
            *looked_for = Some(job.clone());
            self.jobs.rigs.ask(job);
        }
    }

    /// While the level is held, puts the finger of the screen on the rig's plate, too; takes it off again for
    /// listening, which needs an untouched plate. Returns whether the plate is as wanted.
    pub(crate) fn touch_rig(&mut self) -> bool {
        if self.bench.is_passing_over() {
            return false;
        }
        let is_held = matches!(self.level.holding.standing(&self.snapshot), Standing::Holding(_));
        let wanted = self.load().filter(|_| is_held);
        let rig = &self.live.rig;
        let Some(standing) = rig.standing.as_ref().filter(|_| rig.finger() != wanted) else { return true };
        let full_scale = Some(standing.full_scale);
        let job =
            RigJob { finger: wanted, full_scale, place_m: standing.hand.place_m(), ..standing.job.clone() };
        self.look_for_rig(job);
        false
    }

    /// Lets the rig rest while nothing listens to it.
    pub(crate) fn rest_bench(&self) {
        let is_heard = self.live.is_heard() || self.level.awaits_rig || self.level.holding.is_on();
        self.bench.rest(!is_heard);
    }

    /// Puts a finished rig on the bench, and starts what waits for it.
    pub(crate) fn take_rig(&mut self) {
        let Some(RigPrepared { job, result }) = self.jobs.rigs.take() else { return };
        let looked_for = self.live.rig.looked_for.take();
        let awaited_for = self.live.rig.awaited_for.take();
        if awaited_for.is_none() && looked_for.is_none_or(|looked_for| !looked_for.serves(&job)) {
            return;
        }
        match result {
            Ok(rig) => {
                if self.level.holding.is_on() {
                    self.bench.pass_over_to(&rig, job.sample_rate_hz);
                } else {
                    self.bench.put(&rig);
                }
                let (hand, full_scale, drive) = (rig.hand(), rig.sensor_full_scale(), rig.known_drive());
                self.live.rig.standing = Some(Stands { job, hand, full_scale, drive });
                if let Some(answers) = awaited_for {
                    self.begin_measuring(answers);
                }
            }
            Err(reason) => {
                self.live.rig.refused = Some(job);
                self.level.awaits_rig = false;
                self.fail(format!("The simulated plate cannot be measured: {reason}"));
            }
        }
    }
}
