//! The demodulator: separates the complex amplitude of each tone from the field of all tones.

use slipline_plate::{Complex64, TimeDomainLine};
use std::f64::consts::TAU;

/// Separates the complex amplitude of each tone from the field.
pub(super) struct Demodulator {
    /// Codes per step of the line; a new field exists after each step.
    stride: usize,
    /// Phase per step of each tone, in turns.
    turns: Vec<f64>,
    sums: Vec<Vec<Complex64>>,
    field: Vec<Complex64>,
    step: u64,
    steps: u64,
    weight: f64,
    waiting: usize,
}

impl Demodulator {
    pub(super) fn new(line: &TimeDomainLine, rate_hz: f64, frequencies: &[f64], window_s: f64) -> Self {
        let places = line.positions_m().len();
        Self {
            stride: (rate_hz / line.step_rate_hz()).round().max(1.0) as usize,
            turns: frequencies.iter().map(|frequency| frequency / line.step_rate_hz()).collect(),
            sums: vec![vec![Complex64::ZERO; places]; frequencies.len()],
            field: vec![Complex64::ZERO; places],
            step: 0,
            steps: ((window_s * line.step_rate_hz()) as u64).max(1),
            weight: 0.0,
            waiting: 0,
        }
    }

    pub(super) fn push(&mut self, line: &mut TimeDomainLine, mut codes: &[u16]) {
        while !codes.is_empty() {
            let count = (self.stride - self.waiting).min(codes.len());
            let (now, later) = codes.split_at(count);
            codes = later;
            line.push_codes(now, 12);
            self.waiting += count;
            if self.waiting == self.stride {
                self.waiting = 0;
                self.take(line);
            }
        }
    }

    fn take(&mut self, line: &TimeDomainLine) {
        if self.step >= self.steps {
            return;
        }
        line.analytic_m(&mut self.field);
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
