//! The actual plate beside the predicting one: the simulated device's plate, or the measurements of a real one.

use super::Sight;
use crate::instrument::work::Jobs;
use slipline_model::field::time_domain::TimeDomainJob;
use slipline_model::jobs::LatestResult;
use slipline_model::jobs::measured_places::{MeasuredPlace, MeasuredPlacesJob};
use std::mem::take;
use std::sync::Arc;

/// What was measured of a real plate.
pub(super) struct ActualPlate(LatestResult<MeasuredPlacesJob, Vec<MeasuredPlace>>);

impl ActualPlate {
    pub(super) fn new(jobs: &mut Jobs) -> Self {
        Self(LatestResult::of(take(&mut jobs.measured_places)))
    }

    /// The places at which it was measured.
    pub(super) fn places(&self) -> &[MeasuredPlace] {
        self.0.current().map_or(&[], Vec::as_slice)
    }

    /// Compares what was measured of a real plate with the plate on the screen.
    pub(super) fn compare(&mut self, sight: Sight<'_>) {
        self.0.take();
        let snapshot = sight.drive.snapshot();
        let is_real = snapshot.is_connected() && !snapshot.is_simulated();
        let measurements = sight.lab.drawn().filter(|_| is_real).cloned().collect();
        self.0.ask(MeasuredPlacesJob { plate: Arc::clone(sight.desk.plate()), measurements });
    }
}

impl Sight<'_> {
    /// This drive on the plate under the simulated device, if that plate is known.
    pub(super) fn simulated_drive(&self, drive: &TimeDomainJob) -> Option<TimeDomainJob> {
        let plate = self.lab.simulated_plate(self.desk.plate(), self.drive.snapshot())?;
        Some(TimeDomainJob { plate: Arc::clone(plate), ..drive.clone() })
    }
}
