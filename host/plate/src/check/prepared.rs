//! A plate with everything that the lights need and that does not depend on the boundary, computed once.

use super::conditions::Conditions;
use super::error::CheckError;
use super::thresholds::LOSS_TOLERANCE;
use crate::progress::Progress;
use crate::spec::actuator::Actuator;
use crate::spec::plate::Plate;
use crate::table::level::{DriveToPeak, other_plates};
use crate::table::travel;

/// Number of boundaries over the span that [`super::Checker::over_span`] checks.
pub const SPAN_PLACES: usize = 41;

/// The plate, its conditions and what follows from both for every boundary.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) plate: Plate,
    pub(super) conditions: Conditions,
    /// The plate with a wave speed 1 % and 0.5 % lower and higher.
    pub(super) detuned: Vec<Plate>,
    /// The plate with the lowest and the highest loss that it may have.
    pub(super) lossy: Vec<Plate>,
    /// The plate at the other wave speeds and losses within its tolerances, over which its table is levelled.
    pub(super) others: Vec<Plate>,
    /// Lowest gain from the DAC to the peak over the span: the level that a table can reach everywhere.
    pub(super) lowest_gain: f64,
    /// What the actuator's peak travel leaves of that level.
    pub(super) travel_scale: f64,
}

impl Prepared {
    pub(super) fn new(
        plate: &Plate,
        conditions: Conditions,
        progress: &mut Progress<'_>,
    ) -> Result<Self, CheckError> {
        conditions.validate(plate)?;
        let drive_to_peak = DriveToPeak::new(plate, conditions.sample_rate_hz)?;
        let mut lowest_gain = f64::INFINITY;
        // The travel per unit of peak.
        let mut largest_share: f64 = 0.0;
        let resonator = plate.spec().actuator.as_ref().and_then(Actuator::resonator);
        let count = 2 * SPAN_PLACES - 1;
        for (number, x) in places(plate, count).enumerate() {
            progress.at(number as f64 / count as f64)?;
            let frequency_hz = plate.frequency_for_boundary_hz(x);
            let gain = drive_to_peak.level(frequency_hz)?.amplitude;
            lowest_gain = lowest_gain.min(gain);
            let share = resonator.and_then(|resonator| resonator.travel_share(frequency_hz));
            largest_share = largest_share.max(share.unwrap_or(0.0) / gain);
        }
        // At the end of a material's allowed range some of these speeds are not allowed.
        let detuned =
            [0.99, 0.995, 1.005, 1.01].iter().filter_map(|&f| plate.with_wave_speed(f).ok()).collect();
        let loss_factor = 1.0 + plate.spec().loss_tolerance.unwrap_or(LOSS_TOLERANCE);
        Ok(Self {
            plate: plate.clone(),
            conditions,
            detuned,
            lossy: [loss_factor.recip(), loss_factor]
                .iter()
                .filter_map(|&f| plate.with_loss(f).ok())
                .collect(),
            others: other_plates(plate),
            lowest_gain,
            travel_scale: travel::scale(lowest_gain * largest_share),
        })
    }

    /// As [`super::Checker::peak_m`].
    pub(super) fn peak_m(&self) -> f64 {
        self.conditions.level * self.lowest_gain * self.travel_scale * self.plate.spec().full_scale_m
    }
}

/// `count` boundaries, uniform over the span with both ends included, metres.
pub(super) fn places(plate: &Plate, count: usize) -> impl Iterator<Item = f64> {
    let (start, end) = plate.span_m();
    (0..count).map(move |i| start + (end - start) * i as f64 / (count - 1) as f64)
}
