//! A plate prepared for checks, and its lights at one boundary or over its span.

use super::conditions::Conditions;
use super::error::{CheckError, on_plate};
use super::grading::{Finding, Site};
use super::prepared::{Prepared, SPAN_PLACES, places};
use super::report::Report;
use super::{drive, shape, sound, wave};
use crate::progress::Progress;
use crate::spec::plate::Plate;

/// A plate prepared for checks; make it once and ask it for as many boundaries as there are.
#[derive(Debug)]
pub struct Checker {
    prepared: Prepared,
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
        Ok(Self { prepared: Prepared::new(plate, conditions, progress)? })
    }

    /// Goes on under other conditions.
    ///
    /// # Errors
    /// As [`Checker::new`]; the conditions stay as they were.
    pub fn set_conditions(&mut self, conditions: Conditions) -> Result<(), CheckError> {
        if conditions.sample_rate_hz == self.prepared.conditions.sample_rate_hz {
            conditions.validate(self.plate())?;
            self.prepared.conditions = conditions;
        } else {
            *self = Self::new(self.plate(), conditions)?;
        }
        Ok(())
    }

    /// The plate it was made for.
    pub fn plate(&self) -> &Plate {
        &self.prepared.plate
    }

    /// Peak displacement the lights suppose, metres: what a turning-point table can keep over the whole span at the
    /// conditions' level.
    pub fn peak_m(&self) -> f64 {
        self.prepared.peak_m()
    }

    /// The lights at one boundary.
    ///
    /// # Errors
    /// [`CheckError::Boundary`] when it is not on the plate, [`CheckError::Table`] when its frequency is too high for
    /// the sample rate.
    pub fn at(&self, boundary_m: f64) -> Result<Report, CheckError> {
        let findings = self.findings(boundary_m)?;
        let frequency_hz = self.plate().frequency_for_boundary_hz(boundary_m);
        Ok(Report {
            plate: self.plate().name().to_owned(),
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
        for (number, x) in places(self.plate(), SPAN_PLACES).enumerate() {
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
            plate: self.plate().name().to_owned(),
            boundary_m: None,
            frequency_hz: self.plate().band_hz(),
            lights: worst.into_iter().map(|finding| finding.light).collect(),
        })
    }

    fn findings(&self, boundary_m: f64) -> Result<Vec<Finding>, CheckError> {
        on_plate(self.plate(), "boundary", boundary_m)?;
        let frequency_hz = self.plate().frequency_for_boundary_hz(boundary_m);
        let site = Site { prepared: &self.prepared, plate: self.plate(), boundary_m, frequency_hz };
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
