//! Noise and distortion by a wire from the DAC's pin to the sensor's.

use super::course::{Course, reading};
use super::limits::step;
use super::report::StepResult;
use crate::measure::MeasureError;
use slipline_model::real_fft::RealFft;

/// Codes of a spectrum, in blocks of 128: one period of the comb; and of a short test.
const BLOCKS: u16 = 32;
const SHORT_BLOCKS: u16 = 16;

/// A tone: its frequency, and the quantities of its SINAD, of its largest spur, and of what a busy link changes.
struct Tone {
    hz: f64,
    sinad: &'static str,
    spur: &'static str,
    change: Option<&'static str>,
}

const TONES: [Tone; 3] = [
    Tone {
        hz: 1e3,
        sinad: "SINAD at 1 kHz",
        spur: "largest spur at 1 kHz",
        change: Some("change by a busy link at 1 kHz"),
    },
    Tone {
        hz: 10e3,
        sinad: "SINAD at 10 kHz",
        spur: "largest spur at 10 kHz",
        change: Some("change by a busy link at 10 kHz"),
    },
    Tone { hz: 40e3, sinad: "SINAD at 40 kHz", spur: "largest spur at 40 kHz", change: None },
];

impl Course {
    /// The noise of mid-scale, and signal over noise and distortion of three tones, two of them also while the link is busy.
    pub(super) async fn noise(&self) -> Result<StepResult, MeasureError> {
        let name = step::NOISE;
        let blocks = if self.request.is_short { SHORT_BLOCKS } else { BLOCKS };
        let count = blocks * slipline_link::BLOCK as u16;
        self.dialogue.stop().await?;
        let silent: Vec<f64> = self.capture(self.dialogue.now(), 0, count, false).await?.codes().collect();
        let mut readings = vec![reading(name, "noise at mid-scale", deviation(&silent))];
        for tone in TONES {
            let base_hz = self.rate_hz / f64::from(count);
            let harmonic = (tone.hz / base_hz).round() as u16;
            let risen = self.comb(blocks, [(harmonic, self.clean())]).await?;
            let quiet = self.capture(risen, 0, count, false).await?;
            let spectrum = Spectrum::of(&quiet.codes().collect::<Vec<f64>>(), harmonic.into());
            let sinad_db = spectrum.sinad_db + self.turned_down_db();
            readings.push(reading(name, tone.sinad, sinad_db));
            readings.push(reading(name, tone.spur, spectrum.spur_db));
            if let Some(change) = tone.change {
                let busy = self.capture(risen, 0, count, true).await?;
                let busy = Spectrum::of(&busy.codes().collect::<Vec<f64>>(), harmonic.into());
                readings.push(reading(name, change, busy.sinad_db + self.turned_down_db() - sinad_db));
            }
        }
        self.dialogue.stop().await?;
        Ok(StepResult::judged(name, readings, "The converters are as quiet as the measurements need."))
    }

    /// How far the device turns tones down now, dB: after a start it takes its coil for hot. SINAD counts without that, or it would
    /// depend on the time since the start.
    fn turned_down_db(&self) -> f64 {
        let per_mille =
            self.dialogue.seen(|snapshot| snapshot.drive.status.map(|status| status.foldback_per_mille));
        20.0 * (1000.0 / f64::from(per_mille.flatten().unwrap_or(1000).max(1))).log10()
    }
}

/// The standard deviation.
fn deviation(values: &[f64]) -> f64 {
    let count = (values.len() as f64).max(1.0);
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt()
}

/// The power of each line of the spectrum of these codes, a power of two of them, from that of their mean on.
pub(super) fn line_powers(codes: &[f64]) -> Vec<f64> {
    let lines = RealFft::new(codes.len()).map(|fft| fft.spectrum(codes)).unwrap_or_default();
    lines.iter().map(|line| line.norm_sqr()).collect()
}

/// A tone of whole periods in its window.
struct Spectrum {
    /// Its power over all other power but that of the mean, dB; -300 to 300.
    sinad_db: f64,
    /// The strongest other line over the tone, dB.
    spur_db: f64,
}

impl Spectrum {
    /// The spectrum of these codes, a power of two of them, whose tone has `harmonic` periods in them.
    fn of(codes: &[f64], harmonic: usize) -> Self {
        let power = line_powers(codes);
        let tone = power.get(harmonic).copied().unwrap_or_default();
        let others =
            || power.iter().enumerate().skip(1).filter(|(at, _)| *at != harmonic).map(|(_, power)| *power);
        let db = |share: f64| (10.0 * share.max(1e-30).log10()).clamp(-300.0, 300.0);
        let rest: f64 = others().sum();
        Self {
            sinad_db: db(tone / rest.max(1e-30)),
            spur_db: db(others().fold(0.0, f64::max) / tone.max(1e-30)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_sinad_of_a_rounded_sine_is_that_of_its_steps() {
        let codes = |spur: f64| -> Vec<f64> {
            (0..4096)
                .map(|n| TAU * f64::from(n) / 4096.0)
                .map(|turn| (1740.0 * (103.0 * turn).sin() + spur * (500.0 * turn).sin()).round())
                .collect()
        };
        // 1740 codes over steps of one code: 20 log10(1740 / sqrt(2) * sqrt(12)) = 72.6 dB.
        let clean = Spectrum::of(&codes(0.0), 103);
        assert!((clean.sinad_db - 72.6).abs() < 1.0, "{}", clean.sinad_db);
        let spoiled = Spectrum::of(&codes(17.4), 103);
        assert!((spoiled.sinad_db - 40.0).abs() < 0.1 && (spoiled.spur_db + 40.0).abs() < 0.1);
        assert!(deviation(&codes(0.0)) > 1000.0 && deviation(&[2.0; 9]) == 0.0);
    }
}
