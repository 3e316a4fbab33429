//! A plate with all inputs of the lights that do not depend on the boundary, computed once.

use super::air_law::AirLaw;
use super::conditions::Conditions;
use super::error::CheckError;
use super::levels::Variants;
use crate::definition::actuator::Actuator;
use crate::definition::plate::Plate;
use crate::progress::Progress;
use crate::table::travel;

/// Number of boundaries over the span that [`super::Checker::over_span`] checks.
pub(crate) const SPAN_PLACES: usize = 41;

/// The plate, its conditions, and the quantities that they determine for every boundary.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) plate: Plate,
    pub(super) conditions: Conditions,
    /// The plate of the file and the plates that differ from it.
    pub(super) variants: Variants,
    /// Lowest gain from the DAC to the peak over the span: the level that a table can reach everywhere.
    pub(super) lowest_gain: f64,
    /// Factor on that level by the actuator's travel limit.
    pub(super) travel_scale: f64,
    /// The error of the law of the air, of a light membrane in a baffle.
    pub(super) air_law: Option<AirLaw>,
}

impl Prepared {
    pub(super) fn new(
        plate: &Plate,
        conditions: Conditions,
        progress: &mut Progress<'_>,
    ) -> Result<Self, CheckError> {
        conditions.validate(plate)?;
        let mut variants = Variants::new(plate, conditions.sample_rate_hz)?;
        let mut lowest_gain = f64::INFINITY;
        // Largest travel per unit of peak amplitude.
        let mut largest_share: f64 = 0.0;
        let resonator = plate.spec().actuator.as_ref().and_then(Actuator::resonator);
        let frequencies_hz: Vec<f64> =
            plate.over_span_m(2 * SPAN_PLACES - 1).map(|x| plate.frequency_for_boundary_hz(x)).collect();
        for (&frequency_hz, level) in frequencies_hz.iter().zip(variants.of_span(&frequencies_hz, progress)?)
        {
            let gain = level.amplitude;
            lowest_gain = lowest_gain.min(gain);
            let share = resonator.and_then(|resonator| resonator.travel_share(frequency_hz));
            largest_share = largest_share.max(share.unwrap_or(0.0) / gain);
        }
        Ok(Self {
            plate: plate.clone(),
            conditions,
            variants,
            lowest_gain,
            travel_scale: travel::scale(lowest_gain * largest_share),
            air_law: AirLaw::of(plate),
        })
    }

    /// As [`super::Checker::peak_m`].
    pub(super) fn peak_m(&self) -> f64 {
        self.conditions.level * self.lowest_gain * self.travel_scale * self.plate.spec().full_scale_m
    }
}
