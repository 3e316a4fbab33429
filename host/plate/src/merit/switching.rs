//! Switching time of a boundary: the time from switching its tone on to its final amplitude, by the plate in time.
//!
//! The field at the peak, divided by the tone's own phasor, rises from 0 to the steady amplitude. The line gives it at
//! every step; between two steps it is interpolated. Its last crossing of the limit is the switching time.

use crate::texture::{PLACES, Palette, TextureError};
use crate::time::TimeDomainLine;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Relative deviation from the final amplitude below which a boundary counts as switched.
const SWITCHED: f64 = 0.1;
/// Simulated time, as a fraction of the time in which a change decays to a thousandth: after it, a change has decayed
/// to a twentieth or less.
const WATCHED: f64 = 0.5;
/// Interpolated amplitudes per step of the line.
const FINE: usize = 16;
/// Number of steps from which an amplitude between them is interpolated.
const NEIGHBOURS: usize = 6;

/// The peak of a boundary's own tone at level 1.
pub(super) struct Peak {
    frequency_hz: f64,
    /// DAC amplitude, 0 to 1.
    gain: f64,
    /// Index of the palette's place nearest to the peak.
    place: usize,
    /// Displacement amplitude at that place, metres.
    amplitude_m: f64,
}

impl Peak {
    pub(super) fn of(palette: &Palette<'_>, turning_point_m: f64) -> Result<Self, TextureError> {
        let table = palette.table();
        let columns = palette.squares(&[turning_point_m])?;
        let squares = columns.column(0);
        // Where loss leaves no peak, the table levels the amplitude at the turning point.
        let turning = turning_point_m / palette.plate().length_m() * (PLACES - 1) as f64;
        let place = Some(last_top(squares)).filter(|&top| top > 0).unwrap_or(turning.round() as usize);
        Ok(Self {
            frequency_hz: table.frequency_hz(turning_point_m),
            gain: table.gain(turning_point_m),
            place,
            amplitude_m: (2.0 * squares[place]).sqrt() * table.peak_at_full_scale_m(),
        })
    }

    /// Time from the code that switches the tone on until the peak stays within 10 % of its amplitude, seconds; `None`
    /// if the plate has no time-domain line.
    pub(super) fn switching_time_s(&self, palette: &Palette<'_>) -> Option<f64> {
        let rate_hz = palette.table().sample_rate_hz();
        let line = TimeDomainLine::new(palette.plate(), rate_hz, PLACES).ok()?;
        let mut line = line.with_every_step();
        let block = (rate_hz / line.step_rate_hz()).round().max(1.0) as usize;
        let steps = (WATCHED * line.settle_time_s() * rate_hz) as usize / block;
        let turn = TAU * self.frequency_hz / rate_hz;
        let mut field = vec![Complex64::ZERO; self.place + 1];
        let mut phasors = Vec::with_capacity(steps);
        for step in 0..steps {
            let after = (step + 1) * block;
            let code = |n: usize| (self.gain * (turn * n as f64).cos()) as f32;
            line.push(&(after - block..after).map(code).collect::<Vec<f32>>());
            line.analytic_m(&mut field);
            phasors.push(field[self.place] * Complex64::cis(turn * after as f64));
        }
        let step = last_crossing(&phasors, self.amplitude_m)?;
        Some((step + 1.0) * block as f64 / rate_hz - line.latency_s())
    }
}

/// The time, in steps, from which the magnitude of `phasors` stays within [`SWITCHED`] of `amplitude`; the last step if
/// it does not, `None` if there are no steps.
fn last_crossing(phasors: &[Complex64], amplitude: f64) -> Option<f64> {
    let last = phasors.len().checked_sub(1)? * FINE;
    let outside = |fine: usize| {
        let phasor = between(phasors, fine as f64 / FINE as f64);
        (phasor.norm() / amplitude - 1.0).abs() - SWITCHED
    };
    let fine = (0..=last).rev().find(|&fine| outside(fine) > 0.0).unwrap_or(0);
    let (out, next) = (outside(fine), outside((fine + 1).min(last)));
    let part = if next < out { out / (out - next) } else { 0.0 };
    Some((fine as f64 + part) / FINE as f64)
}

/// The value at a fractional step, by Lagrange interpolation through the nearest [`NEIGHBOURS`] values.
fn between(values: &[Complex64], at: f64) -> Complex64 {
    let count = NEIGHBOURS.min(values.len());
    let first = (at.floor() as usize + 1).saturating_sub(count / 2).min(values.len() - count);
    let weight = |i: usize| -> f64 {
        let others = (first..first + count).filter(|&j| j != i);
        others.map(|j| (at - j as f64) / (i as f64 - j as f64)).product()
    };
    (first..first + count).map(|i| values[i] * weight(i)).sum()
}

/// Index of the last local maximum of a field; 0 if there is none.
pub(super) fn last_top(field: &[f64]) -> usize {
    (1..field.len() - 1).rev().find(|&i| field[i] >= field[i - 1] && field[i] > field[i + 1]).unwrap_or(0)
}

#[cfg(test)]
mod tests;
