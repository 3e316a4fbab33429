//! Whether a recorder's gain was fixed: the sweep at half the level must be recorded at half of it, at all frequencies.
//!
//! An automatic gain raises what is quiet, a limiter holds down what is loud, and a noise suppression takes away what is quietest.
//! All of them make the second response differ from the first one. It is looked at in eight parts of the band, each by the mean of
//! its level's change, weighted by the noise.

use super::super::deconvolution::Answer;
use super::HeardError;

/// Parts of the band.
const PARTS: usize = 8;
/// Change of the level that is accepted, dB, and in standard deviations on top of it.
const ACCEPTED_DB: f64 = 0.3;
const DEVIATIONS: f64 = 4.0;
/// Decibel of one neper.
const NEPER_DB: f64 = 8.685_889_638;

/// Refuses a gain that was not the same for both.
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
        // The part of the quiet answer that goes with the loud one: noise does not raise it.
        let share = (quiet / loud).re;
        let variance = (loud_noise.powi(2) + quiet_noise.powi(2)) / loud.norm_sqr();
        if share.is_finite() && variance.is_finite() {
            // A hundredth of a decibel is left to what no noise explains.
            let weight = (variance + 1e-6).recip();
            sum += weight * share;
            weights += weight;
        }
    }
    let mean = sum / weights;
    (weights > 0.0).then(|| (NEPER_DB * mean.max(1e-3).ln(), NEPER_DB / weights.sqrt() / mean.max(1e-3)))
}
