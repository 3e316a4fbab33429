//! The actual plate beside the predicting one: the simulated device's plate, or the measurements of a real one.

use super::Sight;
use crate::instrument::work::Jobs;
use slipline_model::field::time_domain::TimeDomainJob;
use slipline_model::jobs::JobQueue;
use slipline_model::jobs::measured_places::{MeasuredPlace, MeasuredPlaces, MeasuredPlacesJob};
use std::mem::take;
use std::sync::Arc;

/// What was measured of a real plate.
#[derive(Default)]
pub(super) struct ActualPlate {
    asked: Option<MeasuredPlacesJob>,
    latest: Option<MeasuredPlaces>,
    queue: JobQueue<MeasuredPlacesJob, MeasuredPlaces>,
}

impl ActualPlate {
    pub(super) fn new(jobs: &mut Jobs) -> Self {
        Self { queue: take(&mut jobs.measured_places), ..Self::default() }
    }

    /// The places at which it was measured.
    pub(super) fn places(&self) -> &[MeasuredPlace] {
        let current = self.latest.as_ref().filter(|latest| Some(&latest.job) == self.asked.as_ref());
        current.map_or(&[], |found| &found.places)
    }

    /// Compares what was measured of a real plate with the plate on the screen.
    pub(super) fn compare(&mut self, sight: Sight<'_>) {
        self.latest = self.queue.take().or(self.latest.take());
        let snapshot = sight.drive.snapshot();
        let is_real = snapshot.is_connected() && !snapshot.is_simulated();
        let (plate, measurements) = (sight.desk.plate(), || sight.lab.drawn().filter(|_| is_real));
        if self.asked.as_ref().is_none_or(|asked| !asked.is_of(plate, measurements())) {
            let measurements = measurements().cloned().collect();
            let job = MeasuredPlacesJob { plate: Arc::clone(plate), measurements };
            self.asked = Some(job.clone());
            self.queue.ask(job);
        }
    }
}

impl Sight<'_> {
    /// This drive on the plate under the simulated device, if that plate is known.
    pub(super) fn simulated_drive(&self, drive: &TimeDomainJob) -> Option<TimeDomainJob> {
        let plate = self.lab.simulated_plate(self.desk.plate(), self.drive.snapshot())?;
        Some(TimeDomainJob { plate: Arc::clone(plate), ..drive.clone() })
    }
}
