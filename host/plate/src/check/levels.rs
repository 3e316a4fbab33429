//! The levels that the table would make equal on the plate, and what becomes of them where the plate is not quite the
//! file's.

use super::thresholds::LOSS_TOLERANCE;
use crate::progress::Progress;
use crate::spec::plate::Plate;
use crate::table::TableError;
use crate::table::level::{DriveToPeak, Level, middles, other_plates};

/// The plate and everything that it may be instead, each with its grid.
#[derive(Debug)]
pub(super) struct Variants {
    /// The plate itself.
    nominal: DriveToPeak,
    /// The plates over which the table is levelled, then those of the lists below that are not among them.
    others: Vec<DriveToPeak>,
    /// How many of the others the table is levelled over.
    levelled: usize,
    /// Of the others: those with a wave speed 1 % and 0.5 % lower and higher.
    detuned: Vec<usize>,
    /// Of the others: those with the lowest and the highest loss that the plate may have.
    lossy: Vec<usize>,
}

/// Levels at one frequency, per unit of DAC amplitude.
#[derive(Debug, Clone, Copy)]
pub(super) struct SiteLevels {
    /// That of the plate itself.
    pub(super) nominal: f64,
    /// How far the peak may be from the table's level where the wave speed is off by 1 %, dB.
    pub(super) by_speed_db: f64,
    /// The same where the loss is off by its tolerance, dB.
    pub(super) by_loss_db: f64,
}

impl Variants {
    pub(super) fn new(plate: &Plate, sample_rate_hz: f64) -> Result<Self, TableError> {
        let mut plates = other_plates(plate);
        let levelled = plates.len();
        let mut place_of = |other: Plate| {
            let known = plates.iter().position(|plate| plate.spec() == other.spec());
            known.unwrap_or_else(|| {
                plates.push(other);
                plates.len() - 1
            })
        };
        // At the end of a material's allowed range some of these speeds are not allowed.
        let speeds =
            [0.99, 0.995, 1.005, 1.01].into_iter().filter_map(|factor| plate.with_wave_speed(factor).ok());
        let detuned = speeds.map(&mut place_of).collect();
        let loss = 1.0 + plate.spec().loss_tolerance.unwrap_or(LOSS_TOLERANCE);
        let losses = [loss.recip(), loss].into_iter().filter_map(|factor| plate.with_loss(factor).ok());
        let lossy = losses.map(&mut place_of).collect();
        // The band of another plate may end a little above what the sample rate carries; the boundaries' frequencies
        // do not.
        let others = plates.iter().map(|plate| DriveToPeak::unchecked(plate, sample_rate_hz)).collect();
        Ok(Self { nominal: DriveToPeak::new(plate, sample_rate_hz)?, others, levelled, detuned, lossy })
    }

    /// The plate's own levels.
    pub(super) fn nominal(&self, frequencies_hz: &[f64]) -> Result<Vec<Level>, TableError> {
        self.nominal.levels(frequencies_hz, &mut Progress::new(&mut |_| true))
    }

    /// The levels of all plates at each frequency.
    pub(super) fn levels(&self, frequencies_hz: &[f64]) -> Result<Vec<SiteLevels>, TableError> {
        let nominal = self.nominal(frequencies_hz)?;
        let of_others: Vec<Vec<Level>> = self
            .others
            .iter()
            .map(|plate| plate.levels(frequencies_hz, &mut Progress::new(&mut |_| true)))
            .collect::<Result<_, _>>()?;
        let intended = middles(&nominal, &of_others[..self.levelled]);
        let worst_db = |plates: &[usize], number: usize| {
            let apart = |&plate: &usize| {
                let ratio = of_others[plate][number].amplitude / intended[number].amplitude;
                (20.0 * ratio.log10()).abs()
            };
            plates.iter().map(apart).fold(0.0, f64::max)
        };
        let at = |(number, level): (usize, &Level)| SiteLevels {
            nominal: level.amplitude,
            by_speed_db: worst_db(&self.detuned, number),
            by_loss_db: worst_db(&self.lossy, number),
        };
        Ok(nominal.iter().enumerate().map(at).collect())
    }
}
