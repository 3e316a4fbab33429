//! The actual plate beside the predicting one: the simulated device's plate, or the measurements of a real one.

use super::{Screen, Sight};
use slipline_model::field::time_domain::TimeDomainJob;
use slipline_model::jobs::measured_places::MeasuredPlacesJob;
use std::sync::Arc;

impl Screen {
    /// Compares what was measured of a real plate with the plate on the screen.
    pub(super) fn compare_actual_plate(&mut self, sight: Sight<'_>) {
        self.measured_places.take();
        let snapshot = sight.drive.snapshot();
        let is_real = snapshot.is_connected() && !snapshot.is_simulated();
        let measurements = sight.lab.drawn().filter(|_| is_real).cloned().collect();
        self.measured_places.ask(MeasuredPlacesJob { plate: Arc::clone(sight.desk.plate()), measurements });
    }
}

impl Sight<'_> {
    /// This drive on the plate under the simulated device, if that plate is known.
    pub(super) fn simulated_drive(&self, drive: &TimeDomainJob) -> Option<TimeDomainJob> {
        let plate = self.lab.simulated_plate(self.desk.plate(), self.drive.snapshot())?;
        Some(TimeDomainJob { plate: Arc::clone(plate), ..drive.clone() })
    }
}
