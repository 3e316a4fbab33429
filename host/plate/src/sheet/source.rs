//! The source: from DAC codes to the driven column, by way of the step rate, the actuator and the driven end.

use crate::spec::drive::{Actuator, DriveEnd};
use crate::spec::plate::Plate;
use std::f64::consts::PI;

/// Steps per code or codes per step: a whole number, so that steps stay on the sample clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StepRatio {
    /// One step takes the mean of this many codes (a coarse grid is slower than the DAC).
    CodesPerStep(u32),
    /// One code is held for this many steps (a fine grid is faster than the DAC).
    StepsPerCode(u32),
}

impl StepRatio {
    /// The longest step on the sample clock that is not above `longest_step_s`.
    pub(super) fn new(sample_rate_hz: f64, longest_step_s: f64) -> Self {
        let codes = longest_step_s * sample_rate_hz;
        if codes >= 1.0 {
            Self::CodesPerStep(codes.min(1e6) as u32)
        } else {
            Self::StepsPerCode((1.0 / codes).ceil().min(1e6) as u32)
        }
    }

    pub(super) fn step_s(self, sample_rate_hz: f64) -> f64 {
        match self {
            Self::CodesPerStep(codes) => f64::from(codes) / sample_rate_hz,
            Self::StepsPerCode(steps) => 1.0 / (sample_rate_hz * f64::from(steps)),
        }
    }
}

/// What the source adds to the column's update in each step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SourceTerm {
    /// The displacement itself.
    Value,
    /// This factor times the displacement (a force).
    Scaled(f64),
    /// This factor times the displacement's change over two steps (a source behind a resistance).
    Change(f64),
}

/// The column's law at x = 0 in the time domain: v_x = rho v_t - (term), or a prescribed v.
///
/// f' + j (R/T) omega f = 2 j (R/T) omega u of the frequency domain is v_x = rho (v_t - 2 u_t), rho = R/T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DriveCondition {
    Displacement,
    /// v_x = -slope u.
    Force {
        slope_per_m: f64,
    },
    /// v_x = rho (v_t - 2 u_t).
    Resistance {
        rho_s_per_m: f64,
    },
}

impl DriveCondition {
    pub(super) fn of(plate: &Plate) -> Self {
        let width_mode = plate.width_mode(1);
        let k0 = |frequency_hz: f64| width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
        match plate.spec().drive_end {
            DriveEnd::Displacement => Self::Displacement,
            DriveEnd::Force { at_frequency_hz } => Self::Force { slope_per_m: k0(at_frequency_hz) },
            DriveEnd::Resistance { ratio, at_frequency_hz } => {
                Self::Resistance { rho_s_per_m: ratio * k0(at_frequency_hz) / (2.0 * PI * at_frequency_hz) }
            }
        }
    }
}

/// Turns codes into the source terms of the driven column.
#[derive(Debug, Clone)]
pub(super) struct Source {
    ratio: StepRatio,
    term: SourceTerm,
    actuator: Option<Resonator>,
    sum: f64,
    taken: u32,
    /// Displacement one and two steps ago.
    last: [f64; 2],
}

impl Source {
    pub(super) fn new(ratio: StepRatio, step_s: f64, term: SourceTerm, actuator: Option<&Actuator>) -> Self {
        let actuator = actuator.and_then(|actuator| Resonator::new(actuator, step_s));
        Self { ratio, term, actuator, sum: 0.0, taken: 0, last: [0.0; 2] }
    }

    /// How many codes make at most `steps` steps; one at least.
    pub(super) fn codes_for(&self, steps: usize) -> usize {
        match self.ratio {
            StepRatio::StepsPerCode(count) => (steps / count as usize).max(1),
            StepRatio::CodesPerStep(_) => steps,
        }
    }

    /// Appends one number for each step that `codes` complete. Codes that are no numbers count as zero.
    pub(super) fn take(&mut self, codes: &[f32], steps: &mut Vec<f32>) {
        for &code in codes {
            let code = if code.is_finite() { f64::from(code.clamp(-1.0, 1.0)) } else { 0.0 };
            match self.ratio {
                StepRatio::StepsPerCode(count) => {
                    for _ in 0..count {
                        self.step(code, steps);
                    }
                }
                StepRatio::CodesPerStep(count) => {
                    self.sum += code;
                    self.taken += 1;
                    if self.taken == count {
                        let mean = self.sum / f64::from(count);
                        (self.sum, self.taken) = (0.0, 0);
                        self.step(mean, steps);
                    }
                }
            }
        }
    }

    fn step(&mut self, code: f64, steps: &mut Vec<f32>) {
        let displacement = match &mut self.actuator {
            Some(actuator) => actuator.step(code),
            None => code,
        };
        let value = match self.term {
            SourceTerm::Value => displacement,
            // The update to step n + 1 has the force of step n.
            SourceTerm::Scaled(factor) => factor * self.last[0],
            SourceTerm::Change(factor) => factor * (displacement - self.last[1]),
        };
        self.last = [displacement, self.last[0]];
        steps.push(value as f32);
    }
}

/// The actuator's resonance in the time domain: u'' + (w0/Q) u' + w0^2 u = w0^2 s by the trapezoidal rule, with the
/// resonance itself exact; unconditionally stable.
#[derive(Debug, Clone)]
struct Resonator {
    g: f64,
    damping: f64,
    speed: f64,
    place: f64,
}

impl Resonator {
    /// `None` where the resonance lies beyond what the step rate can carry: it is far above the plate's band.
    fn new(actuator: &Actuator, step_s: f64) -> Option<Self> {
        let half_turn = PI * actuator.resonance_hz * step_s;
        (half_turn < 1.4).then(|| Self {
            g: half_turn.tan(),
            damping: 1.0 / actuator.quality,
            speed: 0.0,
            place: 0.0,
        })
    }

    fn step(&mut self, input: f64) -> f64 {
        let speed = (self.speed + self.g * (input - self.place)) / (1.0 + self.g * (self.g + self.damping));
        let place = self.place + self.g * speed;
        self.speed = 2.0 * speed - self.speed;
        self.place = 2.0 * place - self.place;
        place
    }
}
