//! The plate in the time domain: its first width mode, driven by DAC codes at the device's sample rate.
//!
//! ```text
//! codes -> band filter, decimation (analytic), curves of the drive -> oscillators, integrated exactly -> field over x
//!       -> envelope
//! ```
//! The filter removes frequencies outside the plate's band: below 0.1 of its lowest frequency, and above 1.2 times its
//! highest plus half of its lowest.

mod error;

use super::analytic_signal::AnalyticDrive;
use super::band_plan::BandPlan;
use super::drive_filter::DriveFilter;
use super::envelope::Envelope;
use super::fit;
use super::integration::prepare;
use super::kernel::{self, ModalStates};
use super::modal::ModalBank;
use crate::definition::plate::Plate;
use crate::definition::sample_rate;
use crate::frequency::finger::Finger;
use crate::quantity::OutOfRange;
use num_complex::Complex64;
use pulp::Arch;
use std::f64::consts::TAU;

pub use error::LineError;

/// Least and largest number of positions of a line.
pub const LINE_POINTS: (usize, usize) = (16, 4096);
/// The band in which a fitted field is exact: factors on the lowest and the highest frequency of the span.
const BEYOND: (f64, f64) = (0.85, 1.15);

/// The first width mode of a plate in the time domain: DAC codes in, displacement over x out.
///
/// ```
/// use slipline_plate::{TimeDomainLine, preset};
///
/// let mut line = TimeDomainLine::new(&preset("membrane").unwrap(), 400e3, 64).unwrap();
/// let tone = |n: u32| (std::f32::consts::TAU * 150.0 * n as f32 / 400e3).cos();
/// line.push(&(0..400_000).map(tone).collect::<Vec<_>>());
/// assert!(line.envelope().maximum_m().iter().any(|displacement_m| *displacement_m > 0.0));
/// ```
#[derive(Clone)]
pub struct TimeDomainLine {
    arch: Arch,
    drive: AnalyticDrive,
    plan: BandPlan,
    position_m: Vec<f64>,
    oscillators: ModalStates,
    /// The last six spline coefficients, oldest first.
    coefficient: [Complex64; 6],
    /// Field in metres per signal (see [`kernel::tiles`]): the drive, its first and second derivative, each oscillator.
    shape: Vec<f32>,
    signal: Vec<[f32; 2]>,
    /// Field at the positions, rounded up to whole tiles.
    field_re: Vec<f32>,
    field_im: Vec<f32>,
    envelope: Envelope,
    steps: u64,
    /// The field is evaluated at every `stride`-th step: at a rate of at least 2.5 half bands, above the Nyquist rate
    /// of 2.
    stride: u64,
    field_step: u64,
    settle_s: f64,
    /// Delay of the field by its fit, see [`fit::Fit`].
    fit_delay_s: f64,
}

impl TimeDomainLine {
    /// Prepares a line of `points` positions (16 to 4096), uniform from 0 to the plate's end, by a rational fit of the
    /// field of [`crate::respond()`]. The sample rate, Hz, must be one of [`crate::sample_rates`].
    ///
    /// Between clamped edges the fit is approximate: within 0.1 dB at the peak, and within some thousandths of the peak
    /// in the tail.
    ///
    /// # Errors
    /// [`LineError::SampleRate`] if the rate cannot carry the plate's band, [`LineError::OutOfRange`] for `points`,
    /// [`LineError::Drive`] for a measured drive that changes too fast with the frequency, and [`LineError::Unfit`] if
    /// the error of the fit exceeds 0.5 % of the largest amplitude, between clamped edges 3 %.
    pub fn new(plate: &Plate, sample_rate_hz: f64, points: usize) -> Result<Self, LineError> {
        Self::touched(plate, None, sample_rate_hz, points)
    }

    /// As [`TimeDomainLine::new`], with a finger that rests on the plate where there is one.
    ///
    /// # Errors
    /// Those of [`TimeDomainLine::new`], and [`LineError::Finger`] for a finger that is not valid on this plate.
    pub fn touched(
        plate: &Plate,
        finger: Option<&Finger>,
        sample_rate_hz: f64,
        points: usize,
    ) -> Result<Self, LineError> {
        let plan = plan(plate, sample_rate_hz, points)?;
        if let Some(finger) = finger {
            finger.check(plate).map_err(LineError::Finger)?;
        }
        let fit = fit::of_plate(plate, finger, &plan, points, exact_hz(plate));
        Self::of_fit(plate, plan, points, &fit)
    }

    fn of_fit(plate: &Plate, plan: BandPlan, points: usize, fit: &fit::Fit) -> Result<Self, LineError> {
        check_fit(fit)?;
        let bank = &fit.bank;
        let curve = DriveFilter::of(plate, &plan)?;
        let scale = plate.spec().full_scale_m;
        let shape = kernel::tiles(points, 3 + bank.pole.len(), |row, signal| {
            let value =
                if signal < 3 { bank.quasi_static[(row, signal)] } else { bank.shape[(row, signal - 3)] }
                    * scale;
            [value.re as f32, value.im as f32]
        });
        let covered = points.div_ceil(kernel::TILE) * kernel::TILE;
        Ok(Self {
            arch: Arch::new(),
            drive: AnalyticDrive::new(plan, curve),
            plan,
            oscillators: prepare(bank, &plan),
            coefficient: [Complex64::ZERO; 6],
            shape,
            signal: vec![[0.0; 2]; 3 + bank.pole.len()],
            field_re: vec![0.0; covered],
            field_im: vec![0.0; covered],
            envelope: Envelope::new(points),
            position_m: positions(plate, points),
            steps: 0,
            stride: ((plan.rate_hz() / (2.5 * plan.half_band_hz)) as u64).max(1),
            field_step: 0,
            settle_s: settle_time(bank, plate),
            fit_delay_s: fit.delay_s,
        })
    }

    /// The same line with a field at every step of its oscillators, at a rate of at least 5.2 half bands.
    pub(crate) fn with_every_step(self) -> Self {
        Self { stride: 1, ..self }
    }

    /// Advances the plate by one sample per code. Codes are -1 to 1 of full scale; larger ones are not clamped; NaN and
    /// infinity are replaced by 0.
    pub fn push(&mut self, codes: &[f32]) {
        for code in codes {
            let code = if code.is_finite() { f64::from(*code) } else { 0.0 };
            if let Some(coefficient) = self.drive.push(code) {
                self.step(coefficient);
            }
        }
    }

    /// As [`TimeDomainLine::push`], for unsigned codes of a DAC of `bits` bits (clamped to 1 to 16); mid-scale is zero
    /// displacement.
    pub fn push_codes(&mut self, codes: &[u16], bits: u32) {
        let half = f64::from(1_u32 << (bits.clamp(1, 16) - 1));
        for code in codes {
            if let Some(coefficient) = self.drive.push((f64::from(*code) - half) / half) {
                self.step(coefficient);
            }
        }
    }

    fn step(&mut self, coefficient: Complex64) {
        self.coefficient.rotate_left(1);
        self.coefficient[5] = coefficient;
        self.arch.dispatch(kernel::Step {
            oscillators: &mut self.oscillators,
            coefficient_re: self.coefficient.map(|c| c.re),
            coefficient_im: self.coefficient.map(|c| c.im),
        });
        self.steps += 1;
        if self.steps.is_multiple_of(self.stride) {
            self.update_field();
            let points = self.position_m.len();
            self.envelope.add(&self.field_re[..points], &self.field_im[..points]);
        }
    }

    fn update_field(&mut self) {
        // The drive at the end of the step, where five of the spline's pieces are not zero, and its first two
        // derivatives. For a signal e^(-j (omega - centre) t) the factor (omega - centre) is the operator j d/dt.
        let c = &self.coefficient;
        let rate = self.plan.rate_hz();
        let drive = (c[1] + c[5] + (c[2] + c[4]) * 26.0 + c[3] * 66.0) / 120.0;
        let slope = (c[5] - c[1] + (c[4] - c[2]) * 10.0) * (rate / 24.0);
        let curvature = (c[1] + c[5] + (c[2] + c[4]) * 2.0 - c[3] * 6.0) * (rate * rate / 6.0);
        let quasi_static = [drive, slope * Complex64::I, -curvature];
        for (signal, value) in self.signal.iter_mut().zip(quasi_static) {
            *signal = [value.re as f32, value.im as f32];
        }
        let states = self.oscillators.re.iter().zip(&self.oscillators.im);
        for (signal, (re, im)) in self.signal[3..].iter_mut().zip(states) {
            *signal = [*re as f32, *im as f32];
        }
        self.arch.dispatch(kernel::FieldSum {
            shape: &self.shape,
            signal: &self.signal,
            re: &mut self.field_re,
            im: &mut self.field_im,
        });
        self.field_step = self.steps;
    }

    /// Positions of the line, metres.
    pub fn positions_m(&self) -> &[f64] {
        &self.position_m
    }

    /// Writes the displacement at the latest step of the field, metres, one value per position; `out` may be shorter.
    pub fn field_m(&self, out: &mut [f32]) {
        let carrier = self.carrier();
        let (re, im) = (carrier.re as f32, carrier.im as f32);
        for ((out, a), b) in out.iter_mut().zip(&self.field_re).zip(&self.field_im) {
            *out = a * re - b * im;
        }
    }

    /// Writes the analytic displacement at the latest step of the field, metres, one value per position; `out` may be
    /// shorter. Its real part is [`TimeDomainLine::field_m`]. A tone of frequency f appears in it only as
    /// e^(-j 2 pi f t), without a part at -f, and with one constant phase for all frequencies.
    ///
    /// The field is updated every `1/step_rate_hz()` seconds.
    pub fn analytic_m(&self, out: &mut [Complex64]) {
        let carrier = self.carrier();
        for ((out, re), im) in out.iter_mut().zip(&self.field_re).zip(&self.field_im) {
            *out = Complex64::new(f64::from(*re), f64::from(*im)) * carrier;
        }
    }

    /// e^(-j omega t) of the band's middle at the latest step of the field.
    fn carrier(&self) -> Complex64 {
        Complex64::cis(-TAU * (self.field_step as f64 * self.plan.centre_hz / self.plan.rate_hz()).fract())
    }

    /// Maximum and RMS since the last [`TimeDomainLine::reset_envelope`].
    pub fn envelope(&self) -> &Envelope {
        &self.envelope
    }

    /// Restarts the envelope, for instance when the plate has settled.
    pub fn reset_envelope(&mut self) {
        self.envelope.reset();
    }

    /// Puts the plate to rest and restarts the envelope.
    pub fn rest(&mut self) {
        self.oscillators.re.fill(0.0);
        self.oscillators.im.fill(0.0);
        self.coefficient = [Complex64::ZERO; 6];
        self.field_re.fill(0.0);
        self.field_im.fill(0.0);
        self.drive.rest();
        self.envelope.reset();
    }

    /// Time in which the transient of a change in the band decays to a thousandth, seconds. It includes twice the
    /// latency, and is at most ten seconds plus that.
    pub fn settle_time_s(&self) -> f64 {
        self.settle_s + 2.0 * self.latency_s()
    }

    /// Time from a code to its effect in the field, seconds: after n codes, of which the first is held from the time 0,
    /// the field is that of the plate at the time n over the sample rate, less the latency. It is the sum of the delay
    /// of the drive's filters, of the two steps by which the middle of the spline is behind its latest coefficient,
    /// and, between clamped edges, of the delay of the fit, 4.7 periods of the span's lowest frequency.
    pub fn latency_s(&self) -> f64 {
        self.drive.delay_s() + 2.0 / self.plan.rate_hz() + self.fit_delay_s
    }

    /// Rate at which the field is updated, Hz.
    pub fn step_rate_hz(&self) -> f64 {
        self.plan.rate_hz() / self.stride as f64
    }
}

/// Checks the arguments of a line and returns its filter.
fn plan(plate: &Plate, sample_rate_hz: f64, points: usize) -> Result<BandPlan, LineError> {
    sample_rate::check(plate, sample_rate_hz)?;
    OutOfRange::check_count("points", points, LINE_POINTS.0..=LINE_POINTS.1)?;
    let (low_hz, high_hz) = plate.band_hz();
    Ok(BandPlan::new(sample_rate_hz, low_hz, high_hz))
}

/// Lowest and highest frequency at which a fitted field is exact, Hz.
fn exact_hz(plate: &Plate) -> (f64, f64) {
    let (low_hz, high_hz) = plate.band_hz();
    (BEYOND.0 * low_hz, BEYOND.1 * high_hz)
}

/// Refuses a fit whose error is too large.
pub(super) fn check_fit(fit: &fit::Fit) -> Result<(), LineError> {
    let fit::Fit { error, most, .. } = *fit;
    if error > most { Err(LineError::Unfit { error, most }) } else { Ok(()) }
}

/// `points` uniform positions from 0 to the plate's end, metres.
fn positions(plate: &Plate, points: usize) -> Vec<f64> {
    (0..points).map(|i| plate.length_m() * i as f64 / (points - 1) as f64).collect()
}

/// ln(1000) over the slowest decay rate of an oscillator in the band, seconds; at least four periods of the lowest
/// frequency, at most ten seconds.
fn settle_time(bank: &ModalBank, plate: &Plate) -> f64 {
    let (low_hz, high_hz) = plate.band_hz();
    let slowest = bank
        .pole
        .iter()
        .filter(|pole| pole.re > 0.8 * TAU * low_hz && pole.re < 1.2 * TAU * high_hz)
        .map(|pole| -pole.im)
        .fold(f64::INFINITY, f64::min);
    if slowest.is_finite() { (6.9 / slowest.max(0.69)).max(4.0 / low_hz) } else { 4.0 / low_hz }
}

#[cfg(test)]
mod tests;
