//! Samples of a changing sound.

use super::{Partial, Sound};
use slipline_link::protocol::limits::MAX_TONES;
use std::f64::consts::TAU;

/// Time constant with which amplitudes and frequencies follow, in seconds; shorter ones cause clicks.
const FOLLOW_S: f64 = 0.008;
/// Below this amplitude a tone is silent: a twentieth of a step of 16 bits.
const SILENT: f64 = 1e-6;
/// Corner frequency of the noise, in Hz: a sliding fingertip does not hiss.
const NOISE_HZ: f64 = 1_500.0;

/// One oscillator.
#[derive(Clone, Copy, Debug, Default)]
struct Voice {
    /// 0..1 turns.
    phase: f64,
    frequency_hz: f64,
    amplitude: f64,
}

/// Generates samples of a sound. Changes cause no click: amplitudes and frequencies follow with a time
/// constant of 8 ms, and a tone keeps its phase.
#[derive(Clone, Debug)]
pub struct Synth {
    rate_hz: f64,
    voices: [Voice; MAX_TONES],
    noise: f64,
    noise_low_passed: f64,
    random: u32,
}

impl Synth {
    /// A silent synthesizer with this sample rate.
    #[must_use]
    pub fn new(rate_hz: f64) -> Self {
        let voices = [Voice::default(); MAX_TONES];
        Self { rate_hz, voices, noise: 0.0, noise_low_passed: 0.0, random: 0x9E37_79B9 }
    }

    /// Whether it has become silent.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.noise == 0.0 && self.voices.iter().all(|voice| voice.amplitude == 0.0)
    }

    /// Fills `samples`, each -1..=1, with this sound at this volume, 0..=1. If its amplitudes add up to more than full
    /// scale, all of them are reduced alike: nothing is clipped.
    pub fn render(&mut self, sound: &Sound, volume: f64, samples: &mut [f32]) {
        let volume = if volume.is_finite() { volume.clamp(0.0, 1.0) } else { 0.0 };
        let sane = |value: f64| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        let sum: f64 =
            sound.partials.iter().map(|partial| sane(partial.amplitude)).sum::<f64>() + sane(sound.noise);
        let scale = volume / sum.max(1.0);
        let follow = 1.0 - (-1.0 / (FOLLOW_S * self.rate_hz)).exp();
        let mut wanted = [None::<Partial>; MAX_TONES];
        for partial in &sound.partials {
            // Frequencies that cannot be sampled are left out.
            let is_heard = (0.0..0.45 * self.rate_hz).contains(&partial.frequency_hz);
            if let Some(voice) = wanted.get_mut(usize::from(partial.slot)).filter(|_| is_heard) {
                *voice = Some(Partial { amplitude: scale * sane(partial.amplitude), ..*partial });
            }
        }
        samples.fill(0.0);
        for (voice, wanted) in self.voices.iter_mut().zip(wanted) {
            voice.add(wanted, follow, self.rate_hz, samples);
        }
        self.add_noise(scale * sane(sound.noise), follow, samples);
        // Two amplitudes that are exchanged may add up to more for some milliseconds.
        samples.iter_mut().for_each(|sample| *sample = sample.clamp(-1.0, 1.0));
    }

    fn add_noise(&mut self, wanted: f64, follow: f64, samples: &mut [f32]) {
        if self.noise == 0.0 && wanted == 0.0 {
            return;
        }
        let low_pass = 1.0 - (-TAU * NOISE_HZ / self.rate_hz).exp();
        for sample in samples {
            self.noise += (wanted - self.noise) * follow;
            // Marsaglia's xorshift.
            self.random ^= self.random << 13;
            self.random ^= self.random >> 17;
            self.random ^= self.random << 5;
            let white = f64::from(self.random) / f64::from(u32::MAX) * 2.0 - 1.0;
            self.noise_low_passed += (white - self.noise_low_passed) * low_pass;
            *sample += (self.noise * self.noise_low_passed) as f32;
        }
        if wanted == 0.0 && self.noise < SILENT {
            self.noise = 0.0;
        }
    }
}

impl Voice {
    fn add(&mut self, wanted: Option<Partial>, follow: f64, rate_hz: f64, samples: &mut [f32]) {
        let wanted_amplitude = wanted.map_or(0.0, |partial| partial.amplitude);
        if self.amplitude == 0.0 {
            if wanted_amplitude == 0.0 {
                return;
            }
            // It starts at its own pitch.
            self.frequency_hz = wanted.map_or(0.0, |partial| partial.frequency_hz);
        }
        let wanted_hz = wanted.map_or(self.frequency_hz, |partial| partial.frequency_hz);
        for sample in samples {
            self.amplitude += (wanted_amplitude - self.amplitude) * follow;
            self.frequency_hz += (wanted_hz - self.frequency_hz) * follow;
            self.phase = (self.phase + self.frequency_hz / rate_hz).fract();
            *sample += (self.amplitude * (TAU * self.phase).sin()) as f32;
        }
        if wanted_amplitude == 0.0 && self.amplitude < SILENT {
            self.amplitude = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 48_000.0;

    fn tone(slot: u8, frequency_hz: f64, amplitude: f64) -> Partial {
        Partial { slot, frequency_hz, amplitude }
    }

    fn sound(partials: &[Partial]) -> Sound {
        Sound { partials: partials.to_vec(), noise: 0.0 }
    }

    /// The next samples of a synthesizer.
    fn next(synth: &mut Synth, sound: &Sound, count: usize) -> Vec<f32> {
        let mut samples = vec![0.0; count];
        synth.render(sound, 1.0, &mut samples);
        samples
    }

    /// Amplitude of the component at a frequency, by correlation over all samples.
    fn amplitude_at(samples: &[f32], frequency_hz: f64) -> f64 {
        let (mut re, mut im) = (0.0, 0.0);
        for (n, &sample) in samples.iter().enumerate() {
            let angle = TAU * frequency_hz * n as f64 / RATE_HZ;
            re += f64::from(sample) * angle.cos();
            im += f64::from(sample) * angle.sin();
        }
        2.0 * re.hypot(im) / samples.len() as f64
    }

    #[test]
    fn each_tone_has_its_frequency_and_amplitude() {
        let mut synth = Synth::new(RATE_HZ);
        let chord = sound(&[tone(0, 440.0, 0.3), tone(5, 1750.0, 0.1)]);
        next(&mut synth, &chord, 48_000);
        let settled = next(&mut synth, &chord, 48_000);
        for (frequency_hz, wanted) in [(440.0, 0.3), (1750.0, 0.1), (900.0, 0.0)] {
            let got = amplitude_at(&settled, frequency_hz);
            assert!((got - wanted).abs() < 1e-4, "{frequency_hz} Hz: {got}");
        }
    }

    #[test]
    fn nothing_clicks_whatever_changes() {
        // From sample to sample a tone of amplitude 0.5 at 2 kHz changes by at most 0.5 * 2 pi 2000 / 48 000.
        let slope = 0.5 * TAU * 2000.0 / RATE_HZ;
        let mut synth = Synth::new(RATE_HZ);
        let mut samples = Vec::new();
        for partials in [
            vec![tone(0, 300.0, 0.5)],
            vec![tone(0, 2000.0, 0.5)],
            vec![tone(0, 2000.0, 0.1)],
            vec![],
            vec![tone(3, 700.0, 0.5)],
        ] {
            samples.extend(next(&mut synth, &sound(&partials), 700));
        }
        // Amplitudes follow: a step of 0.5 changes by at most 0.5 / (8 ms * 48 kHz) a sample.
        let step = 0.5 / (0.008 * RATE_HZ);
        let most = samples.windows(2).map(|pair| f64::from((pair[1] - pair[0]).abs())).fold(0.0, f64::max);
        assert!(most < slope + step, "{most}");
    }

    #[test]
    fn a_sound_is_never_louder_than_full_scale_and_nothing_is_clipped() {
        let mut synth = Synth::new(RATE_HZ);
        let loud: Vec<Partial> =
            (0..16).map(|slot| tone(slot, 100.0 * (1.0 + f64::from(slot)), 1.0)).collect();
        next(&mut synth, &sound(&loud), 48_000);
        let settled = next(&mut synth, &sound(&loud), 48_000);
        assert!(settled.iter().all(|sample| sample.abs() <= 1.0));
        let got = amplitude_at(&settled, 100.0);
        assert!((got - 1.0 / 16.0).abs() < 1e-4, "{got}: reduced, not clipped");
        let harmonic = amplitude_at(&settled, 1700.0);
        assert!(harmonic < 1e-4, "{harmonic}: clipping would make it");
    }

    #[test]
    fn after_the_sound_it_becomes_silent_and_the_volume_counts() {
        let mut synth = Synth::new(RATE_HZ);
        let mut samples = [0.0; 4800];
        let one = Sound { noise: 0.1, ..sound(&[tone(0, 440.0, 0.5)]) };
        for _ in 0..10 {
            synth.render(&one, 0.5, &mut samples);
        }
        assert!(!synth.is_silent());
        // Two whole periods of 440 Hz and 100 Hz alike: 0.1 s are 44.
        assert!((amplitude_at(&samples, 440.0) - 0.25).abs() < 0.01);
        for _ in 0..3 {
            synth.render(&Sound::default(), 0.5, &mut samples);
        }
        assert!(synth.is_silent());
        synth.render(&Sound::default(), 0.5, &mut samples);
        assert!(samples.iter().all(|&sample| sample == 0.0));
    }

    #[test]
    fn the_noise_has_its_size_and_no_tone() {
        let mut synth = Synth::new(RATE_HZ);
        let noise = Sound { noise: 0.2, ..Sound::default() };
        next(&mut synth, &noise, 48_000);
        let settled = next(&mut synth, &noise, 48_000);
        let rms = (settled.iter().map(|&s| f64::from(s).powi(2)).sum::<f64>() / 48_000.0).sqrt();
        assert!((0.02..=0.06).contains(&rms), "{rms}");
        assert!(settled.iter().all(|sample| sample.abs() <= 0.2));
    }

    #[test]
    fn values_that_are_no_numbers_are_silence() {
        let mut synth = Synth::new(RATE_HZ);
        let odd =
            [tone(0, f64::NAN, 0.5), tone(1, 440.0, f64::NAN), tone(200, 440.0, 0.5), tone(2, 40e3, 0.5)];
        let samples = next(&mut synth, &Sound { noise: f64::INFINITY, ..sound(&odd) }, 480);
        assert!(samples.iter().all(|&sample| sample == 0.0));
        let mut samples = [1.0; 48];
        synth.render(&sound(&[tone(0, 440.0, 0.5)]), f64::NAN, &mut samples);
        assert_eq!(samples, [0.0; 48]);
    }
}
