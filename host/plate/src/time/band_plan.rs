//! The band of a plate's drive in the time domain: its centre frequency, its decimation and its filter.

use crate::special::sinc::sinc;
use num_complex::Complex64;
use std::f64::consts::TAU;

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
    /// Edges of the band filter (half amplitude), Hz.
    low_hz: f64,
    high_hz: f64,
    transition_hz: f64,
    /// Half of the width of the band, stop band edges included, Hz.
    pub(crate) half_band_hz: f64,
    /// The phase of `centre_hz` advances by `turn/CYCLE` of a full turn per output sample.
    pub(super) turn: usize,
}

/// Output samples after which the mixing phase repeats.
pub(super) const CYCLE: usize = 256;
/// Kaiser's beta for a stop band of 90 dB.
const KAISER_BETA: f64 = 8.96;

impl BandPlan {
    pub(crate) fn new(sample_rate_hz: f64, low_hz: f64, high_hz: f64) -> Self {
        // Lower transition: from 0.6 down to 0.1 of the lowest frequency, because the mirror image of the band starts
        // below 0 Hz.
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
        // The centre nearest to the middle of the band whose phase repeats after CYCLE output samples.
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

    /// The stop band edges of the band filter, Hz: nothing passes beyond them.
    pub(crate) fn stop_hz(&self) -> (f64, f64) {
        (self.low_hz - 0.5 * self.transition_hz, self.high_hz + 0.5 * self.transition_hz)
    }

    /// Taps of the band filter, newest sample first.
    ///
    /// The taps are the Fourier integral of [`BandPlan::shape`] over the band, times a Kaiser window. The window
    /// smooths the shape a little: at most 0.01 dB, at the ends of the band.
    pub(super) fn taps(&self) -> Vec<Complex64> {
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
            let value = Complex64::from(2.0 * df / rate * self.shape(frequency));
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
