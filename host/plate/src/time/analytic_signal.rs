//! Turns DAC codes into the slowly varying complex drive of the oscillators.
//!
//! The DAC holds each code for one sample. Of that staircase only the plate's band matters. A band filter takes it as
//! an analytic signal (only e^(-j omega t) with omega > 0), which is shifted down by the band's middle and decimated.
//! The results are the coefficients of a quintic B-spline; its curve is the drive also between the decimated samples,
//! so the oscillators can be integrated exactly. The filter keeps the droop of the DAC's hold and cancels the spline's
//! droop.

use super::drive_filter::DriveFilter;
use crate::time::kernel;
use num_complex::Complex64;
use pulp::Arch;
use std::f64::consts::{PI, TAU};

/// The band of the filter and the two decimations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BandPlan {
    pub(crate) sample_rate_hz: f64,
    /// First decimation, by a triangle of two blocks.
    pub(crate) coarse: usize,
    /// Second decimation, by the band filter.
    pub(crate) fine: usize,
    /// Middle of the band, Hz; it is shifted to 0 Hz.
    pub(crate) centre_hz: f64,
    /// Edges of the band filter (half-amplitude), Hz.
    low_hz: f64,
    high_hz: f64,
    transition_hz: f64,
    /// Half of the width of the band, stop band edges included, Hz.
    pub(crate) half_band_hz: f64,
    /// The phase of `centre_hz` advances by `turn/CYCLE` of a full turn per output sample.
    turn: usize,
}

/// Output samples after which the mixing phase repeats.
const CYCLE: usize = 256;
/// Kaiser's beta for a stop band of 90 dB.
const KAISER_BETA: f64 = 8.96;

impl BandPlan {
    pub(crate) fn new(sample_rate_hz: f64, low_hz: f64, high_hz: f64) -> Self {
        // Lower transition: from 0.6 of the lowest frequency down to 0.1 of it, because the mirror image of the band
        // begins below 0 Hz.
        let transition_hz = 0.5 * low_hz;
        let pass_high = (1.2 * high_hz).min((1.02 * high_hz).max(0.47 * sample_rate_hz));
        let low_edge = 0.35 * low_hz;
        let high_edge = pass_high + 0.5 * transition_hz;
        let stop_high = high_edge + 0.5 * transition_hz;
        let coarse = ((sample_rate_hz / (16.0 * stop_high)) as usize).max(1);
        let half_band = 0.5 * (stop_high - low_edge);
        let middle_rate = sample_rate_hz / coarse as f64;
        let fine = ((middle_rate / (5.2 * half_band)) as usize).max(1);
        let rate = middle_rate / fine as f64;
        // The centre nearest to the middle whose phase repeats after CYCLE output samples.
        let turn = (0.5 * (low_edge + stop_high) / rate * CYCLE as f64).round() as usize;
        let centre_hz = turn as f64 * rate / CYCLE as f64;
        Self {
            sample_rate_hz,
            coarse,
            fine,
            centre_hz,
            low_hz: low_edge,
            high_hz: high_edge,
            transition_hz,
            half_band_hz: half_band,
            turn,
        }
    }

    /// Rate of the decimated drive, Hz.
    pub(crate) fn rate_hz(&self) -> f64 {
        self.sample_rate_hz / (self.coarse * self.fine) as f64
    }

    /// The ends of the band filter, Hz: from there on nothing passes.
    pub(crate) fn stop_hz(&self) -> (f64, f64) {
        (self.low_hz - 0.5 * self.transition_hz, self.high_hz + 0.5 * self.transition_hz)
    }

    /// Taps of the band filter, newest sample first; with `rate_of_drive` the filter also differentiates with respect
    /// to time.
    ///
    /// The taps are the Fourier integral of [`BandPlan::shape`] over the band, times a Kaiser window. The window
    /// smooths the shape a little: at most 0.01 dB, at the ends of the band.
    fn taps(&self, rate_of_drive: bool) -> Vec<Complex64> {
        let rate = self.sample_rate_hz / self.coarse as f64;
        let count = 2 * ((0.5 * 5.8 * rate / self.transition_hz) as usize) + 1;
        let middle = (count / 2) as f64;
        let span = self.high_hz - self.low_hz;
        // Midpoint rule with sixteen points per oscillation of the fastest integrand, that of the first and the last
        // tap.
        let points = ((16.0 * count as f64 * span / rate) as usize).max(64);
        let df = span / points as f64;
        let mut taps = vec![Complex64::ZERO; count];
        for i in 0..points {
            let frequency = self.low_hz + (i as f64 + 0.5) * df;
            let mut value = Complex64::from(2.0 * df / rate * self.shape(frequency));
            if rate_of_drive {
                value *= Complex64::new(0.0, -TAU * frequency);
            }
            let step = Complex64::cis(-TAU * frequency / rate);
            let mut turn = Complex64::cis(TAU * frequency / rate * middle) * value;
            for tap in &mut taps {
                *tap += turn;
                turn *= step;
            }
        }
        for (n, tap) in taps.iter_mut().enumerate() {
            let t = (n as f64 - middle) / (middle + 1.0);
            *tap *= bessel_i0(KAISER_BETA * (1.0 - t * t).max(0.0).sqrt()) / bessel_i0(KAISER_BETA);
        }
        taps
    }

    /// Wanted frequency response: the droop of the DAC's hold, divided by the droop of the triangle decimator and by
    /// that of the spline.
    fn shape(&self, frequency: f64) -> f64 {
        let hold = sinc(frequency / self.sample_rate_hz);
        let n = self.coarse as f64;
        let block = sinc(n * frequency / self.sample_rate_hz) / sinc(frequency / self.sample_rate_hz);
        let spline = sinc((frequency - self.centre_hz) / self.rate_hz()).powi(6);
        hold / (block * block * spline)
    }
}

fn sinc(turns: f64) -> f64 {
    let x = PI * turns;
    if x.abs() < 1e-9 { 1.0 } else { x.sin() / x }
}

/// Modified Bessel function I0, power series (DLMF 10.25.2).
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..60 {
        term *= quarter / f64::from(k * k);
        sum += term;
    }
    sum
}

/// The filter with its state: codes in, spline coefficients out.
#[derive(Debug, Clone)]
pub(crate) struct AnalyticDrive {
    arch: Arch,
    plan: BandPlan,
    /// Taps in time order (oldest first), split for the dot product.
    tap_re: Vec<f64>,
    tap_im: Vec<f64>,
    /// The last samples after the first decimation, as many as there are taps; each is stored twice, so that a window
    /// of that length is always contiguous.
    history: Vec<f64>,
    write: usize,
    /// Triangle decimator: position in the block, the weighted sum that ends with this block, and the one that begins
    /// with it.
    place: usize,
    ending: f64,
    beginning: f64,
    /// Samples after the first decimation until the next output.
    wait: usize,
    phase: usize,
    /// What the drive has beside the actuator's resonance.
    curve: Option<DriveFilter>,
}

impl AnalyticDrive {
    pub(crate) fn new(plan: BandPlan, rate_of_drive: bool, curve: Option<DriveFilter>) -> Self {
        let taps = plan.taps(rate_of_drive);
        let count = taps.len();
        Self {
            arch: Arch::new(),
            plan,
            tap_re: taps.iter().rev().map(|tap| tap.re).collect(),
            tap_im: taps.iter().rev().map(|tap| tap.im).collect(),
            history: vec![0.0; 2 * count],
            write: 0,
            place: 0,
            ending: 0.0,
            beginning: 0.0,
            wait: plan.fine,
            phase: 0,
            curve,
        }
    }

    /// Delay of the filters, seconds: from a code to the spline coefficient whose taps it is in the middle of.
    pub(crate) fn delay_s(&self) -> f64 {
        let coarse = self.plan.coarse as f64;
        let triangle = if self.plan.coarse > 1 { coarse - 1.0 } else { 0.0 };
        let band = ((self.tap_re.len() / 2) as f64 * coarse + triangle) / self.plan.sample_rate_hz;
        self.curve.as_ref().map_or(band, |curve| band + curve.delay() as f64 / self.plan.rate_hz())
    }

    /// Clears the history of codes. The mixing phase goes on.
    pub(crate) fn rest(&mut self) {
        self.history.fill(0.0);
        self.ending = 0.0;
        self.beginning = 0.0;
        if let Some(curve) = &mut self.curve {
            curve.rest();
        }
    }

    /// Takes one code (-1..=1 of full scale); returns a coefficient when one is due.
    pub(crate) fn push(&mut self, code: f64) -> Option<Complex64> {
        let coarse = self.plan.coarse;
        if coarse == 1 {
            return self.push_middle(code);
        }
        let n = coarse as f64;
        self.place += 1;
        let rising = self.place as f64;
        self.ending += code * (n - rising);
        self.beginning += code * rising;
        if self.place < coarse {
            return None;
        }
        let sample = self.ending / (n * n);
        self.place = 0;
        self.ending = self.beginning;
        self.beginning = 0.0;
        self.push_middle(sample)
    }

    fn push_middle(&mut self, sample: f64) -> Option<Complex64> {
        let count = self.tap_re.len();
        self.history[self.write] = sample;
        self.history[self.write + count] = sample;
        self.write = (self.write + 1) % count;
        self.wait -= 1;
        if self.wait > 0 {
            return None;
        }
        self.wait = self.plan.fine;
        let window = &self.history[self.write..self.write + count];
        let filter = kernel::Filter { window, tap_re: &self.tap_re, tap_im: &self.tap_im };
        let (re, im) = self.arch.dispatch(filter);
        let value = Complex64::new(re, im);
        let mixed = value * Complex64::cis(TAU * self.phase as f64 / CYCLE as f64);
        self.phase = (self.phase + self.plan.turn) % CYCLE;
        Some(self.curve.as_mut().map_or(mixed, |curve| curve.push(mixed)))
    }
}

/// Pieces of the quintic B-spline, times 120: between the samples k (t = 0) and k + 1 (t = 1) the spline coefficient
/// c[k - 2 + j] has the weight sum over i of `BSPLINE[j][i]` t^i.
pub(crate) const BSPLINE: [[f64; 6]; 6] = [
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tone_in_the_band_comes_out_as_a_steady_phasor_of_its_own_amplitude() {
        for (rate, low, high) in
            [(400e3, 6400.0, 40e3), (400e3, 87.0, 219.0), (200e3, 20e3, 40e3), (400e3, 5e3, 170e3)]
        {
            let plan = BandPlan::new(rate, low, high);
            for tone in [low, (low * high).sqrt(), high] {
                let mut drive = AnalyticDrive::new(plan, false, None);
                let mut found = Vec::new();
                let samples = (drive.delay_s() * rate * 2.5) as usize + 12 * plan.coarse * plan.fine;
                for n in 0..samples {
                    if let Some(value) = drive.push((TAU * tone * n as f64 / rate).cos()) {
                        found.push(value);
                    }
                }
                let tail = &found[found.len() - 8..];
                // The spline's own droop, undone in the coefficients, comes back when the curve is drawn.
                let wanted = sinc(tone / rate) / sinc((tone - plan.centre_hz) / plan.rate_hz()).powi(6);
                for value in tail {
                    assert!(
                        (value.norm() / wanted - 1.0).abs() < 1.5e-3,
                        "{tone} Hz: {} for {wanted}",
                        value.norm()
                    );
                }
            }
        }
    }

    #[test]
    fn the_spline_pieces_sum_to_one_and_join_smoothly() {
        for t in [0.0_f64, 0.3, 1.0] {
            let sum: f64 = BSPLINE
                .iter()
                .flat_map(|piece| piece.iter().enumerate().map(move |(i, c)| c * t.powi(i as i32)))
                .sum();
            assert!((sum - 120.0).abs() < 1e-12);
        }
        for j in 1..6 {
            let end: f64 = BSPLINE[j].iter().sum();
            assert!((end - BSPLINE[j - 1][0]).abs() < 1e-12, "piece {j}");
        }
    }
}
