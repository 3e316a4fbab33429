//! The actual plate beside the predicting one: the simulated device's plate, or the measurements of a real one.

use super::Instrument;
use slipline_model::field::time_domain::TimeDomainJob;
use slipline_model::jobs::measured_places::{MeasuredPlaces, MeasuredPlacesJob};
use slipline_plate::Plate;
use std::sync::Arc;

/// What was measured of a real plate.
#[derive(Default)]
pub(crate) struct Measured {
    asked: Option<MeasuredPlacesJob>,
    latest: Option<MeasuredPlaces>,
}

impl Measured {
    /// The result for the latest job.
    pub(crate) fn current(&self) -> Option<&MeasuredPlaces> {
        self.latest.as_ref().filter(|latest| Some(&latest.job) == self.asked.as_ref())
    }
}

impl Instrument {
    /// The plate under the simulated device; `None` while it is an unknown one that was not measured.
    fn simulated_plate(&self) -> Option<&Arc<Plate>> {
        match self.live.rig.truth().filter(|_| self.is_at_bench()) {
            None => Some(&self.setup.plate),
            Some((truth, is_measured)) => is_measured.then_some(truth),
        }
    }

    /// This drive on the plate under the simulated device.
    pub(crate) fn simulated_drive(&self, drive: &TimeDomainJob) -> Option<TimeDomainJob> {
        let identity = self.snapshot.identity.as_ref().filter(|identity| identity.simulated);
        identity
            .and_then(|_| Some(TimeDomainJob { plate: Arc::clone(self.simulated_plate()?), ..drive.clone() }))
    }

    /// Runs the present drive again, because another plate is under the simulated device, or is known now.
    pub(crate) fn simulate_again(&mut self) {
        self.jobs.time_domain.cancel();
        self.playback.measured = None;
        let drive = self.background.driven.as_ref().and_then(|drive| self.simulated_drive(drive));
        self.playback.unmeasured = drive.filter(|_| self.sounding_on_screen().is_some());
    }

    /// Compares what was measured of a real plate with the plate on the screen.
    pub(crate) fn update_places(&mut self) {
        if let Some(found) = self.jobs.measured_places.take() {
            self.measured.latest = Some(found);
        }
        let is_real = self.snapshot.is_connected() && !self.snapshot.is_simulated();
        let (plate, measurements) = (&self.setup.plate, || self.measures.shown().filter(|_| is_real));
        if self.measured.asked.as_ref().is_none_or(|asked| !asked.is_of(plate, measurements())) {
            let job = MeasuredPlacesJob {
                plate: Arc::clone(plate),
                measurements: measurements().cloned().collect(),
            };
            self.measured.asked = Some(job.clone());
            self.jobs.measured_places.ask(job);
        }
    }
}
