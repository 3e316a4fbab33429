//! Shift of the peak caused by the air's added mass.

use super::air::{Air, AirLoad};
use super::free_wave::FreeWave;
use super::plate::Plate;
use crate::special::airy;

impl Plate {
    /// How much farther from the drive `air` puts the peak of the frequency that turns at `boundary_m` in a vacuum, metres: the
    /// peaks of the Airy form. 0 on a plate whose mass per area the file does not state.
    pub(crate) fn air_shift_m(&self, air: Option<&Air>, boundary_m: f64) -> f64 {
        let model = &self.spec().model;
        let width_mode = self.width_mode(1);
        let still = FreeWave { model, load: None };
        let loaded = FreeWave { model, load: AirLoad::of(air, model) };
        let turning = width_mode.number / self.turning_at(boundary_m).0.exp();
        let omega = still.angular_frequency(turning * turning);
        let peak_m = |wave: FreeWave<'_>| {
            let x0 = width_mode.place_of(wave.wavenumber_squared(omega).sqrt());
            let share = wave.along(omega).map_or(1.0, |air| air.fall_share());
            x0 - airy::PEAK_OFFSET / (width_mode.fall(x0) * share).cbrt()
        };
        peak_m(loaded) - peak_m(still)
    }
}
