//! The demodulator: separates the complex amplitude of each tone from the field of all tones.

use super::waves::Waves;
use slipline_plate::Complex64;
use std::f64::consts::TAU;

/// Separates the complex amplitude of each tone from the field.
pub(super) struct Demodulator {
    /// Samples per field.
    stride: usize,
    /// Phase per field of each tone, in turns.
    turns: Vec<f64>,
    sums: Vec<Vec<Complex64>>,
    field: Vec<Complex64>,
    step: u64,
    steps: u64,
    weight: f64,
    waiting: usize,
}

impl Demodulator {
    pub(super) fn new(waves: &Waves, rate_hz: f64, frequencies: &[f64], window_s: f64) -> Self {
        let places = waves.positions_m().len();
        let stride = waves.stride;
        let field_rate_hz = rate_hz * waves.held as f64 / stride as f64;
        Self {
            stride,
            turns: frequencies.iter().map(|frequency| frequency / field_rate_hz).collect(),
            sums: vec![vec![Complex64::ZERO; places]; frequencies.len()],
            field: vec![Complex64::ZERO; places],
            step: 0,
            steps: ((window_s * field_rate_hz) as u64).max(1),
            weight: 0.0,
            waiting: 0,
        }
    }

    pub(super) fn push(&mut self, waves: &mut Waves, codes: &[u16]) {
        let samples = waves.samples(codes);
        let mut samples = samples.as_slice();
        while !samples.is_empty() {
            let count = (self.stride - self.waiting).min(samples.len());
            let (now, later) = samples.split_at(count);
            samples = later;
            waves.push_samples(now);
            self.waiting += count;
            if self.waiting == self.stride {
                self.waiting = 0;
                self.take(waves);
            }
        }
    }

    fn take(&mut self, waves: &mut Waves) {
        if self.step >= self.steps {
            return;
        }
        waves.field_m(&mut self.field);
        let place = (self.step as f64 + 0.5) / self.steps as f64;
        let window = 1.0 - (TAU * place).cos();
        self.weight += window;
        for (turns, sums) in self.turns.iter().zip(&mut self.sums) {
            // Multiplication by e^(+j w t) makes the phasor of e^(-j w t) constant.
            let phasor = Complex64::cis(TAU * (turns * self.step as f64).fract()) * window;
            for (sum, value) in sums.iter_mut().zip(&self.field) {
                *sum += phasor * value;
            }
        }
        self.step += 1;
    }

    pub(super) fn fields(self) -> Vec<Vec<Complex64>> {
        let weight = if self.weight > 0.0 { self.weight } else { 1.0 };
        self.sums.into_iter().map(|sums| sums.into_iter().map(|sum| sum / weight).collect()).collect()
    }
}
