//! The spectrum of DAC codes, for the plot.

use crate::real_fft::RealFft;
use slipline_plate::quantity::decibels;
use std::f64::consts::TAU;

/// One line of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Line {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Amplitude against the DAC's full scale, in dB.
    pub level_db: f64,
}

/// Bins below this one have a line each; above, the number of bins of a line grows with its frequency, so
/// that slow and fast tones are both sharp.
const SINGLE_BINS: usize = 800;
/// Level below which nothing is drawn, in dB: the noise of 12 bits spread over the bins.
const FLOOR_DB: f64 = -140.0;

/// Computes spectra; keeps the transform and the window of the last length.
#[derive(Default)]
pub(super) struct Spectrum {
    kept: Option<(RealFft, Vec<f64>)>,
}

impl Spectrum {
    /// The spectrum of the last power of two of these codes (mid-scale 2048), under a Blackman-Harris window.
    /// Where bins share a line it shows the strongest. Empty for fewer than 64 codes.
    pub(super) fn of(&mut self, codes: &[u16], sample_rate_hz: f64) -> Vec<Line> {
        if codes.len() < 64 {
            return Vec::new();
        }
        let length = 1usize << codes.len().ilog2();
        let codes = &codes[codes.len() - length..];
        if self.kept.as_ref().is_none_or(|(_, window)| window.len() != length) {
            let window = (0..length).map(|i| blackman_harris(i as f64 / length as f64)).collect();
            self.kept = RealFft::new(length).map(|fft| (fft, window));
        }
        let Some((fft, window)) = &self.kept else { return Vec::new() };
        let input: Vec<f64> = codes
            .iter()
            .zip(window)
            .map(|(&code, weight)| (f64::from(code) - 2048.0) / 2048.0 * weight)
            .collect();
        let output = fft.spectrum(&input);
        // A sine of amplitude 1 gives sum(window)/2 in its bin.
        let scale = 2.0 / window.iter().sum::<f64>();
        let bin_hz = sample_rate_hz / length as f64;
        let mut lines = Vec::new();
        let mut first = 0;
        while first < output.len() {
            let end = (first + (first / SINGLE_BINS).max(1)).min(output.len());
            let strongest =
                (first..end).max_by(|&a, &b| output[a].norm_sqr().total_cmp(&output[b].norm_sqr()));
            let bin = strongest.unwrap_or(first);
            lines.push(Line {
                frequency_hz: bin as f64 * bin_hz,
                level_db: decibels(output[bin].norm() * scale).max(FLOOR_DB),
            });
            first = end;
        }
        lines
    }
}

/// How far from a tone its strongest line can stand, in lines.
const ASIDE: usize = 2;

/// The level of a tone of this frequency, in dB: where the lines are evenly spaced, that of the parabola through its
/// strongest line and the neighbours, so it is correct between bins, too. `None` outside the spectrum.
#[must_use]
pub fn level_at(lines: &[Line], frequency_hz: f64) -> Option<f64> {
    let after = lines.partition_point(|line| line.frequency_hz < frequency_hz);
    if after == 0 || after == lines.len() {
        return None;
    }
    let near = after.saturating_sub(ASIDE + 1)..(after + ASIDE).min(lines.len());
    let strongest = near.max_by(|&a, &b| lines[a].level_db.total_cmp(&lines[b].level_db))?;
    let around = lines.get(strongest.saturating_sub(1)..strongest + 2)?;
    Some(between(around).level_db)
}

/// The top of the parabola through three lines; the middle one where they are not evenly spaced.
fn between(lines: &[Line]) -> Line {
    let &[before, here, after] = lines else { return Line { frequency_hz: 0.0, level_db: FLOOR_DB } };
    let (step_hz, next_hz) =
        (here.frequency_hz - before.frequency_hz, after.frequency_hz - here.frequency_hz);
    let bend_db = before.level_db - 2.0 * here.level_db + after.level_db;
    if bend_db >= 0.0 || (step_hz - next_hz).abs() > 1e-6 * step_hz {
        return here;
    }
    let slope_db = before.level_db - after.level_db;
    let share = (0.5 * slope_db / bend_db).clamp(-0.5, 0.5);
    Line {
        frequency_hz: here.frequency_hz + share * step_hz,
        level_db: here.level_db - 0.25 * slope_db * share,
    }
}

/// The four-term Blackman-Harris window at `share` of its length: side lobes below -92 dB.
fn blackman_harris(share: f64) -> f64 {
    // The cosines of twice and three times the angle are computed from that of the angle: in its first second
    // a drive has ten window lengths.
    let first = (TAU * share).cos();
    let second = 2.0 * first * first - 1.0;
    let third = 2.0 * first * second - first;
    0.358_75 - 0.488_29 * first + 0.141_28 * second - 0.011_68 * third
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_shows_at_its_frequency_and_level() {
        let rate = 400_000.0;
        let codes: Vec<u16> = (0..1 << 15)
            .map(|i| (2048.0 + 1024.0 * (TAU * 40_000.0 * f64::from(i) / rate).sin()).round() as u16)
            .collect();
        let lines = Spectrum::default().of(&codes, rate);
        let top = lines.iter().max_by(|a, b| a.level_db.total_cmp(&b.level_db)).unwrap();
        assert!((top.frequency_hz - 40_000.0).abs() < 20.0 && (top.level_db + 6.02).abs() < 0.9, "{top:?}");
        let far = lines.iter().filter(|line| (line.frequency_hz - 40_000.0).abs() > 500.0);
        assert!(far.map(|line| line.level_db).fold(-200.0, f64::max) < -70.0);
        let level_db = level_at(&lines, 40_000.0).unwrap();
        assert!((level_db + 6.02).abs() < 0.9, "{level_db}");
        assert!(lines.len() < 8000 && Spectrum::default().of(&[2048; 10], rate).is_empty());
    }

    #[test]
    fn the_level_of_a_known_tone_is_right_between_the_bins_and_beside_louder_tones() {
        let rate = 400_000.0;
        let tones = [(171.3, 800.0), (216.0, 500.0), (388.9, 80.0), (1207.7, 8.0)];
        let codes: Vec<u16> = (0..1 << 16)
            .map(|i| {
                let tone = |(hertz, codes): &(f64, f64)| codes * (TAU * hertz * f64::from(i) / rate).sin();
                (2048.0 + tones.iter().map(tone).sum::<f64>()).round() as u16
            })
            .collect();
        let lines = Spectrum::default().of(&codes, rate);
        for (hertz, codes) in tones {
            let wanted_db = decibels(codes / 2048.0f64);
            let level_db = level_at(&lines, hertz).unwrap();
            // A bin is 6.1 Hz wide.
            assert!((level_db - wanted_db).abs() < 0.1, "{hertz}: {level_db}, not {wanted_db}");
        }
        assert!(level_at(&lines, 800.0).is_some_and(|level_db| level_db < -75.0), "noise");
        assert_eq!([level_at(&lines, 1e6), level_at(&lines, -1.0), level_at(&[], 100.0)], [None; 3]);
    }
}
