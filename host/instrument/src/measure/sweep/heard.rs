//! A recording of the sweep by a separate recorder with its own clock: a phone, an audio interface.
//!
//! ```text
//! Sound, PlayedSweep --finding--> where both sweeps are
//!                    --clock----> the recorder's rate: its values between the two sweeps over the device's time
//!                    --reference, deconvolution, gate--> responses, noise --two levels--> whether the gain was fixed
//! ```
//! All computations are in the device's time. The time at which the plate's response begins is not known: it
//! is estimated as the onset of the ring. Responses are the file's full scale over the DAC's, and include the
//! recorder's gain.

mod clock;
mod finding;
mod reference;
mod steadiness;

use super::deconvolution::{Answer, Spectra, smooth, spectrum};
use super::played::{Codes, PlayedSweep};
use super::recording::{headroom_db, mark_clipped_at, mean, mean_square};
use crate::measure::error::MeasureError;
use reference::Reference;
use rustfft::num_complex::Complex;
use slipline_model::wav::Sound;
use slipline_plate::calibrate::{MeasuredPoint, POINTS};
use slipline_plate::quantity::number_format::with_decimals;
use slipline_plate::quantity::{must_be, show_frequency};
use std::f64::consts::TAU;
use thiserror::Error;

/// Highest evaluated frequency over the recorder's rate; above it the recorder's filter begins.
const HIGHEST: f64 = 0.45;
/// Band in which W falls, over the recorder's rate, if the sweep continues above.
const FALLS: (f64, f64) = (0.46, 0.49);
/// Largest relative deviation of a recorder's clock from the device's.
const CLOCK: f64 = 1e-3;
/// Smallest coherence of two recordings of one sweep.
const COHERENT: f64 = 0.3;
/// Share of a period from which a flat top is a clipped one. A sine at 40 dB below full scale in 16 bits is
/// flat for 4 %.
const FLAT: f64 = 0.08;
/// Fade of a window's ends, as a share of the ring time.
const FADE: f64 = 0.25;
/// Share of its peak at which a ring begins.
const ONSET: f64 = 0.1;
/// Smallest number of equal values in a flat top.
const FLAT_LEAST: usize = 4;

/// Responses from a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct HeardSweep {
    /// The responses: the file's full scale over the DAC's, with time from the beginning of the plate's
    /// response.
    pub points: Vec<MeasuredPoint>,
    /// The sample rate of the DAC, Hz: its hold is in the responses.
    pub dac_rate_hz: f64,
    /// Beginning of the plate's response to the first sweep, seconds of the recording.
    pub begin_s: f64,
    /// Relative deviation of the recorder's clock from the device's, positive if it runs faster.
    pub clock: f64,
    /// Standard deviation of `clock`.
    pub clock_deviation: f64,
    /// Number of played frequencies above 0.45 of the recorder's rate.
    pub left_out: usize,
    /// 0.45 of the recorder's rate, Hz.
    pub highest_hz: f64,
}

/// Why a recording was refused.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum HeardError {
    /// The recording is shorter than a sweep, or all its values are the same.
    #[error("the recording is shorter than the sweep, or silent")]
    Silent,
    /// No sweep was found.
    #[error("the sweep is not in the recording: is it the right channel, and the description of this sweep?")]
    NotFound,
    /// The second sweep was not found.
    #[error("only one of the two sweeps is in the recording, at {} s: record both in one file, at a fixed gain", with_decimals(*.begin_s, 2))]
    OnlyOne {
        /// Where it begins, seconds.
        begin_s: f64,
    },
    /// The end of the second sweep is missing.
    #[error("the recording ends {} s before the second sweep has rung out: let it run until the device has stopped", with_decimals(*.missing_s, 2))]
    TooShort {
        /// Missing time, seconds.
        missing_s: f64,
    },
    /// The two sweeps were not recorded alike.
    #[error(
        "the two sweeps in the recording are not alike: did anything move, or does the recorder suppress noise?"
    )]
    Unlike,
    /// The clocks differ too much.
    #[error("{0}")]
    Clock(String),
    /// The gain was not fixed.
    #[error("the sweep at half the level is recorded {} dB too {} near {}: the recorder changes its gain, or distorts. Switch automatic gain, limiter and noise suppression off, or lower its gain", with_decimals(.decibel.abs(), 1), if *.decibel > 0.0 { "loud" } else { "quiet" }, show_frequency(*.frequency_hz))]
    Gain {
        /// Level of the second sweep over half of the first one, dB.
        decibel: f64,
        /// Frequency of the largest difference, Hz.
        frequency_hz: f64,
    },
    /// Too few frequencies lie within the recorder's band.
    #[error("{count} of the frequencies are below {}, 0.45 of the recorder's rate: at least {} are needed. Record at a higher rate", show_frequency(*.highest_hz), POINTS.least)]
    Band {
        /// Their number.
        count: usize,
        /// 0.45 of the recorder's rate, Hz.
        highest_hz: f64,
    },
    /// The description of the sweep cannot be rendered.
    #[error(transparent)]
    Played(#[from] MeasureError),
}

impl HeardSweep {
    /// Reads a recording of a sweep.
    ///
    /// # Errors
    /// [`HeardError`]: what is wrong with it, and the remedy.
    pub fn new(sound: &Sound, sweep: &PlayedSweep) -> Result<Self, HeardError> {
        let chirp = sweep.chirp();
        let highest_hz = HIGHEST * sound.rate_hz;
        let all_hz = chirp.measured_hz();
        let frequencies: Vec<f64> = all_hz.iter().copied().filter(|hz| *hz <= highest_hz).collect();
        if frequencies.len() < POINTS.least {
            return Err(HeardError::Band { count: frequencies.len(), highest_hz });
        }
        let mut gate = chirp.gate();
        if gate.falls_hz.1 > FALLS.1 * sound.rate_hz {
            gate.falls_hz = (FALLS.0 * sound.rate_hz, FALLS.1 * sound.rate_hz);
        }
        let Codes { first, second } = sweep.codes()?;
        let reference = |codes: &[f64]| {
            Reference::new(codes, chirp.rate_hz, gate.falls_hz.1).ok_or(MeasureError::Unknown)
        };
        let (loud, quiet) = (reference(&first)?, reference(&second)?);
        let rate_hz = sound.rate_hz;
        let samples = |samples: u64| samples as f64 / chirp.rate_hz * rate_hz;
        let apart = samples(sweep.apart).round() as usize;
        // The beginning is known to within a ring; the remaining window is faded, so that a hum stays in its
        // bins.
        let fade = (FADE * chirp.ring_s * rate_hz) as usize + 16;
        let clocks_s = CLOCK * sweep.apart as f64 / chirp.rate_hz;
        let slack = ((chirp.ring_s + clocks_s) * rate_hz) as usize + fade;
        let at = finding::begin(sound, &loud, &gate, [samples(chirp.samples) as usize, apart, slack])?;

        // Both windows extend from a slack before to a slack after the sweep.
        let length = (samples(chirp.samples) + chirp.tail_s() * rate_hz) as usize + 2 * slack;
        let needed = (at + apart + length).saturating_sub(2 * slack);
        if needed > sound.values.len() {
            return Err(HeardError::TooShort { missing_s: (needed - sound.values.len()) as f64 / rate_hz });
        }
        let count = length.next_power_of_two();
        let part = |begin: usize| {
            let before = slack.saturating_sub(begin);
            let from = (begin + before - slack).min(sound.values.len());
            let end = (begin + length - slack).min(sound.values.len()).max(from);
            let silence = std::iter::repeat_n(0.0, before);
            let mut values: Vec<f64> = silence.chain(sound.values[from..end].iter().copied()).collect();
            values.resize(length, 0.0);
            for place in 0..fade {
                let share = smooth(place as f64, (0.0, fade as f64));
                values[place] *= share;
                values[length - 1 - place] *= share;
            }
            spectrum(&values, count).ok_or(HeardError::Silent)
        };
        let (one, other) = (part(at)?, part(at + apart)?);
        // The response begins at most a slack earlier.
        let between = |begin: usize| {
            let from = begin + length - 2 * slack;
            let end = (begin + apart).saturating_sub(slack).min(sound.values.len());
            sound.values.get(from..end).filter(|values| values.len() > 16).map(<[f64]>::to_vec)
        };
        let mut noise = between(at).ok_or(HeardError::Unlike)?;
        let offset = mean(&noise);
        noise.iter_mut().for_each(|value| *value -= offset);

        let weight = |bin: usize| gate.band(bin as f64 * rate_hz / count as f64);
        let within = (CLOCK * apart as f64) as usize + 2;
        let floor = mean_square(&noise).max(sound.step * sound.step / 12.0) * length as f64;
        let later = clock::delay(&one, &other, weight, floor, within).ok_or(HeardError::Silent)?;
        if later.coherence < COHERENT {
            return Err(HeardError::Unlike);
        }
        let clock = (apart as f64 + later.values) / samples(sweep.apart) - 1.0;
        if clock.abs() > CLOCK {
            let given = format_args!(
                "the recorder's clock is {} ppm from the device's",
                with_decimals(1e6 * clock, 0)
            );
            return Err(HeardError::Clock(must_be(given, "-1000 to 1000 ppm")));
        }
        let true_hz = rate_hz * (1.0 + clock);
        let played = |reference: &Reference| {
            let bin_hz = true_hz / count as f64;
            let bins = ((gate.falls_hz.1 / bin_hz).ceil() as usize + 2).min(count / 2 + 1);
            let mut played = reference.spectrum(bin_hz, bins);
            // A recorder takes fewer values in the same time than the device plays codes.
            played.iter_mut().for_each(|x| *x *= true_hz / chirp.rate_hz);
            played.resize(count / 2 + 1, Complex::default());
            played
        };
        let rounding = sound.step * sound.step / 12.0;
        let loud = played(&loud);
        let of = |played: &[Complex<f64>], heard: &[Complex<f64>]| -> Option<Vec<Answer>> {
            let noise = &noise;
            Spectra { played, heard, noise, rounding, rate_hz: true_hz }.responses(&gate, &frequencies)
        };
        let silent = || HeardError::Played(MeasureError::Unknown);
        let impulse = Spectra { played: &loud, heard: &one, noise: &noise, rounding, rate_hz: true_hz }
            .impulse(&gate)
            .ok_or_else(silent)?;
        let onset = onset(&impulse, 2 * slack, (chirp.ring_s * true_hz) as usize);
        let answers = of(&loud, &earlier(&one, onset as f64)).ok_or_else(silent)?;
        let repeated =
            of(&played(&quiet), &earlier(&other, onset as f64 + later.values)).ok_or_else(silent)?;
        steadiness::check(&frequencies, &answers, &repeated)?;

        let mut points: Vec<MeasuredPoint> = frequencies
            .iter()
            .zip(&answers)
            .map(|(&frequency_hz, &(response, noise))| {
                let swing = response.norm() * sweep.level * sweep.gain(frequency_hz) + offset.abs();
                // Floating point has no end of range.
                let headroom_db = sound.end.map(|_| headroom_db(swing));
                MeasuredPoint { frequency_hz, response, noise: noise.max(1e-30), headroom_db }
            })
            .collect();
        let begin = at as f64 - slack as f64 + onset as f64;
        let played_hz =
            |place: usize| chirp.frequency_hz((place as f64 - begin).max(0.0) / true_hz * chirp.rate_hz);
        let swept = begin..begin + samples(chirp.samples);
        for place in clipped(sound, played_hz).into_iter().filter(|&place| swept.contains(&(place as f64))) {
            if played_hz(place) <= highest_hz {
                mark_clipped_at(played_hz(place), &mut points);
            }
        }
        Ok(Self {
            points,
            dac_rate_hz: chirp.rate_hz,
            begin_s: begin / rate_hz,
            clock,
            clock_deviation: later.deviation / apart as f64,
            left_out: all_hz.len() - frequencies.len(),
            highest_hz,
        })
    }

    /// Number of responses for which the input was at the end of its range.
    #[must_use]
    pub fn clipped(&self) -> usize {
        self.points.iter().filter(|point| point.headroom_db == Some(0.0)).count()
    }

    /// Notes about the recording, as sentences.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let ppm = |share: f64, decimals: usize| with_decimals(1e6 * share, decimals);
        let (deviation, clipped) = (2.0 * self.clock_deviation, self.clipped());
        let found = format!(
            "The sweep begins at {} s, and the recorder's clock is {} ppm {} (to {} ppm).",
            with_decimals(self.begin_s, 3),
            ppm(self.clock.abs(), 2),
            if self.clock < 0.0 { "slow" } else { "fast" },
            ppm(deviation, 2),
        );
        let left_out = (self.left_out > 0).then(|| {
            format!(
                "{} frequencies above {}, 0.45 of the recorder's rate, are left out.",
                self.left_out,
                show_frequency(self.highest_hz)
            )
        });
        let clipped = (clipped > 0).then(|| {
            format!(
                "The recording is clipped at {clipped} frequencies: lower the level or the recorder's gain."
            )
        });
        [Some(found), left_out, clipped].into_iter().flatten().collect()
    }
}

/// Spectrum of the signal advanced by this number of values.
fn earlier(bins: &[Complex<f64>], by: f64) -> Vec<Complex<f64>> {
    let count = 2 * (bins.len() - 1);
    let turn = |bin: usize| Complex::cis(TAU * (bin as f64 * by / count as f64).fract());
    bins.iter().enumerate().map(|(bin, value)| value * turn(bin)).collect()
}

/// Onset of a ring among the first places: where the impulse response first reaches a share of its peak,
/// within one ring before the peak.
fn onset(impulse: &[f64], places: usize, ring: usize) -> usize {
    let size = |place: &usize| impulse[*place].abs();
    let places = places.min(impulse.len());
    let peak = (0..places).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0);
    (peak.saturating_sub(ring)..peak).find(|place| size(place) > ONSET * size(&peak)).unwrap_or(peak)
}

/// Places where a recording is at the end of its range: at the file's largest values, or at flat tops of its
/// largest and lowest value. `played_hz` is the frequency played at a place.
fn clipped(sound: &Sound, played_hz: impl Fn(usize) -> f64) -> Vec<usize> {
    let (low, high) = sound.values.iter().fold((0.0_f64, 0.0_f64), |(a, b), &v| (a.min(v), b.max(v)));
    let mut places = Vec::new();
    let mut from = 0;
    while from < sound.values.len() {
        let value = sound.values[from];
        let end = sound.values[from..].iter().position(|other| other != &value);
        let count = end.unwrap_or(sound.values.len() - from);
        let is_extreme = value != 0.0 && (value == low || value == high);
        if is_extreme {
            let period = sound.rate_hz / played_hz(from);
            let is_flat = count >= FLAT_LEAST && count as f64 > FLAT * period;
            if is_flat || sound.end.is_some_and(|end| value.abs() >= end) {
                places.extend(from..from + count);
            }
        }
        from += count;
    }
    places
}

#[cfg(test)]
mod tests;
