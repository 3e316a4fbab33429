//! Prepares a plate for checks and computes its lights at one boundary or over its span.

use super::conditions::Conditions;
use super::error::{CheckError, on_plate};
use super::grading::{Finding, Site};
use super::interval::Interval;
use super::levels::{AT_ONCE, SiteLevels};
use super::lights::{
    actuator, air, distortion, drift, drive, felt_edge, frame, linear_output, sensitivity, shape, sound,
    thickness, touch, wave,
};
use super::prepared::{Prepared, SPAN_PLACES};
use super::report::Report;
use crate::definition::plate::Plate;
use crate::frequency::Response;
use crate::frequency::respond::{check_frequency, respond_each};
use crate::progress::Progress;
use crate::table::TableError;

/// Points of the computed amplitude; the solver's own grid is finer where needed.
const POINTS: usize = 513;

/// A plate prepared for checks. The preparation takes most of the time: make it once and use it for many boundaries.
#[derive(Debug)]
pub struct Checker {
    prepared: Prepared,
}

impl Checker {
    /// Prepares the checks of `plate`.
    ///
    /// # Errors
    /// [`CheckError::Level`] or [`CheckError::Boundary`] if a condition is out of range, [`CheckError::Table`] if the
    /// sample rate cannot carry the plate's band or the plate has no amplitude somewhere on its span.
    pub fn new(plate: &Plate, conditions: Conditions) -> Result<Self, CheckError> {
        Self::watched(plate, conditions, &mut Progress::unwatched())
    }

    /// As [`Checker::new`], with reports of its progress; it can be stopped. A plate of many wavelengths takes many
    /// times as long as most plates.
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

    /// Changes the conditions. The preparation is repeated only if the sample rate changes.
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

    /// The plate of the checks.
    pub fn plate(&self) -> &Plate {
        &self.prepared.plate
    }

    /// The peak displacement that the lights assume, metres: the level that a turning-point table reaches everywhere
    /// on the span, times the conditions' level.
    pub fn peak_m(&self) -> f64 {
        self.prepared.peak_m()
    }

    /// The lights at one boundary.
    ///
    /// # Errors
    /// [`CheckError::Boundary`] if `boundary_m` is not 0.001 to 1 of the plate's length, [`CheckError::Table`] if the
    /// plate has no amplitude at its frequency.
    pub fn at(&self, boundary_m: f64) -> Result<Report, CheckError> {
        on_plate(self.plate(), "boundary", boundary_m)?;
        let frequency_hz = self.plate().frequency_for_boundary_hz(boundary_m);
        let sites = self.sites(&[boundary_m])?;
        let findings = sites.iter().flat_map(findings);
        Ok(Report {
            plate: self.plate().name().to_owned(),
            boundary_m: Some(boundary_m),
            boundary_tolerance_m: self.plate().boundary_tolerance_m(boundary_m),
            level_tolerance_db: self.level_tolerance_db(),
            frequency_hz: (frequency_hz, frequency_hz),
            lights: findings.map(|finding| finding.light).collect(),
        })
    }

    /// The lights over the plate's span: the worst result of each over 41 boundaries, with its
    /// boundary.
    ///
    /// # Errors
    /// As [`Checker::at`], and [`CheckError::Stopped`].
    pub fn over_span(&self, progress: &mut Progress<'_>) -> Result<Report, CheckError> {
        let mut worst: Vec<Finding> = Vec::new();
        let boundaries_m: Vec<f64> = self.plate().over_span_m(SPAN_PLACES).collect();
        let mut done = 0;
        for group in boundaries_m.chunks(AT_ONCE) {
            progress.at(done as f64 / SPAN_PLACES as f64)?;
            for site in self.sites(group)? {
                progress.at(done as f64 / SPAN_PLACES as f64)?;
                done += 1;
                let found = findings(&site);
                if worst.is_empty() {
                    worst = found;
                    continue;
                }
                for (kept, new) in worst.iter_mut().zip(found) {
                    if (new.light.colour, new.severity) > (kept.light.colour, kept.severity) {
                        *kept = new;
                    }
                }
            }
        }
        Ok(Report {
            plate: self.plate().name().to_owned(),
            boundary_m: None,
            boundary_tolerance_m: boundaries_m
                .iter()
                .filter_map(|&x| self.plate().boundary_tolerance_m(x))
                .reduce(f64::max),
            level_tolerance_db: self.level_tolerance_db(),
            frequency_hz: self.plate().band_hz(),
            lights: worst.into_iter().map(|finding| finding.light).collect(),
        })
    }

    fn level_tolerance_db(&self) -> Option<f64> {
        self.plate().spec().calibration.as_ref()?.level_tolerance_db
    }

    /// The inputs of the lights at each boundary, computed for all boundaries together.
    pub(super) fn sites(&self, boundaries_m: &[f64]) -> Result<Vec<Site<'_>>, CheckError> {
        let plate = self.plate();
        let frequencies_hz: Vec<f64> =
            boundaries_m.iter().map(|&x| plate.frequency_for_boundary_hz(x)).collect();
        let responses = respond_each(plate, &frequencies_hz, POINTS).map_err(|_| {
            let mut places = boundaries_m.iter().zip(&frequencies_hz);
            let refused = places.find(|(_, frequency_hz)| check_frequency(plate, **frequency_hz).is_err());
            let (position_m, frequency_hz) = refused.map_or((f64::NAN, f64::NAN), |(x, hz)| (*x, *hz));
            TableError::Silent { position_m, frequency_hz }
        })?;
        let levels = self.prepared.variants.levels(&frequencies_hz)?;
        let computed = boundaries_m.iter().zip(responses).zip(levels);
        let site = |((&boundary_m, response), levels): ((_, Response), SiteLevels)| Site {
            prepared: &self.prepared,
            plate,
            boundary_m,
            frequency_hz: response.frequency_hz,
            interval: Interval::new(plate, boundary_m, response.frequency_hz),
            response,
            levels,
        };
        Ok(computed.map(site).collect())
    }
}

/// All lights at one boundary.
fn findings(site: &Site<'_>) -> Vec<Finding> {
    let mut findings = vec![
        shape::slope_light(site),
        shape::curvature_light(site),
        shape::wavelengths_light(site),
        wave::loss_light(site),
        wave::peak_light(site),
        shape::edge_light(site),
        touch::width_light(site),
        touch::finger_load_light(site),
        shape::ghost_light(site),
        thickness::thin_plate_light(site),
        drive::match_light(site),
        sensitivity::sensitivity_light(site),
        actuator::actuator_light(site),
        actuator::excursion_light(site),
        actuator::resolution_light(site),
        sound::level_light(site),
        sound::beat_light(site),
        air::air_light(site),
        felt_edge::felt_edge_light(site),
        frame::frame_light(site),
        drift::drift_light(site),
        drift::press_light(site),
    ];
    findings.extend(distortion::distortion_light(site));
    findings.extend(linear_output::linear_output_light(site));
    findings
}
