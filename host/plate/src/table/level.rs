//! The level that a table makes equal: the peak per unit of DAC amplitude, at one wave speed or mid_levels several.
//!
//! A wave speed that is known to a tolerance only shifts the ripple of an imperfect match along the plate. A table
//! that undoes the ripple where it is supposed to be doubles it where it is not. So with a tolerance the gain at each
//! knot lies in the middle, in dB, between the lowest and the highest peak of all speeds within it: the worst
//! departure is then the ripple itself, whatever the true speed.

use super::error::TableError;
use crate::frequency::equation::Equation;
use crate::frequency::numerov::{self, Grid};
use crate::frequency::peak::{self, Peak};
use crate::progress::Progress;
use crate::spec::plate::Plate;
use crate::spec::sample_rate;
use crate::special::airy;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Wave speeds over a tolerance at which the levels are computed, the nominal one among them; odd. At 1 % and 40 kHz
/// on the plates at hand the ripple turns by about pi over the tolerance: a tenth of a turn from speed to speed.
const SPEEDS: usize = 9;
/// Frequencies between two looks at whether the table is still wanted.
const FREQUENCIES_AT_ONCE: usize = 64;

/// The peak a drive makes: how high per unit of DAC amplitude, and whether it is a peak at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Peak amplitude per unit of DAC amplitude (of full-scale displacement); where there is no peak, the amplitude
    /// at the turning point over 0.6628.
    pub amplitude: f64,
    /// Whether there is a turning-point peak.
    pub peak_present: bool,
}

/// Everything between the DAC and the plate's peak, prepared for many frequencies of one plate.
pub(crate) struct DriveToPeak<'a> {
    pub(super) plate: &'a Plate,
    grid: Grid,
    step_m: f64,
    sample_rate_hz: f64,
}

impl<'a> DriveToPeak<'a> {
    pub(crate) fn new(plate: &'a Plate, sample_rate_hz: f64) -> Result<Self, TableError> {
        sample_rate::check(plate, sample_rate_hz)?;
        Ok(Self::unchecked(plate, sample_rate_hz))
    }

    /// The same for a plate whose band may end a little above what the rate carries.
    pub(crate) fn unchecked(plate: &'a Plate, sample_rate_hz: f64) -> Self {
        let highest_hz = plate.band_hz().1;
        // 1e-6 of the amplitude is 1e-5 dB: a coarser grid than a response needs.
        let points = 257;
        let refinement = numerov::refinement(plate, highest_hz, plate.length_m() / 256.0).div_ceil(4).max(2);
        let grid = Grid::new(plate, 1, Equation::Corrected, points, refinement);
        let step_m = plate.length_m() / (256 * refinement) as f64;
        Self { plate, grid, step_m, sample_rate_hz }
    }

    /// Drive-to-peak gain at each frequency.
    pub(crate) fn levels(
        &self,
        frequencies_hz: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Level>, TableError> {
        let count = frequencies_hz.len();
        let mut levels = Vec::with_capacity(count);
        for part in frequencies_hz.chunks(FREQUENCIES_AT_ONCE) {
            progress.at(levels.len() as f64 / count as f64)?;
            numerov::solve_each(&self.grid, self.plate, part, |number, field| {
                levels.push(self.level_of(part[number], field));
            });
        }
        levels.into_iter().collect()
    }

    pub(super) fn levels_at(
        &self,
        places_m: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Level>, TableError> {
        let frequencies: Vec<f64> =
            places_m.iter().map(|&x| self.plate.frequency_for_boundary_hz(x)).collect();
        self.levels(&frequencies, progress)
    }

    pub(crate) fn level(&self, frequency_hz: f64) -> Result<Level, TableError> {
        self.level_of(frequency_hz, &numerov::solve(&self.grid, self.plate, frequency_hz))
    }

    fn level_of(&self, frequency_hz: f64, field: &[Complex64]) -> Result<Level, TableError> {
        let turning_point_m = self.plate.turning_point_m(frequency_hz).unwrap_or(0.0);
        let kappa = self.plate.kappa_per_m(frequency_hz).unwrap_or(f64::NAN);
        let found = peak::find(field, self.step_m, turning_point_m, kappa);
        let on_plate = match found {
            Some(Peak { amplitude, .. }) => amplitude,
            None => {
                let at = turning_point_m.min(self.plate.length_m());
                peak::amplitude_at(field, self.step_m, at) * airy::PEAK_VALUE / airy::ai(0.0)
            }
        };
        let amplitude = on_plate * self.before_the_plate(frequency_hz);
        if !(amplitude.is_finite() && amplitude > 0.0) {
            return Err(TableError::Silent { position_m: turning_point_m, frequency_hz });
        }
        Ok(Level { amplitude, peak_present: found.is_some() })
    }

    /// Zero-order hold and actuator.
    fn before_the_plate(&self, frequency_hz: f64) -> f64 {
        let turn = PI * frequency_hz / self.sample_rate_hz;
        let droop = turn.sin() / turn;
        droop * self.plate.spec().actuator.map_or(1.0, |actuator| actuator.response(frequency_hz).norm())
    }
}

/// The peak amplitude that a table for `plate` levels at one frequency, per unit of DAC amplitude; `others` are its
/// [`other_speeds`].
pub(crate) fn levelled_amplitude(
    plate: &Plate,
    others: &[Plate],
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> Result<f64, TableError> {
    let drive_to_peak = DriveToPeak::new(plate, sample_rate_hz)?;
    let others = drives_to_peak(others, sample_rate_hz);
    let levels = mid_levels(&drive_to_peak, &others, &[frequency_hz], &mut Progress::new(&mut |_| true))?;
    Ok(levels[0].amplitude)
}

/// The plate at other wave speeds within its tolerance; a speed at which it is no valid plate is left out.
pub(crate) fn other_speeds(plate: &Plate) -> Vec<Plate> {
    let tolerance = plate.spec().wave_speed_tolerance;
    if tolerance == 0.0 {
        return Vec::new();
    }
    let half = (SPEEDS / 2) as f64;
    (0..SPEEDS)
        .filter(|&number| number != SPEEDS / 2)
        .filter_map(|number| plate.with_wave_speed(1.0 + tolerance * (number as f64 / half - 1.0)).ok())
        .collect()
}

pub(super) fn drives_to_peak(plates: &[Plate], sample_rate_hz: f64) -> Vec<DriveToPeak<'_>> {
    plates.iter().map(|plate| DriveToPeak::unchecked(plate, sample_rate_hz)).collect()
}

/// The nominal plate's levels, each moved to the middle, in dB, of the lowest and the highest that all plates give.
pub(super) fn mid_levels(
    nominal: &DriveToPeak<'_>,
    others: &[DriveToPeak<'_>],
    frequencies_hz: &[f64],
    progress: &mut Progress<'_>,
) -> Result<Vec<Level>, TableError> {
    let speeds = 1.0 + others.len() as f64;
    let levels = nominal.levels(frequencies_hz, &mut progress.part(0.0, 1.0 / speeds))?;
    let mut ranges: Vec<_> = levels.iter().map(|level| (level.amplitude, level.amplitude)).collect();
    for (number, drive_to_peak) in others.iter().enumerate() {
        let done = 1.0 + number as f64;
        let part = &mut progress.part(done / speeds, (done + 1.0) / speeds);
        for ((low, high), other) in ranges.iter_mut().zip(drive_to_peak.levels(frequencies_hz, part)?) {
            *low = low.min(other.amplitude);
            *high = high.max(other.amplitude);
        }
    }
    let middle =
        |(level, (low, high)): (Level, (f64, f64))| Level { amplitude: (low * high).sqrt(), ..level };
    Ok(levels.into_iter().zip(ranges).map(middle).collect())
}
