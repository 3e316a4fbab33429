//! The source: DAC codes are converted to the step rate, filtered by the actuator and applied to the driven column.

use super::drive::CurvedDrive;
use crate::definition::actuator::Resonator;
use crate::definition::drive::DriveEnd;
use crate::definition::plate::Plate;
use crate::definition::sample_rate::SAMPLE_RATE_MAX_HZ;
use crate::quantity::{OutOfRange, Range};
use crate::sheet::SheetError;
use std::f64::consts::PI;

/// Most steps per code, and most codes per step.
const RATIO_MAX: f64 = 1e6;

/// Steps per code or codes per step: a whole number, so that steps and samples keep the same clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StepRatio {
    /// One step takes the mean of this many codes: the grid is coarse.
    CodesPerStep(u32),
    /// One code is held for this many steps: the grid is fine.
    StepsPerCode(u32),
}

impl StepRatio {
    /// The ratio with the longest step that is at most `longest_step_s`, the limit of stability.
    ///
    /// # Errors
    /// The sample rates that are allowed, if a code would take more than a million steps.
    pub(super) fn new(sample_rate_hz: f64, longest_step_s: f64) -> Result<Self, OutOfRange> {
        let rates = Range::new(1.0 / (RATIO_MAX * longest_step_s), SAMPLE_RATE_MAX_HZ, "");
        OutOfRange::check("sample_rate_hz", sample_rate_hz, rates)?;
        let codes = longest_step_s * sample_rate_hz;
        Ok(if codes >= 1.0 {
            Self::CodesPerStep(codes.min(RATIO_MAX) as u32)
        } else {
            Self::StepsPerCode((1.0 / codes).ceil() as u32)
        })
    }

    pub(super) fn step_s(self, sample_rate_hz: f64) -> f64 {
        match self {
            Self::CodesPerStep(codes) => f64::from(codes) / sample_rate_hz,
            Self::StepsPerCode(steps) => 1.0 / (sample_rate_hz * f64::from(steps)),
        }
    }
}

/// The term that the source adds to the update of the driven column in each step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SourceTerm {
    /// The displacement itself.
    Value,
    /// This factor times the displacement (a force).
    Scaled(f64),
    /// This factor times the change of the displacement over two steps (a source behind a resistance).
    Change(f64),
}

/// The condition at x = 0 in the time domain.
///
/// In the frequency domain it is f' + j (R/T) omega f = 2 j (R/T) omega u; with e^(-j omega t) that is
/// v_x = rho (v_t - 2 u_t), rho = R/T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DriveCondition {
    /// v = u.
    Displacement,
    /// v_x = -slope u.
    Force { slope_per_m: f64 },
    /// v_x = rho (v_t - 2 u_t), everywhere on the end; [`crate::plane`] resists the first width mode only.
    Resistance { rho_s_per_m: f64 },
}

impl DriveCondition {
    pub(super) fn of(plate: &Plate) -> Result<Self, SheetError> {
        let width_mode = plate.width_mode(1);
        let k0 = |frequency_hz: f64| width_mode.wavenumber_squared(0.0, frequency_hz).max(0.0).sqrt();
        Ok(match plate.spec().drive_end {
            DriveEnd::Displacement => Self::Displacement,
            DriveEnd::Force { at_frequency_hz } => Self::Force { slope_per_m: k0(at_frequency_hz) },
            DriveEnd::Resistance { ratio, at_frequency_hz } => {
                Self::Resistance { rho_s_per_m: ratio * k0(at_frequency_hz) / (2.0 * PI * at_frequency_hz) }
            }
            DriveEnd::DisplacementAndSlope { .. } | DriveEnd::Source(_) => {
                return Err(SheetError::DriveEnd { plate: plate.name().to_owned() });
            }
        })
    }
}

/// Turns codes into the source terms of the driven column.
#[derive(Debug, Clone)]
pub(super) struct Source {
    ratio: StepRatio,
    term: SourceTerm,
    actuator: Option<DiscreteResonator>,
    curve: Option<CurvedDrive>,
    sum: f64,
    taken: u32,
    /// The source's displacement one and two steps before.
    last: [f64; 2],
}

impl Source {
    pub(super) fn new(
        ratio: StepRatio,
        step_s: f64,
        term: SourceTerm,
        actuator: Option<&Resonator>,
        curve: Option<CurvedDrive>,
    ) -> Self {
        let actuator = actuator.and_then(|actuator| DiscreteResonator::new(actuator, step_s));
        Self { ratio, term, actuator, curve, sum: 0.0, taken: 0, last: [0.0; 2] }
    }

    /// Goes on with another term.
    pub(super) fn set_term(&mut self, term: SourceTerm) {
        self.term = term;
    }

    /// Number of codes that give at most `steps` steps; at least one.
    pub(super) fn codes_for(&self, steps: usize) -> usize {
        match self.ratio {
            StepRatio::StepsPerCode(count) => (steps / count as usize).max(1),
            StepRatio::CodesPerStep(_) => steps,
        }
    }

    /// Appends the source's term for each step that `codes` complete. Codes are clamped to -1..1; NaN and infinity
    /// count as zero.
    pub(super) fn take(&mut self, codes: &[f32], steps: &mut Vec<f32>) {
        // On a coarse grid many codes make one step, and the loop over the codes takes most of the time.
        if self.curve.is_some() {
            self.take_each::<true>(codes, steps);
        } else {
            self.take_each::<false>(codes, steps);
        }
    }

    /// As [`Source::take`]. `CURVED`: whether there is a curve.
    fn take_each<const CURVED: bool>(&mut self, codes: &[f32], steps: &mut Vec<f32>) {
        for &code in codes {
            let code = if code.is_finite() { f64::from(code.clamp(-1.0, 1.0)) } else { 0.0 };
            if CURVED && let Some(curve) = &mut self.curve {
                curve.push(code);
            }
            match self.ratio {
                StepRatio::StepsPerCode(count) => {
                    for step in 0..count {
                        let drive = match &self.curve {
                            Some(curve) if CURVED => curve.at(f64::from(step) / f64::from(count)),
                            _ => code,
                        };
                        self.step(drive, steps);
                    }
                }
                StepRatio::CodesPerStep(count) => {
                    self.sum += code;
                    self.taken += 1;
                    if self.taken == count {
                        let mean = self.sum / f64::from(count);
                        (self.sum, self.taken) = (0.0, 0);
                        let drive = match &self.curve {
                            Some(curve) if CURVED => curve.at(0.0),
                            _ => mean,
                        };
                        self.step(drive, steps);
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
            // The update to step n + 1 takes the force at step n.
            SourceTerm::Scaled(factor) => factor * self.last[0],
            SourceTerm::Change(factor) => factor * (displacement - self.last[1]),
        };
        self.last = [displacement, self.last[0]];
        steps.push(value as f32);
    }
}

/// The actuator in the time domain: u'' + (w0/Q) u' + w0^2 u = w0^2 s by the trapezoidal rule, which is always stable.
/// The factor tan(w0 dt/2) (frequency pre-warping) makes the resonance frequency exact.
#[derive(Debug, Clone)]
struct DiscreteResonator {
    g: f64,
    damping: f64,
    speed: f64,
    place: f64,
}

impl DiscreteResonator {
    /// `None` if the resonance is above 0.45 of the step rate: it is then far above the plate's band and has no effect.
    fn new(actuator: &Resonator, step_s: f64) -> Option<Self> {
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
