//! The level that a table equalises: the peak per unit of DAC amplitude, for one wave speed or for several.
//!
//! An imperfect match of the drive end leaves a ripple of the peak along the plate, and an error of the wave speed
//! shifts that ripple. A table that cancels the ripple at the nominal speed can double it at another speed. So with a
//! tolerance each knot is levelled to the middle, in dB, of the lowest and the highest peak at all speeds within the
//! tolerance. The largest error is then the ripple itself, for every true speed. A tolerance of the loss is treated
//! alike: the middle halves the largest error at each knot, for every true loss.

use super::error::TableError;
use crate::definition::plate::Plate;
use crate::definition::sample_rate;
use crate::frequency::equation::Equation;
use crate::frequency::finger::{self, Finger};
use crate::frequency::numerov::{self, Grid};
use crate::frequency::peak::{self, Peak};
use crate::progress::{Progress, Stopped};
use crate::special::airy;
use num_complex::Complex64;

/// Number of wave speeds within the tolerance, the nominal one included; odd. On the presets, at 40 kHz, the phase of
/// the ripple changes by about pi over a tolerance of 1 %, so by about a tenth of a turn from speed to speed.
const SPEEDS: usize = 9;
/// Frequencies between two reports of progress.
const FREQUENCIES_AT_ONCE: usize = 64;

/// The plate's response at one frequency, per unit of DAC amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Peak amplitude per unit of DAC amplitude, in units of the full-scale displacement. Where there is no peak, the
    /// amplitude at the turning point over 0.6628.
    pub amplitude: f64,
    /// Whether there is a turning-point peak.
    pub peak_present: bool,
    /// Whether it is the largest amplitude on the plate.
    pub peak_largest: bool,
}

/// The gain from the DAC to the plate's peak, prepared for many frequencies of one plate.
#[derive(Debug)]
pub(crate) struct DriveToPeak {
    pub(super) plate: Plate,
    grid: Grid,
    step_m: f64,
    sample_rate_hz: f64,
}

impl DriveToPeak {
    pub(crate) fn new(plate: &Plate, sample_rate_hz: f64) -> Result<Self, TableError> {
        sample_rate::check(plate, sample_rate_hz)?;
        Ok(Self::unchecked(plate, sample_rate_hz))
    }

    pub(crate) fn plate(&self) -> &Plate {
        &self.plate
    }

    /// As [`DriveToPeak::new`], for a plate whose band may end slightly above the limit of the sample rate.
    pub(crate) fn unchecked(plate: &Plate, sample_rate_hz: f64) -> Self {
        let highest_hz = plate.band_hz().1;
        // An error of 1e-6 of the amplitude, 1e-5 dB, suffices: the grid is coarser than that of a response.
        let points = 257;
        let refinement = numerov::refinement(plate, highest_hz, plate.length_m() / 256.0).div_ceil(4).max(2);
        let grid = Grid::new(plate, Equation::Corrected, points, refinement);
        let step_m = plate.length_m() / (256 * refinement) as f64;
        Self { plate: plate.clone(), grid, step_m, sample_rate_hz }
    }

    /// Drive-to-peak gain at each frequency.
    pub(crate) fn levels(
        &self,
        frequencies_hz: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Level>, TableError> {
        self.each_level(frequencies_hz, progress)?.into_iter().collect()
    }

    /// Drive-to-peak gain at each frequency that has one.
    pub(super) fn each_level(
        &self,
        frequencies_hz: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Result<Level, TableError>>, Stopped> {
        let count = frequencies_hz.len();
        let mut levels = Vec::with_capacity(count);
        for part in frequencies_hz.chunks(FREQUENCIES_AT_ONCE) {
            progress.at(levels.len() as f64 / count as f64)?;
            numerov::solve_each(&self.grid, &self.plate, part, |number, field| {
                levels.push(self.level_of(part[number], field));
            });
        }
        Ok(levels)
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
        self.level_of(frequency_hz, &numerov::solve(&self.grid, &self.plate, frequency_hz))
    }

    fn level_of(&self, frequency_hz: f64, field: &[Complex64]) -> Result<Level, TableError> {
        let (on_plate, found) = peak_amplitude(&self.plate, field, self.step_m, frequency_hz);
        let amplitude = on_plate * self.before_the_plate(frequency_hz);
        if !(amplitude.is_finite() && amplitude > 0.0) {
            let position_m = self.plate.turning_point_m(frequency_hz).unwrap_or(0.0);
            return Err(TableError::Silent { position_m, frequency_hz });
        }
        let peak_largest = found.is_some_and(|peak| peak.is_largest);
        Ok(Level { amplitude, peak_present: found.is_some(), peak_largest })
    }

    /// Fraction of the amplitude that remains under a finger, see [`finger::share_left`].
    pub(crate) fn share_left(&self, finger: &Finger, frequency_hz: f64) -> Complex64 {
        finger::share_left(&self.grid, &self.plate, finger, frequency_hz)
    }

    /// Gain of the zero-order hold and of the chain from it to the driven end.
    fn before_the_plate(&self, frequency_hz: f64) -> f64 {
        let droop = sample_rate::hold_droop(frequency_hz, self.sample_rate_hz);
        droop * self.plate.drive_response(frequency_hz).norm()
    }
}

/// The amplitude that a table levels, for a field on points `step_m` apart: that of the turning-point peak, with
/// whether there is one; without a peak, the amplitude at the turning point over 0.6628.
pub(crate) fn peak_amplitude(
    plate: &Plate,
    field: &[Complex64],
    step_m: f64,
    frequency_hz: f64,
) -> (f64, Option<Peak>) {
    let turning_point_m = plate.turning_point_m(frequency_hz).unwrap_or(0.0);
    let kappa = plate.kappa_per_m(frequency_hz).unwrap_or(f64::NAN);
    let found = peak::find(field, step_m, turning_point_m, kappa);
    let amplitude = match found {
        Some(Peak { amplitude, .. }) => amplitude,
        None => {
            let at = turning_point_m.min(plate.length_m());
            peak::amplitude_at(field, step_m, at) * airy::PEAK_VALUE / airy::ai(0.0)
        }
    };
    (amplitude, found)
}

/// The plate at the other wave speeds and losses within its tolerances. Speeds that make the plate invalid are left out.
///
/// At each place the level is monotone in the loss, except for the ripple, which is largest at the lowest loss: so
/// every speed is also computed with the lowest and the highest loss.
///
/// Empty where the gain itself was measured: it does not depend on speed and loss.
pub(crate) fn other_plates(plate: &Plate) -> Vec<Plate> {
    if plate.spec().calibration.as_ref().is_some_and(|calibration| calibration.correction.is_some()) {
        return Vec::new();
    }
    let tolerance = plate.spec().wave_speed_tolerance;
    let half = if tolerance == 0.0 { 0 } else { SPEEDS / 2 };
    let speeds = (0..=2 * half).filter_map(|number| {
        // The nominal speed itself, without rounding.
        if number == half {
            return Some(plate.clone());
        }
        plate.with_wave_speed(1.0 + tolerance * (number as f64 / half as f64 - 1.0)).ok()
    });
    let lossy = |plate: Plate| match plate.spec().loss_tolerance {
        Some(tolerance) if tolerance > 0.0 => {
            let others = [(1.0 + tolerance).recip(), 1.0 + tolerance].map(|f| plate.with_loss(f).ok());
            std::iter::once(plate).chain(others.into_iter().flatten()).collect()
        }
        _ => vec![plate],
    };
    speeds.flat_map(lossy).filter(|other| other != plate).collect()
}

pub(super) fn drives_to_peak(plates: &[Plate], sample_rate_hz: f64) -> Vec<DriveToPeak> {
    plates.iter().map(|plate| DriveToPeak::unchecked(plate, sample_rate_hz)).collect()
}

/// The [`middles`] of the nominal plate and the `others` at each frequency.
pub(super) fn mid_levels(
    nominal: &DriveToPeak,
    others: &[DriveToPeak],
    frequencies_hz: &[f64],
    progress: &mut Progress<'_>,
) -> Result<Vec<Level>, TableError> {
    let plates = 1.0 + others.len() as f64;
    let levels = nominal.levels(frequencies_hz, &mut progress.part(0.0, 1.0 / plates))?;
    let of_others = others.iter().enumerate().map(|(number, drive_to_peak)| {
        let done = 1.0 + number as f64;
        drive_to_peak.levels(frequencies_hz, &mut progress.part(done / plates, (done + 1.0) / plates))
    });
    let of_others: Vec<Vec<Level>> = of_others.collect::<Result<_, _>>()?;
    Ok(middles(&levels, &of_others))
}

/// The nominal plate's `levels`, each replaced by the middle, in dB, of the lowest and the highest level of all plates.
pub(crate) fn middles(levels: &[Level], of_others: &[Vec<Level>]) -> Vec<Level> {
    let middle = |(number, level): (usize, &Level)| {
        let others = of_others.iter().map(|levels| levels[number].amplitude);
        let (low, high) = others
            .fold((level.amplitude, level.amplitude), |(low, high), other| (low.min(other), high.max(other)));
        Level { amplitude: (low * high).sqrt(), ..*level }
    };
    levels.iter().enumerate().map(middle).collect()
}
