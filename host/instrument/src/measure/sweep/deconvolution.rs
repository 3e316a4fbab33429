//! Responses from played and recorded signals, by deconvolution and a gate in time.
//!
//! X and Y are the spectra of the played and the recorded signal, both from rest to rest and both through the
//! capture's filter, which therefore cancels:
//!
//! ```text
//! h(t) = F^-1 { W(f) Y X* / |X|^2 }                 W: 1 over the measured band, smoothly 0 at the sweep's ends
//! H(f) = G{h}(f)/G{F^-1 W}(f),   G{h}(f) = sum over t of g(t) h(t) e^(j omega t)
//!                                                   g: 1 while the plate rings, smoothly 0 before and after
//! ```
//! The gate removes what cannot be the plate's response: noise at other times, and the harmonics of a
//! nonlinear amplifier or sensor. An exponential sweep from f1 to f2 in the time T passes f/k earlier than f,
//! by T ln k/ln(f2/f1), so in h the k-th harmonic lies that time before t = 0 (A. Farina, "Simultaneous
//! measurement of impulse response and distortion with a swept-sine technique", AES 108, 2000).
//! Multiplication by g in time smooths H over the inverse of g's length. W's edges lie farther from the
//! measured band than that, and the division corrects their remaining effect.
//!
//! The noise in each part of H is that of the values inside the gate: its variance is S/2 times the sum of
//! g^2 over |X|^2, with S the noise's |N|^2 per value.

use rustfft::num_complex::Complex;
use slipline_model::real_fft::RealFft;
use slipline_plate::Complex64;
use std::f64::consts::{PI, TAU};

/// Bins on each side that are averaged for the noise at a frequency.
const NEIGHBOURS: usize = 8;

/// The played and the recorded signal, and the input's noise.
pub(super) struct Signals<'a, T> {
    /// The played signal.
    pub(super) played: &'a [T],
    /// The recorded signal.
    pub(super) heard: &'a [T],
    /// Values recorded in silence, minus their mean.
    pub(super) noise: &'a [f64],
    /// Smallest variance of a value: that of its rounding.
    pub(super) rounding: f64,
    /// Values per second of the recorded signal.
    pub(super) rate_hz: f64,
}

/// Both from rest to rest, at the same times: played values, minus mid-scale, and recorded ones, minus the input's own offset.
pub(super) type Recorded<'a> = Signals<'a, f64>;
/// Their spectra, from bin 0 to half of the rate.
pub(super) type Spectra<'a> = Signals<'a, Complex<f64>>;

/// The gate in frequency (W) and in time (g).
pub(super) struct Gate {
    /// Band in which W rises from 0 to 1, Hz.
    pub(super) rises_hz: (f64, f64),
    /// Band in which it falls to 0, Hz.
    pub(super) falls_hz: (f64, f64),
    /// Time after t = 0 during which g is 1, seconds.
    pub(super) ring_s: f64,
    /// Time of g's fall to 0, seconds; before t = 0, g is 1 for half of that time.
    pub(super) fade_s: f64,
}

/// A response, and the noise in each of its parts.
pub(super) type Answer = (Complex64, f64);

/// Smooth step from 0 to 1 over an interval.
pub(super) fn smooth(at: f64, (low, high): (f64, f64)) -> f64 {
    let share = if high > low { ((at - low) / (high - low)).clamp(0.0, 1.0) } else { 1.0 };
    0.5 - 0.5 * (PI * share).cos()
}

impl Gate {
    /// W at a frequency.
    pub(super) fn band(&self, frequency_hz: f64) -> f64 {
        smooth(frequency_hz, self.rises_hz) * (1.0 - smooth(frequency_hz, self.falls_hz))
    }

    /// g at a time.
    fn time(&self, seconds: f64) -> f64 {
        let (fade, ring) = (self.fade_s, self.ring_s);
        smooth(seconds, (-1.5 * fade, -0.5 * fade)) * (1.0 - smooth(seconds, (ring, ring + fade)))
    }
}

/// The responses at these frequencies, with time as e^(-j omega t); `None` if nothing was played at one of
/// them.
pub(super) fn responses(of: &Recorded<'_>, gate: &Gate, frequencies_hz: &[f64]) -> Option<Vec<Answer>> {
    let count = of.played.len().max(of.heard.len()).next_power_of_two().max(2);
    let (played, heard) = (spectrum(of.played, count)?, spectrum(of.heard, count)?);
    let Recorded { noise, rounding, rate_hz, .. } = *of;
    Spectra { played: &played, heard: &heard, noise, rounding, rate_hz }.responses(gate, frequencies_hz)
}

/// Spectrum of these values, padded with zeros to `count` values, a power of two.
pub(super) fn spectrum(values: &[f64], count: usize) -> Option<Vec<Complex<f64>>> {
    RealFft::new(count).map(|fft| fft.spectrum(values))
}

/// Inverse real FFT of a half spectrum, not divided by the number of values.
pub(super) fn values(bins: &[Complex<f64>]) -> Option<Vec<f64>> {
    RealFft::new(2 * bins.len().checked_sub(1)?).map(|fft| fft.values(bins))
}

impl Spectra<'_> {
    fn bin_hz(&self) -> f64 {
        self.rate_hz / (2 * (self.played.len() - 1)) as f64
    }

    /// W at each bin.
    fn band(&self, gate: &Gate) -> Vec<f64> {
        (0..self.played.len()).map(|bin| gate.band(bin as f64 * self.bin_hz())).collect()
    }

    /// h, times the number of its values; `None` if nothing was played in the band.
    pub(super) fn impulse(&self, gate: &Gate) -> Option<Vec<f64>> {
        let band = self.band(gate);
        if band.iter().zip(self.played).any(|(weight, x)| *weight > 0.0 && x.norm_sqr() == 0.0) {
            return None;
        }
        let weighed = |(weight, (x, y)): (&f64, (&Complex<f64>, &Complex<f64>))| {
            if *weight > 0.0 { y * x.conj() * (weight / x.norm_sqr()) } else { Complex::default() }
        };
        values(&band.iter().zip(self.played.iter().zip(self.heard)).map(weighed).collect::<Vec<_>>())
    }

    /// The responses at these frequencies; `None` if nothing was played at one of them.
    pub(super) fn responses(&self, gate: &Gate, frequencies_hz: &[f64]) -> Option<Vec<Answer>> {
        let edges = values(&self.band(gate).into_iter().map(Complex::from).collect::<Vec<_>>())?;
        let edges = gated(&edges, gate, self.rate_hz);
        let gated = gated(&self.impulse(gate)?, gate, self.rate_hz);
        let energy: f64 = gated.iter().map(|(_, _, weight)| weight * weight).sum();
        // The gate smooths 1/|X|^2 as it smooths H.
        let bin_hz = self.bin_hz();
        let blur = (bin_hz * gate.ring_s).recip().ceil() as usize;
        // |N|^2 per value at each bin, of the most values whose number is a power of two.
        let count = 1 << self.noise.len().checked_ilog2()?;
        let noise_values = count as f64;
        let bins = spectrum(&self.noise[..count], count)?;
        let noise: Vec<f64> = bins.iter().map(|bin| bin.norm_sqr() / noise_values).collect();
        let noise_bin_hz = self.rate_hz / noise_values;
        let answer = |&frequency_hz: &f64| {
            let turns = frequency_hz / self.rate_hz;
            let response = sum(&gated, turns) / sum(&edges, turns);
            let inverse = mean(self.played, frequency_hz / bin_hz, blur, |x| x.norm_sqr().recip());
            let density =
                mean(&noise, frequency_hz / noise_bin_hz, NEIGHBOURS, |power| *power).max(self.rounding);
            (response, (0.5 * density * energy * inverse).sqrt())
        };
        Some(frequencies_hz.iter().map(answer).collect())
    }
}

/// G at a frequency in turns per value.
fn sum(gated: &[(f64, f64, f64)], turns: f64) -> Complex64 {
    let term = |&(at, value, weight): &(f64, f64, f64)| {
        Complex64::cis(TAU * (turns * at).fract()) * (value * weight)
    };
    gated.iter().map(term).sum()
}

/// The gated impulse response: the time in values, the value, and its weight.
fn gated(impulse: &[f64], gate: &Gate, rate_hz: f64) -> Vec<(f64, f64, f64)> {
    let count = impulse.len();
    let before = ((1.5 * gate.fade_s * rate_hz).ceil() as usize).min(count / 2);
    let after = (((gate.ring_s + gate.fade_s) * rate_hz).ceil() as usize).min(count - before - 1);
    let at = |place: usize| {
        let time = place as f64 - before as f64;
        (time, impulse[(place + count - before) % count], gate.time(time / rate_hz))
    };
    (0..before + after).map(at).filter(|(_, _, weight)| *weight > 0.0).collect()
}

/// Mean of a quantity over the bins around a place.
fn mean<T>(bins: &[T], place: f64, aside: usize, of: impl Fn(&T) -> f64) -> f64 {
    let middle = (place.round() as usize).min(bins.len() - 1);
    let around = &bins[middle.saturating_sub(aside)..(middle + aside + 1).min(bins.len())];
    around.iter().map(of).sum::<f64>() / around.len() as f64
}

#[cfg(test)]
mod tests;
