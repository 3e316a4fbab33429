//! Search for the two sweeps in a recording.
//!
//! ```text
//! e(t) = | sum over f of W(f) Y_t(f) X*(f)/|X(f)| |       Y_t: the spectrum of what begins at t
//! ```
//! is the envelope of the recording's correlation with the sweep, with equal weight for all frequencies, so
//! that the loudest ones do not smear it. A recorder's clock that is wrong by some 100 ppm smears it by less
//! than the plate's ring does. The first sweep begins where the sum of e(t) and the largest e around t +
//! apart is largest: an echo has no such partner. The recording is searched in overlapping blocks of two
//! sweeps.

use super::super::deconvolution::{Gate, spectrum};
use super::reference::Reference;
use super::{HeardError, Sound};
use rustfft::algorithm::Radix4;
use rustfft::num_complex::Complex;
use rustfft::{Fft as _, FftDirection};

/// Smallest ratio of e to its median at the first sweep, and at the second one, which has half the level.
/// Noise alone reaches 4 to 5.
const FOUND: (f32, f32) = (8.0, 3.0);
/// Shortest block, values.
const BLOCK_MIN: usize = 4096;

/// e at every `step` values of a recording.
struct Envelope {
    values: Vec<f32>,
    /// Distance of two values of e, in values of the recording.
    step: usize,
}

/// The value of the recording at which the first of two sweeps begins, to within the plate's ring. One sweep
/// takes `sweep` values, and the second begins `apart` values after the first, to within `slack`.
pub(super) fn begin(
    sound: &Sound,
    reference: &Reference,
    gate: &Gate,
    [sweep, apart, slack]: [usize; 3],
) -> Result<usize, HeardError> {
    let envelope = envelope(sound, reference, gate, sweep).ok_or(HeardError::Silent)?;
    let e = &envelope.values;
    let mut sorted = e.clone();
    let middle = sorted.len() / 2;
    let (_, &mut median, _) = sorted.select_nth_unstable_by(middle, f32::total_cmp);
    // Largest value of each stretch as long as the slack: the second sweep lies in one of three stretches.
    let stretch = (slack / envelope.step).max(1);
    let largest: Vec<f32> =
        e.chunks(stretch).map(|chunk| chunk.iter().copied().fold(0.0, f32::max)).collect();
    let partner = |at: usize| {
        let middle = (at + apart / envelope.step) / stretch;
        let from = middle.saturating_sub(1).min(largest.len());
        largest[from..(middle + 2).min(largest.len())].iter().copied().fold(0.0, f32::max)
    };
    let both = (0..e.len()).map(|at| (at, e[at] + partner(at)));
    let (at, _) = both.max_by(|a, b| a.1.total_cmp(&b.1)).ok_or(HeardError::Silent)?;
    if median <= 0.0 && e[at] <= 0.0 {
        return Err(HeardError::Silent);
    }
    if e[at] < FOUND.0 * median {
        return Err(HeardError::NotFound);
    }
    if partner(at) < FOUND.1 * median {
        return Err(HeardError::OnlyOne { begin_s: (at * envelope.step) as f64 / sound.rate_hz });
    }
    Ok(at * envelope.step)
}

/// e over a recording; `None` if it is shorter than the sweep.
fn envelope(sound: &Sound, reference: &Reference, gate: &Gate, sweep: usize) -> Option<Envelope> {
    let values = &sound.values;
    let block = (2 * sweep).next_power_of_two().max(BLOCK_MIN);
    let bin_hz = sound.rate_hz / block as f64;
    let count = ((gate.falls_hz.1 / bin_hz).ceil() as usize + 1).min(block / 2);
    let weigh = |(bin, x): (usize, Complex<f64>)| {
        let weight = gate.band(bin as f64 * bin_hz);
        if weight > 0.0 && x.norm_sqr() > 0.0 { x.conj() * (weight / x.norm()) } else { Complex::default() }
    };
    let weights: Vec<Complex<f64>> =
        reference.spectrum(bin_hz, count).into_iter().enumerate().map(weigh).collect();
    // The envelope needs no more values than the band has bins, on one side only.
    let fewer = (2 * count).next_power_of_two().min(block);
    let step = block / fewer;
    let hop = (block - sweep) / step;
    let inverse = Radix4::<f64>::new(fewer, FftDirection::Inverse);
    let starts = values.len().checked_sub(sweep)? / step + 1;
    let mut found: Vec<f32> = Vec::with_capacity(starts);
    while found.len() < starts {
        let begin = found.len() * step;
        let bins = spectrum(&values[begin..(begin + block).min(values.len())], block)?;
        let mut both = vec![Complex::default(); fewer];
        for ((into, bin), weight) in both.iter_mut().zip(&bins).zip(&weights) {
            *into = bin * weight;
        }
        inverse.process(&mut both);
        let room = (starts - found.len()).min(hop);
        found.extend(both.iter().take(room).map(|value| value.norm() as f32));
    }
    Some(Envelope { values: found, step })
}
