//! Whether a recorder's gain was fixed: the sweep at half the level must be recorded at half of it, at all frequencies.
//!
//! An automatic gain raises quiet signals, a limiter lowers loud ones, and a noise suppressor removes the
//! quietest. Each makes the second response differ from the first one. The band is divided into eight parts;
//! in each the mean change of the level, weighted by the noise, is compared with its limit.

use super::super::deconvolution::Answer;
use super::HeardError;

/// Parts of the band.
const PARTS: usize = 8;
/// Accepted change of the level, dB, besides a number of its standard deviations.
const ACCEPTED_DB: f64 = 0.3;
const DEVIATIONS: f64 = 4.0;
/// Decibel of one neper.
const NEPER_DB: f64 = 8.685_889_638;

/// Refuses a gain that differed between the two sweeps.
pub(super) fn check(frequencies_hz: &[f64], loud: &[Answer], quiet: &[Answer]) -> Result<(), HeardError> {
    let all: Vec<(f64, &Answer, &Answer)> =
        frequencies_hz.iter().zip(loud).zip(quiet).map(|((hz, one), other)| (*hz, one, other)).collect();
    let mut worst: Option<(f64, f64)> = None;
    for part in all.chunks(all.len().div_ceil(PARTS)) {
        let Some((decibel, deviation_db)) = change(part) else { continue };
        let beyond = decibel.abs() - DEVIATIONS * deviation_db;
        let is_worse = worst.is_none_or(|(before, _): (f64, f64)| decibel.abs() > before.abs());
        if beyond > ACCEPTED_DB && is_worse {
            worst = Some((decibel, part[part.len() / 2].0));
        }
    }
    match worst {
        Some((decibel, frequency_hz)) => Err(HeardError::Gain { decibel, frequency_hz }),
        None => Ok(()),
    }
}

/// The mean change of the level in a part of the band, dB, and its standard deviation.
fn change(part: &[(f64, &Answer, &Answer)]) -> Option<(f64, f64)> {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (_, (loud, loud_noise), (quiet, quiet_noise)) in part {
        // Component of the quiet response in phase with the loud one: noise does not raise it.
        let share = (quiet / loud).re;
        let variance = (loud_noise.powi(2) + quiet_noise.powi(2)) / loud.norm_sqr();
        if share.is_finite() && variance.is_finite() {
            // A hundredth of a decibel is added for deviations other than noise.
            let weight = (variance + 1e-6).recip();
            sum += weight * share;
            weights += weight;
        }
    }
    let mean = sum / weights;
    (weights > 0.0).then(|| (NEPER_DB * mean.max(1e-3).ln(), NEPER_DB / weights.sqrt() / mean.max(1e-3)))
}
