//! Levels on the plate at the table's frequencies, and their change where the plate differs from its file.

use super::error::CheckError;
use super::thresholds::LOSS_TOLERANCE;
use crate::definition::plate::Plate;
use crate::frequency::Finger;
use crate::frequency::driven_end::{drive_rise, with_whole_end};
use crate::frequency::medium::LANES;
use crate::progress::Progress;
use crate::quantity::decibels;
use crate::table::TableError;
use crate::table::level::{DriveToPeak, Level, middles, other_plates};
use num_complex::Complex64;

/// Number of boundaries computed together: the lanes of the solver.
pub(super) const AT_ONCE: usize = LANES;

/// The plate of the file and the other plates that the checks compute, each with its grid.
#[derive(Debug)]
pub(super) struct Variants {
    /// The plate of the file.
    nominal: DriveToPeak,
    /// The plates over which the table is levelled, followed by the other plates of the fields below.
    others: Vec<DriveToPeak>,
    /// Number of the others over which the table is levelled.
    levelled: usize,
    /// The plate with the near field of its end, if the file leaves it out.
    whole: Option<Whole>,
    /// Indices in `others`: wave speed 1 % and 0.5 % lower and higher.
    detuned: Vec<usize>,
    /// Indices in `others`: the lowest and the highest loss within the tolerance.
    lossy: Vec<usize>,
    /// Indices in `others` for a calibrated plate: the ends of its intervals of wave speed and loss, and the speeds
    /// between.
    calibrated: Option<Vec<usize>>,
}

/// A plate in bending with the near field at its end, which the file leaves out.
#[derive(Debug, Clone, Copy)]
struct Whole {
    /// Its index in `others`.
    plate: usize,
    /// Its level over that of the file's plate, mean over the span, dB: one measurement of the level removes this
    /// factor.
    above_db: f64,
}

/// Levels at one boundary.
#[derive(Debug, Clone, Copy)]
pub(super) struct SiteLevels {
    /// Level of the file's plate, per unit of DAC amplitude.
    pub(super) nominal: f64,
    /// Largest difference of the peak from the table's level, less the mean factor over the span, where the end has
    /// the near field that the file leaves out, dB. 0 for a file that states both conditions of its end.
    pub(super) by_end_db: f64,
    /// The same for a wave speed 1 % off, dB.
    pub(super) by_speed_db: f64,
    /// The same for a loss off by its tolerance, dB.
    pub(super) by_loss_db: f64,
    /// Rise of the peak for a wave speed off by up to 1 %, dB; 0 or more.
    pub(super) rise_db: f64,
    /// Whether the peak is the largest amplitude on the plate, with the near field of its end and at all these
    /// speeds; on a calibrated plate, over its intervals instead.
    pub(super) peak_largest: bool,
    /// Levels over the intervals of a calibrated plate; `None` for an uncalibrated one.
    pub(super) calibrated: Option<Calibrated>,
}

/// Levels over the intervals of a calibrated plate, at one boundary.
#[derive(Debug, Clone, Copy)]
pub(super) struct Calibrated {
    /// Largest difference of the peak from the table's level, dB.
    pub(super) off_db: f64,
    /// Whether every plate has a peak.
    pub(super) peak_present: bool,
}

impl SiteLevels {
    /// Largest difference of the peak of a calibrated plate from the table's level, dB: as measured, or over the
    /// intervals of wave speed and loss where no levels were measured. `None` for an uncalibrated plate.
    pub(super) fn open_db(&self, plate: &Plate) -> Option<f64> {
        let measured = plate.spec().calibration.as_ref()?.level_tolerance_db;
        measured.or(self.calibrated.map(|levels| levels.off_db))
    }
}

impl Variants {
    pub(super) fn new(plate: &Plate, sample_rate_hz: f64) -> Result<Self, TableError> {
        let nominal = DriveToPeak::new(plate, sample_rate_hz)?;
        let mut plates = other_plates(plate);
        let levelled = plates.len();
        let mut number_of = |other: Plate| {
            let known = plates.iter().position(|plate| plate.spec() == other.spec());
            known.unwrap_or_else(|| {
                plates.push(other);
                plates.len() - 1
            })
        };
        let whole_plate = with_whole_end(plate);
        let whole = whole_plate.clone().map(&mut number_of);
        // At the limits of a model's fields some of these speeds are out of range.
        let real = whole_plate.as_ref().unwrap_or(plate);
        let speeds =
            [0.99, 0.995, 1.005, 1.01].into_iter().filter_map(|factor| real.with_wave_speed(factor).ok());
        let detuned = speeds.map(&mut number_of).collect();
        let loss = 1.0 + plate.spec().loss_tolerance.unwrap_or(LOSS_TOLERANCE);
        let losses = [loss.recip(), loss].into_iter().filter_map(|factor| real.with_loss(factor).ok());
        let lossy = losses.map(&mut number_of).collect();
        let calibrated = plate.spec().calibration.as_ref().map(|_| {
            let tolerance = plate.spec().wave_speed_tolerance;
            let speeds = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|way| 1.0 + way * tolerance);
            let speeds = speeds.into_iter().filter_map(|factor| real.with_wave_speed(factor).ok());
            let losses = |plate: Plate| {
                let others = [loss.recip(), loss].map(|factor| plate.with_loss(factor).ok());
                std::iter::once(plate).chain(others.into_iter().flatten())
            };
            let plates = speeds.flat_map(losses).filter(|other| other.spec() != plate.spec());
            let mut numbers: Vec<usize> = plates.map(&mut number_of).collect();
            numbers.sort_unstable();
            numbers.dedup();
            numbers
        });
        // The band of another plate may end a little above the limit of the sample rate; the boundaries' frequencies
        // do not.
        let others: Vec<_> =
            plates.iter().map(|plate| DriveToPeak::unchecked(plate, sample_rate_hz)).collect();
        let whole = whole.map(|plate| Whole { plate, above_db: 0.0 });
        Ok(Self { nominal, others, levelled, whole, detuned, lossy, calibrated })
    }

    /// The levels of the file's plate at the frequencies of the whole span. They also give the mean factor in
    /// [`SiteLevels`] of a plate with the near field.
    pub(super) fn of_span(
        &mut self,
        frequencies_hz: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Level>, CheckError> {
        let mut levels = Vec::with_capacity(frequencies_hz.len());
        let mut sum_db = 0.0;
        for group in frequencies_hz.chunks(AT_ONCE) {
            progress.at(levels.len() as f64 / frequencies_hz.len() as f64)?;
            let nominal = at(&self.nominal, group)?;
            if let Some(whole) = &self.whole {
                let ratio = at(&self.others[whole.plate], group)?.into_iter().zip(&nominal).zip(group);
                sum_db += ratio
                    .map(|((real, stated), &hz)| decibels(self.rise(hz) * real.amplitude / stated.amplitude))
                    .sum::<f64>();
            }
            levels.extend(nominal);
        }
        if let Some(whole) = &mut self.whole {
            whole.above_db = sum_db / frequencies_hz.len() as f64;
        }
        Ok(levels)
    }

    /// The levels of all plates at each frequency.
    pub(super) fn levels(&self, frequencies_hz: &[f64]) -> Result<Vec<SiteLevels>, TableError> {
        let nominal = at(&self.nominal, frequencies_hz)?;
        let of_others: Vec<Vec<Level>> =
            self.others.iter().map(|plate| at(plate, frequencies_hz)).collect::<Result<_, _>>()?;
        let intended = middles(&nominal, &of_others[..self.levelled]);
        let above_db = self.whole.map_or(0.0, |whole| whole.above_db);
        let worst_db = |plates: &[usize], number: usize, hz: f64| {
            let apart = |&plate: &usize| {
                let ratio = self.rise(hz) * of_others[plate][number].amplitude / intended[number].amplitude;
                (decibels(ratio) - above_db).abs()
            };
            plates.iter().map(apart).fold(0.0, f64::max)
        };
        let whole: Vec<usize> = self.whole.iter().map(|whole| whole.plate).collect();
        let within = self.calibrated.as_ref().unwrap_or(&self.detuned);
        let of_site = |(number, (level, &hz)): (usize, (&Level, &f64))| {
            let at_site = |&plate: &usize| of_others[plate][number];
            let real = self.whole.map_or(level.amplitude, |whole| at_site(&whole.plate).amplitude);
            let others = within.iter().map(|plate| at_site(plate).amplitude);
            SiteLevels {
                nominal: level.amplitude,
                rise_db: decibels(others.fold(real, f64::max) / real),
                peak_largest: level.peak_largest
                    && whole.iter().chain(within).all(|plate| at_site(plate).peak_largest),
                by_end_db: worst_db(&whole, number, hz),
                by_speed_db: worst_db(&self.detuned, number, hz),
                by_loss_db: worst_db(&self.lossy, number, hz),
                calibrated: self.calibrated.as_ref().map(|plates| Calibrated {
                    off_db: worst_db(plates, number, hz),
                    peak_present: plates.iter().all(|plate| at_site(plate).peak_present),
                }),
            }
        };
        Ok(nominal.iter().zip(frequencies_hz).enumerate().map(of_site).collect())
    }

    /// Fraction of the amplitude that remains under a finger.
    pub(super) fn share_left(&self, finger: &Finger, frequency_hz: f64) -> Complex64 {
        let real = self.whole.map_or(&self.nominal, |whole| &self.others[whole.plate]);
        real.share_left(finger, frequency_hz)
    }

    /// Drive of the file's end over the drive of the end with its near field.
    fn rise(&self, frequency_hz: f64) -> f64 {
        if self.whole.is_some() { drive_rise(self.nominal.plate(), frequency_hz) } else { 1.0 }
    }
}

fn at(plate: &DriveToPeak, frequencies_hz: &[f64]) -> Result<Vec<Level>, TableError> {
    plate.levels(frequencies_hz, &mut Progress::unwatched())
}
