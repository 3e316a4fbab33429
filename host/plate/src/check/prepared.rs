//! A plate with what the lights need of it, computed once.

use super::conditions::Conditions;
use super::error::CheckError;
use crate::progress::Progress;
use crate::spec::plate::Plate;
use crate::table::level::{DriveToPeak, other_speeds};

/// Places over the span that [`super::Checker::over_span`] looks at.
pub const SPAN_PLACES: usize = 41;

/// What every light may ask of the plate and its conditions.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) plate: Plate,
    pub(super) conditions: Conditions,
    /// The plate with its waves 1 %, 0.5 % slower and faster.
    pub(super) detuned: Vec<Plate>,
    /// The plate at the other speeds that its table is levelled over.
    pub(super) speeds: Vec<Plate>,
    /// Lowest drive-to-peak gain over the span: what a table can keep everywhere.
    lowest_gain: f64,
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
        let count = 2 * SPAN_PLACES - 1;
        for (number, x) in places(plate, count).enumerate() {
            progress.at(number as f64 / count as f64)?;
            lowest_gain = lowest_gain.min(drive_to_peak.level(plate.frequency_for_boundary_hz(x))?.amplitude);
        }
        // A material at the very end of its allowed range has neighbours on one side only.
        let detuned =
            [0.99, 0.995, 1.005, 1.01].iter().filter_map(|&f| plate.with_wave_speed(f).ok()).collect();
        Ok(Self { plate: plate.clone(), conditions, detuned, speeds: other_speeds(plate), lowest_gain })
    }

    /// As [`super::Checker::peak_m`].
    pub(super) fn peak_m(&self) -> f64 {
        self.conditions.level * self.lowest_gain * self.plate.spec().full_scale_m
    }
}

/// Places of the span, both ends included, evenly spread.
pub(super) fn places(plate: &Plate, count: usize) -> impl Iterator<Item = f64> {
    let (start, end) = plate.span_m();
    (0..count).map(move |i| start + (end - start) * i as f64 / (count - 1) as f64)
}
