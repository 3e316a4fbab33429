//! A plate prepared for checks, and its lights at one boundary or over its span.

use super::grading::{Finding, Site};
use super::report::Report;
use super::{drive, shape, sound, wave};
use crate::progress::{Progress, Stopped};
use crate::spec::plate::Plate;
use crate::spec::range;
use crate::table::drive_table::TableError;
use crate::table::level::{Chain, other_speeds};
use thiserror::Error;

/// Places over the span that [`Checker::over_span`] looks at.
pub const SPAN_PLACES: usize = 41;

/// What the plate is used with.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditions {
    /// The device's sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Level of the tone, 0 to 1 of the turning-point table's full scale.
    pub level: f64,
    /// Whether the drive sits beside the centre line, which lets the second width mode in.
    pub off_centre: bool,
    /// Boundaries of the other tones that sound at the same time, metres.
    pub other_boundaries_m: Vec<f64>,
}

impl Default for Conditions {
    fn default() -> Self {
        Self { sample_rate_hz: 400e3, level: 1.0, off_centre: false, other_boundaries_m: Vec::new() }
    }
}

impl Conditions {
    fn validate(&self, plate: &Plate) -> Result<(), CheckError> {
        let level = self.level;
        if !(0.0..=1.0).contains(&level) {
            return Err(CheckError::Level { level });
        }
        for &boundary_m in &self.other_boundaries_m {
            on_plate(plate, "other boundary", boundary_m)?;
        }
        Ok(())
    }
}

/// Why a plate could not be checked.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CheckError {
    /// A boundary is not on the plate.
    #[error("{field} = {boundary_m} m: must be {low} to {high} m, on the plate")]
    Boundary {
        /// Which one: `boundary` or `other boundary`.
        field: &'static str,
        /// The boundary that was asked for, metres.
        boundary_m: f64,
        /// Nearest allowed, metres.
        low: f64,
        /// Farthest allowed, metres.
        high: f64,
    },
    /// The level is no level.
    #[error("level = {level}: must be 0 to 1")]
    Level {
        /// The level that was given.
        level: f64,
    },
    /// The plate cannot be driven at this sample rate.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The check was given up.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// A plate prepared for checks; make it once and ask it for as many boundaries as there are.
#[derive(Debug)]
pub struct Checker {
    pub(super) plate: Plate,
    pub(super) conditions: Conditions,
    /// The plate with its waves 1 %, 0.5 % slower and faster.
    pub(super) detuned: Vec<Plate>,
    /// The plate at the other speeds that its table is levelled over.
    pub(super) speeds: Vec<Plate>,
    /// Lowest drive-to-peak gain over the span: what a table can keep everywhere.
    lowest_gain: f64,
}

impl Checker {
    /// Prepares the checks of `plate`.
    ///
    /// # Errors
    /// [`CheckError`] when a condition is out of range, or the sample rate cannot carry the plate's band.
    pub fn new(plate: &Plate, conditions: Conditions) -> Result<Self, CheckError> {
        Self::watched(plate, conditions, &mut Progress::new(&mut |_| true))
    }

    /// [`Checker::new`] that tells how far it is and can be stopped: a moment for a usual plate, many
    /// times as long for one of many wavelengths.
    ///
    /// # Errors
    /// As [`Checker::new`], and [`CheckError::Stopped`].
    pub fn watched(
        plate: &Plate,
        conditions: Conditions,
        progress: &mut Progress<'_>,
    ) -> Result<Self, CheckError> {
        conditions.validate(plate)?;
        let chain = Chain::new(plate, conditions.sample_rate_hz)?;
        let mut lowest_gain = f64::INFINITY;
        let count = 2 * SPAN_PLACES - 1;
        for (number, x) in places(plate, count).enumerate() {
            progress.at(number as f64 / count as f64)?;
            lowest_gain = lowest_gain.min(chain.level(plate.frequency_for_boundary_hz(x))?.amplitude);
        }
        // A material at the very end of its allowed range has neighbours on one side only.
        let detuned =
            [0.99, 0.995, 1.005, 1.01].iter().filter_map(|&f| plate.with_wave_speed(f).ok()).collect();
        Ok(Self { plate: plate.clone(), conditions, detuned, speeds: other_speeds(plate), lowest_gain })
    }

    /// Goes on under other conditions.
    ///
    /// # Errors
    /// As [`Checker::new`]; the conditions stay as they were.
    pub fn set_conditions(&mut self, conditions: Conditions) -> Result<(), CheckError> {
        if conditions.sample_rate_hz == self.conditions.sample_rate_hz {
            conditions.validate(&self.plate)?;
            self.conditions = conditions;
        } else {
            *self = Self::new(&self.plate, conditions)?;
        }
        Ok(())
    }

    /// The plate it was made for.
    pub fn plate(&self) -> &Plate {
        &self.plate
    }

    /// Peak displacement the lights suppose, metres: what a turning-point table can keep over the whole span at the
    /// conditions' level.
    pub fn peak_m(&self) -> f64 {
        self.conditions.level * self.lowest_gain * self.plate.spec().full_scale_m
    }

    /// The lights at one boundary.
    ///
    /// # Errors
    /// [`CheckError::Boundary`] when it is not on the plate, [`CheckError::Table`] when its frequency is too high for
    /// the sample rate.
    pub fn at(&self, boundary_m: f64) -> Result<Report, CheckError> {
        let findings = self.findings(boundary_m)?;
        let frequency_hz = self.plate.frequency_for_boundary_hz(boundary_m);
        Ok(Report {
            plate: self.plate.name().to_owned(),
            boundary_m: Some(boundary_m),
            frequency_hz: (frequency_hz, frequency_hz),
            lights: findings.into_iter().map(|finding| finding.light).collect(),
        })
    }

    /// The lights over the plate's span: each at the boundary where it is worst.
    ///
    /// # Errors
    /// As [`Checker::at`].
    pub fn over_span(&self) -> Result<Report, CheckError> {
        self.over_span_watched(&mut Progress::new(&mut |_| true))
    }

    /// [`Checker::over_span`] that tells how far it is and can be stopped.
    ///
    /// # Errors
    /// As [`Checker::at`], and [`CheckError::Stopped`].
    pub fn over_span_watched(&self, progress: &mut Progress<'_>) -> Result<Report, CheckError> {
        let mut worst: Vec<Finding> = Vec::new();
        for (number, x) in places(&self.plate, SPAN_PLACES).enumerate() {
            progress.at(number as f64 / SPAN_PLACES as f64)?;
            let found = self.findings(x)?;
            if worst.is_empty() {
                worst = found;
                continue;
            }
            for (kept, new) in worst.iter_mut().zip(found) {
                if (new.light.colour, new.badness) > (kept.light.colour, kept.badness) {
                    *kept = new;
                }
            }
        }
        Ok(Report {
            plate: self.plate.name().to_owned(),
            boundary_m: None,
            frequency_hz: self.plate.band_hz(),
            lights: worst.into_iter().map(|finding| finding.light).collect(),
        })
    }

    fn findings(&self, boundary_m: f64) -> Result<Vec<Finding>, CheckError> {
        on_plate(&self.plate, "boundary", boundary_m)?;
        let frequency_hz = self.plate.frequency_for_boundary_hz(boundary_m);
        let site = Site { checker: self, plate: &self.plate, boundary_m, frequency_hz };
        Ok(vec![
            shape::slope_light(&site),
            shape::curvature_light(&site),
            shape::wavelengths_light(&site),
            wave::loss_light(&site),
            wave::peak_light(&site)?,
            shape::edge_light(&site),
            shape::ghost_light(&site),
            wave::thin_plate_light(&site),
            drive::match_light(&site),
            drive::sensitivity_light(&site)?,
            drive::actuator_light(&site),
            sound::level_light(&site)?,
            sound::beat_light(&site),
        ])
    }
}

pub(super) fn places(plate: &Plate, count: usize) -> impl Iterator<Item = f64> {
    let (start, end) = plate.span_m();
    (0..count).map(move |i| start + (end - start) * i as f64 / (count - 1) as f64)
}

fn on_plate(plate: &Plate, field: &'static str, boundary_m: f64) -> Result<(), CheckError> {
    let (low, high) = (range::span_start(plate.length_m()).low, plate.length_m());
    if (low..=high).contains(&boundary_m) {
        return Ok(());
    }
    Err(CheckError::Boundary { field, boundary_m, low, high })
}
