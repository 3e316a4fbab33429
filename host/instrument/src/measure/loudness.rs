//! Amplitudes of the tones of a comb by the device's table, and phases that keep their sum low.

use super::plan::Comb;
use slipline_link::DeviceTable;

/// Largest level on the wire, which stands for 1.
const LEVELS: f64 = 65_535.0;

/// A tone of a comb as it is played.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tone {
    pub(super) frequency_hz: f64,
    /// Level relative to the table's full scale.
    pub(super) level: f64,
    /// Phase at its start, turns.
    pub(super) phase_turns: f64,
    /// Amplitude at the DAC, as a share of full scale.
    pub(super) amplitude: f64,
}

/// The tones of a comb: all have the same peak on the plate, their amplitudes add up to at most `level`, and
/// none has a level above `level`.
pub(super) fn tones(comb: &Comb, table: &DeviceTable, rate_hz: f64, level: f64) -> Vec<Tone> {
    let gains: Vec<(f64, f64)> =
        comb.frequencies_hz(rate_hz).map(|hz| (hz, table.gain_of_turns(hz / rate_hz))).collect();
    let sum: f64 = gains.iter().map(|(_, gain)| gain).sum();
    // Rounded down, so that rounding cannot raise the sum above the level.
    let each = ((level / sum.max(1.0)) * LEVELS).floor().max(1.0) / LEVELS;
    let count = gains.len() as f64;
    let tone = |(place, (frequency_hz, gain)): (usize, (f64, f64))| Tone {
        frequency_hz,
        level: each,
        // D. J. Newman's phases, pi i^2/N: the sum of N sines then peaks at about sqrt(2 N) instead of N.
        phase_turns: (0.5 * (place * place) as f64 / count).fract(),
        amplitude: each * gain,
    };
    gains.into_iter().enumerate().map(tone).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn comb() -> Comb {
        Comb { period_blocks: 100, harmonics: (10..26).collect(), settle_samples: 0, rise_s: 0.01 }
    }

    #[test]
    fn the_amplitudes_add_up_to_the_level_and_the_sum_peaks_far_below() {
        // Multiples of 31.25 Hz: 312.5 to 781.25 Hz; the table has 400 to 700 Hz.
        let knots = (0..=100).map(|i| (400.0 + 3.0 * f64::from(i), 0.1 + 0.009 * f64::from(i)));
        let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
        let tones = tones(&comb(), &table, 400e3, 0.5);
        let sum: f64 = tones.iter().map(|tone| tone.amplitude).sum();
        assert!(sum <= 0.5 && sum > 0.499, "{sum}");
        for tone in &tones {
            let stated = 0.1 + 0.003 * (tone.frequency_hz.clamp(400.0, 700.0) - 400.0);
            assert!((tone.amplitude / tone.level / stated - 1.0).abs() < 1e-4, "{tone:?}");
        }
        let at = |t: f64| -> f64 {
            let of = |tone: &Tone| tone.amplitude * (TAU * (tone.frequency_hz * t + tone.phase_turns)).sin();
            tones.iter().map(of).sum()
        };
        let peak = (0..3200).map(|i| at(f64::from(i) * 1e-5).abs()).fold(0.0, f64::max);
        assert!(peak < 0.55 * sum, "{peak}");
    }

    #[test]
    fn tones_of_small_gain_are_never_above_the_level() {
        let knots = (0..=10).map(|i| (100.0 + 100.0 * f64::from(i), 0.01));
        let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
        let tones = tones(&comb(), &table, 400e3, 0.5);
        assert!(tones.iter().all(|tone| tone.level <= 0.5 && tone.level > 0.4999), "{:?}", tones[0]);
    }
}
