//! Conversion of DAC codes to the slowly varying complex drive of the oscillators.
//!
//! The DAC holds each code for one sample. Only the plate's band of that staircase has an effect. A band filter takes
//! it as an analytic signal (only e^(-j omega t) with omega > 0), which is shifted down by the band's middle and
//! decimated. The results are the coefficients of a quintic B-spline; its curve is the drive also between the decimated
//! samples, so the oscillators can be integrated exactly. The filter keeps the droop of the DAC's hold and cancels the
//! spline's droop.

use super::band_plan::{BandPlan, CYCLE};
use super::drive_filter::DriveFilter;
use crate::time::kernel;
use num_complex::Complex64;
use pulp::Arch;
use std::f64::consts::TAU;

/// The filter with its state: codes in, spline coefficients out.
#[derive(Debug, Clone)]
pub(crate) struct AnalyticDrive {
    arch: Arch,
    plan: BandPlan,
    /// Taps in time order (oldest first), split for the dot product.
    tap_re: Vec<f64>,
    tap_im: Vec<f64>,
    /// The last samples after the first decimation, as many as there are taps; each is stored twice, so that every
    /// window of that length is contiguous.
    history: Vec<f64>,
    write: usize,
    /// Triangle decimator: position in the block, the weighted sum that ends with this block, and the one that starts
    /// with it.
    place: usize,
    ending: f64,
    beginning: f64,
    /// Samples after the first decimation until the next output.
    wait: usize,
    phase: usize,
    /// Filter for the response of the drive besides the actuator's resonance; `None` if it has no other.
    curve: Option<DriveFilter>,
}

impl AnalyticDrive {
    pub(crate) fn new(plan: BandPlan, curve: Option<DriveFilter>) -> Self {
        let taps = plan.taps();
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

    /// Delay of the filters, seconds: from the middle of the hold of a code to the end of the hold of the code that
    /// completes the coefficient centred on it.
    pub(crate) fn delay_s(&self) -> f64 {
        let coarse = self.plan.coarse as f64;
        // The largest weight of the triangle is on the last code of the block before.
        let triangle = if self.plan.coarse > 1 { coarse } else { 0.0 };
        let band = ((self.tap_re.len() / 2) as f64 * coarse + triangle + 0.5) / self.plan.sample_rate_hz;
        self.curve.as_ref().map_or(band, |curve| band + curve.delay() as f64 / self.plan.rate_hz())
    }

    /// Clears the history of codes. The mixing phase is kept.
    pub(crate) fn rest(&mut self) {
        self.history.fill(0.0);
        self.ending = 0.0;
        self.beginning = 0.0;
        if let Some(curve) = &mut self.curve {
            curve.rest();
        }
    }

    /// Takes one code (-1 to 1 of full scale); returns a coefficient when one is complete.
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
    use crate::special::sinc::sinc;

    #[test]
    fn a_tone_in_the_band_comes_out_as_a_steady_phasor_of_its_own_amplitude() {
        for (rate, low, high) in
            [(400e3, 6400.0, 40e3), (400e3, 87.0, 219.0), (200e3, 20e3, 40e3), (400e3, 5e3, 170e3)]
        {
            let plan = BandPlan::new(rate, low, high);
            for tone in [low, (low * high).sqrt(), high] {
                let mut drive = AnalyticDrive::new(plan, None);
                let mut found = Vec::new();
                let samples = (drive.delay_s() * rate * 2.5) as usize + 12 * plan.coarse * plan.fine;
                for n in 0..samples {
                    if let Some(value) = drive.push((TAU * tone * n as f64 / rate).cos()) {
                        found.push(value);
                    }
                }
                let tail = &found[found.len() - 8..];
                // The coefficients compensate the droop of the spline, so it is divided out here.
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
