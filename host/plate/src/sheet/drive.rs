//! The measured curves of a plate's drive for a sheet: DAC codes in, the drive at any time between two codes out.

use super::grid::SheetError;
use crate::definition::plate::Plate;
use crate::definition::sample_rate;
use crate::time::{AnalyticDrive, BSPLINE, BandPlan, DriveCurve, DriveFilter};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The codes through the filter of the drive's curves. Frequencies outside the plate's band are blocked, as on a
/// [`crate::TimeDomainLine`].
///
/// The filter gives the coefficients of a quintic spline at a lower rate, shifted down by the middle of the band. The
/// drive at the fraction t of a step is Re(e^(-j omega t) sum of `BSPLINE` pieces times coefficients), with omega the
/// middle of the band.
#[derive(Debug, Clone)]
pub(super) struct CurvedDrive {
    drive: AnalyticDrive,
    plan: BandPlan,
    /// The last six coefficients, oldest first.
    coefficient: [Complex64; 6],
    /// Number of coefficients up to now.
    steps: u64,
    /// Codes since the last coefficient.
    since: u32,
}

impl CurvedDrive {
    /// `None` if the plate's drive has no measured curve.
    pub(super) fn of(plate: &Plate, sample_rate_hz: f64) -> Result<Option<Self>, SheetError> {
        if DriveCurve::of(plate).is_none() {
            return Ok(None);
        }
        sample_rate::check(plate, sample_rate_hz)?;
        let (low_hz, high_hz) = plate.band_hz();
        let plan = BandPlan::new(sample_rate_hz, low_hz, high_hz);
        let filter = DriveFilter::of(plate, &plan)?;
        let drive = AnalyticDrive::new(plan, filter);
        Ok(Some(Self { drive, plan, coefficient: [Complex64::ZERO; 6], steps: 0, since: 0 }))
    }

    pub(super) fn push(&mut self, code: f64) {
        self.since += 1;
        if let Some(coefficient) = self.drive.push(code) {
            self.coefficient.rotate_left(1);
            self.coefficient[5] = coefficient;
            self.steps += 1;
            self.since = 0;
        }
    }

    /// The drive at a fraction of a code after the last one.
    pub(super) fn at(&self, share_of_code: f64) -> f64 {
        let codes = (self.plan.sample_rate_hz / self.plan.rate_hz()).round();
        let t = (f64::from(self.since) + share_of_code) / codes;
        let pieces = BSPLINE.iter().zip(&self.coefficient);
        let envelope: Complex64 = pieces
            .map(|(piece, coefficient)| coefficient * piece.iter().rev().fold(0.0, |sum, c| sum * t + c))
            .sum();
        let steps = self.steps as f64 + t;
        let carrier = Complex64::cis(-TAU * (steps * self.plan.centre_hz / self.plan.rate_hz()).fract());
        (carrier * envelope).re / 120.0
    }
}
