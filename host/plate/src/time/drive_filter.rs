//! The filter that gives a line's or a sheet's drive the gain and the phase of a [`DriveCurve`].
//!
//! It acts on the decimated analytic drive, which contains the plate's band alone, shifted down by the middle of the
//! band: y(n) = sum over k of h_k c(n - k). Its response at the frequency f is sum of
//! h_k e^(j 2 pi (f - centre) k/rate), and must equal that of the curve delayed by D steps. The taps are found by
//! least squares over the band; a curve may lead, so half of them lie before the delay D and half after it.

use super::band_plan::BandPlan;
use super::drive_curve::DriveCurve;
use super::kernel;
use super::toeplitz;
use crate::definition::plate::Plate;
use num_complex::Complex64;
use pulp::Arch;
use std::f64::consts::TAU;

/// Error at which the search for a longer filter stops, relative to the curve at the same frequency: 0.026 dB.
const TOLERANCE: f64 = 3e-3;
/// Largest error, relative to the curve at the same frequency. The points of a measured curve have noise; a longer
/// filter would follow it, at the cost of delay.
const ERROR_MAX: f64 = 3e-2;
/// Shortest and longest delay, in steps of the decimated drive. Each try has twice the delay of the one before. The longest follows
/// the calibration of a clamped plate whose source reflects: a comb of resonances, each with a corner at its top.
const DELAY: (usize, usize) = (4, 1024);
/// Least number of frequencies of the least squares.
const FREQUENCIES_MIN: usize = 256;
/// Weight of the band filter's slopes beyond the plate's band, against the band.
const BEYOND: f64 = 0.01;
/// Weight of the taps' own size against the error: keeps small what the band does not determine.
const RIDGE: f64 = 1e-9;
/// Curve values below this fraction of the largest in the band get the same absolute accuracy.
const FAINTEST: f64 = 1e-4;

/// No filter is close enough to the curve of a drive.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} cannot be simulated in time: the best filter for this curve is off by {:.1} % of it, at most {:.1} % is allowed", .error * 100.0, ERROR_MAX * 100.0)]
#[derive(serde::Serialize, serde::Deserialize)]
pub struct DriveCurveError {
    /// The fields of the plate file that give the curve.
    #[serde(with = "crate::static_text")]
    pub field: crate::StaticText,
    /// Largest error over the plate's band, relative to the curve at the same frequency.
    pub error: f64,
}

/// The filter with its state: spline coefficients in, spline coefficients out.
#[derive(Debug, Clone)]
pub(crate) struct DriveFilter {
    arch: Arch,
    /// Taps in time order, oldest first.
    tap_re: Vec<f64>,
    tap_im: Vec<f64>,
    /// The last coefficients, as many as there are taps, each stored twice so that every window is contiguous.
    history_re: Vec<f64>,
    history_im: Vec<f64>,
    write: usize,
    delay: usize,
}

impl DriveFilter {
    /// The filter of a plate's drive, see [`DriveFilter::of_curve`]; `None` if the drive has no measured curve.
    pub(crate) fn of(plate: &Plate, plan: &BandPlan) -> Result<Option<Self>, DriveCurveError> {
        let Some(curve) = DriveCurve::of(plate) else { return Ok(None) };
        let filter = Self::of_curve(&curve, plan, plate.band_hz());
        filter.map(Some).map_err(|error| DriveCurveError { field: curve.field(), error })
    }

    /// The shortest filter that follows `curve` over `band_hz` within [`TOLERANCE`], or the best one within
    /// [`ERROR_MAX`].
    ///
    /// # Errors
    /// The error of the best filter, relative to the curve at the same frequency.
    fn of_curve(curve: &DriveCurve<'_>, plan: &BandPlan, band_hz: (f64, f64)) -> Result<Self, f64> {
        let mut best: Option<(f64, Self)> = None;
        let mut delay = DELAY.0;
        while delay <= DELAY.1 {
            let (error, filter) = Design { curve, plan, band_hz, delay }.solve();
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                best = Some((error, filter));
            }
            if error < TOLERANCE {
                break;
            }
            delay *= 2;
        }
        match best {
            Some((error, filter)) if error <= ERROR_MAX => Ok(filter),
            best => Err(best.map_or(f64::INFINITY, |(error, _)| error)),
        }
    }

    /// Delay from a coefficient to its effect, in steps.
    pub(crate) fn delay(&self) -> usize {
        self.delay
    }

    pub(crate) fn rest(&mut self) {
        self.history_re.fill(0.0);
        self.history_im.fill(0.0);
    }

    pub(crate) fn push(&mut self, coefficient: Complex64) -> Complex64 {
        let count = self.tap_re.len();
        for at in [self.write, self.write + count] {
            (self.history_re[at], self.history_im[at]) = (coefficient.re, coefficient.im);
        }
        self.write = (self.write + 1) % count;
        let window = self.write..self.write + count;
        let products = |window: &[f64]| {
            self.arch.dispatch(kernel::Filter { window, tap_re: &self.tap_re, tap_im: &self.tap_im })
        };
        let (of_re, of_im) = (products(&self.history_re[window.clone()]), products(&self.history_im[window]));
        Complex64::new(of_re.0 - of_im.1, of_re.1 + of_im.0)
    }
}

/// Design of one filter.
struct Design<'a> {
    curve: &'a DriveCurve<'a>,
    plan: &'a BandPlan,
    band_hz: (f64, f64),
    delay: usize,
}

impl Design<'_> {
    /// The filter with this delay, and its largest error in the band.
    fn solve(&self) -> (f64, DriveFilter) {
        let taps = 2 * self.delay + 1;
        let (low_hz, high_hz) = self.plan.stop_hz();
        let count = (2 * taps).max(FREQUENCIES_MIN);
        let spread = |i: usize| low_hz + (high_hz - low_hz) * i as f64 / (count - 1) as f64;
        let frequencies: Vec<f64> = (0..count).map(spread).collect();
        let in_band = |hz: f64| hz >= self.band_hz.0 && hz <= self.band_hz.1;
        let gain = |hz: f64| self.curve.response(hz).norm();
        let loudest = frequencies.iter().map(|hz| gain(*hz)).fold(0.0, f64::max);
        let relative = |hz: f64| loudest / gain(hz).max(FAINTEST * loudest);

        let mut lag = vec![Complex64::ZERO; taps];
        let mut right = vec![Complex64::ZERO; taps];
        for &hz in &frequencies {
            let weight = relative(hz).powi(2) * if in_band(hz) { 1.0 } else { BEYOND * BEYOND };
            let step = self.step(hz);
            let mut turn = Complex64::from(weight);
            let wanted = self.wanted(hz);
            for (lag, right) in lag.iter_mut().zip(&mut right) {
                *lag += turn;
                *right += turn.conj() * wanted;
                turn *= step;
            }
        }
        lag[0] *= 1.0 + RIDGE;
        let tap = toeplitz::solve(&lag, &right);

        let corners = self.curve.corners_hz(self.band_hz);
        let checked = frequencies.iter().copied().filter(|hz| in_band(*hz)).chain(corners);
        let error = checked
            .map(|hz| {
                let step = self.step(hz);
                let found = tap.iter().rev().fold(Complex64::ZERO, |sum, tap| sum * step + tap);
                (found - self.wanted(hz)).norm() * relative(hz) / loudest
            })
            .fold(0.0, |most: f64, error| if error.is_nan() { f64::INFINITY } else { most.max(error) });
        let filter = DriveFilter {
            arch: Arch::new(),
            tap_re: tap.iter().rev().map(|tap| tap.re).collect(),
            tap_im: tap.iter().rev().map(|tap| tap.im).collect(),
            history_re: vec![0.0; 2 * taps],
            history_im: vec![0.0; 2 * taps],
            write: 0,
            delay: self.delay,
        };
        (error, filter)
    }

    /// Response of a tap over that of the tap before it.
    fn step(&self, frequency_hz: f64) -> Complex64 {
        Complex64::cis(TAU * (frequency_hz - self.plan.centre_hz) / self.plan.rate_hz())
    }

    /// The delayed curve. The delay counts the carrier as well: the shift of the band does not change the phase of a
    /// delay.
    fn wanted(&self, frequency_hz: f64) -> Complex64 {
        let turns = (frequency_hz / self.plan.rate_hz() * self.delay as f64).fract();
        self.curve.response(frequency_hz) * Complex64::cis(TAU * turns)
    }
}
