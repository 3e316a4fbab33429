//! Phases that keep the sum of several tones low.
//!
//! M. R. Schroeder, "Synthesis of low-peak-factor signals and binary sequences with low autocorrelation", IEEE Trans.
//! Inf. Theory 16, 85 (1970): with the phase phi_n = -2 pi sum over l < n of (n - l) P_l, where P_l is the fraction
//! of the power in tone l, the sum glides through its frequencies, and its envelope is nearly constant.

/// The phase of each tone in turns, 0 to 1, for tones with these DAC amplitudes in order of frequency.
pub(super) fn low_crest_turns(amplitudes: &[f64]) -> Vec<f64> {
    let total: f64 = amplitudes.iter().map(|a| a * a).sum();
    let (mut shares, mut turns) = (0.0, 0.0);
    let mut phases = Vec::with_capacity(amplitudes.len());
    for amplitude in amplitudes {
        phases.push(f64::rem_euclid(-turns, 1.0));
        shares += if total > 0.0 { amplitude * amplitude / total } else { 0.0 };
        turns += shares;
    }
    phases
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Largest over RMS value of tones at the frequencies 20, 21, 22 and so on.
    fn crest(amplitudes: &[f64], turns: &[f64]) -> f64 {
        let value = |t: f64| -> f64 {
            let tones = amplitudes.iter().zip(turns).zip(20..);
            tones.map(|((a, turns), number)| a * (TAU * (f64::from(number) * t + turns)).cos()).sum()
        };
        let largest = (0..20_000).map(|i| value(f64::from(i) / 20_000.0).abs()).fold(0.0, f64::max);
        largest / (0.5 * amplitudes.iter().map(|a| a * a).sum::<f64>()).sqrt()
    }

    #[test]
    fn the_sum_of_sixteen_tones_is_less_than_half_of_what_it_is_in_phase() {
        let equal = [0.05; 16];
        let falling: Vec<f64> = (0..16).map(|tone| 1.0 / (2.0 + f64::from(tone))).collect();
        for amplitudes in [&equal[..], &falling] {
            let (low, in_phase) =
                (crest(amplitudes, &low_crest_turns(amplitudes)), crest(amplitudes, &[0.0; 16]));
            assert!(low < 2.2 && in_phase > 2.0 * low, "{low} {in_phase}");
        }
        assert!(low_crest_turns(&equal).iter().all(|turns| (0.0..1.0).contains(turns)));
    }
}
