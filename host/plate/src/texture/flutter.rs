//! The flutter of a solid area: its tones differ by some hertz, so the sum of two of them rises and falls.
//!
//! The mean square of tones A_i e^(-j omega_i t) over a window T around the time t is
//!
//! 1/2 sum over i and j of Re(A_i A_j* e^(-j (omega_i - omega_j) t)) sinc((f_i - f_j) T),  sinc(x) = sin(pi x)/(pi x),
//!
//! without the terms at the sums of the frequencies. Ripple and evenness describe its mean over all times, the terms
//! with i = j. The other terms are the flutter; the window suppresses those of tones that are 1/T or more apart.

use super::error::TextureError;
use super::fit::Texture;
use super::palette::Palette;
use super::target::Target;
use crate::special::sinc::sinc;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Window of the RMS, seconds. A shorter burst of vibration is felt as a pulse, at any frequency from 40 to 590 Hz (B.
/// Remache-Vinueza, A. Trujillo-Leon and F. Vidal-Verdu, Sci. Rep. 15, 5057, 2025).
pub const FLUTTER_WINDOW_S: f64 = 0.03;
/// Moments of a second at which the area is evaluated, and the seconds over which its largest swing is: beats that do not repeat
/// within a second meet later.
const MOMENTS: usize = 400;
const SECONDS: usize = 4;

/// Depth and frequency of the swing of a solid area's RMS amplitude.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Flutter {
    /// Ratio of the largest to the smallest RMS over 30 ms within a second, dB: the median over the places of the even
    /// area.
    pub swing_db: f64,
    /// The same at the place and in the second, of four, where it is largest, dB: at a node of the louder tones the others beat alone.
    pub largest_db: f64,
    /// That place, metres from the driven end.
    pub largest_at_m: f64,
    /// Mean frequency of the swing, with each beat weighted by its power, Hz; 0 for a single tone.
    pub frequency_hz: f64,
}

impl Texture {
    /// The flutter of these tones in the even part of the area; `None` if the target is not a solid area.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if the plate does not respond.
    pub fn flutter(&self, palette: &Palette<'_>, target: &Target) -> Result<Option<Flutter>, TextureError> {
        let Some(even) = target.even_m() else { return Ok(None) };
        let positions_m: Vec<f64> = self.tones.iter().map(|tone| tone.position_m).collect();
        let fields = palette.fields(&positions_m)?;
        let frequencies: Vec<f64> = self.tones.iter().map(|tone| tone.frequency_hz).collect();
        // The device starts a tone as a sine at its phase: e^(j 2 pi turns) of the drive, conjugate in e^(-j omega t).
        let phasors: Vec<Complex64> =
            self.tones.iter().map(|tone| tone.level * Complex64::cis(-TAU * tone.phase_turns)).collect();
        let beats = Beats::of(&frequencies);
        let area = self.places_m.iter().enumerate().filter(|(_, x)| even.contains(x));
        let places: Vec<(f64, Swing)> = area
            .map(|(place, &place_m)| {
                let at: Vec<Complex64> = fields.iter().zip(&phasors).map(|(f, p)| f[place] * p).collect();
                (place_m, beats.swing(&at))
            })
            .collect();
        let median = |value: fn(&Swing) -> f64| {
            crate::order::median(places.iter().map(|(_, swing)| value(swing)).collect()).unwrap_or(0.0)
        };
        let (largest_at_m, largest_db) = places
            .iter()
            .map(|(place_m, swing)| (*place_m, swing.largest_db))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or_default();
        Ok(Some(Flutter {
            swing_db: median(|it| it.depth_db),
            largest_db,
            largest_at_m,
            frequency_hz: median(|it| it.frequency_hz),
        }))
    }
}

/// The swing at one place: its depth in the first second, the largest of all seconds, and its mean frequency.
struct Swing {
    depth_db: f64,
    largest_db: f64,
    frequency_hz: f64,
}

/// The beats of all pairs of tones.
struct Beats {
    pairs: Vec<Beat>,
}

struct Beat {
    /// Indices of its tones.
    tones: (usize, usize),
    frequency_hz: f64,
    /// Factor by which the window reduces it.
    share: f64,
    /// e^(-j 2 pi frequency t) at each moment, times `share`.
    turns: Vec<Complex64>,
}

impl Beats {
    fn of(frequencies_hz: &[f64]) -> Self {
        let count = frequencies_hz.len();
        let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j)));
        let beat = |tones: (usize, usize)| {
            let frequency_hz = frequencies_hz[tones.0] - frequencies_hz[tones.1];
            let share = sinc(frequency_hz * FLUTTER_WINDOW_S);
            let at = |moment: usize| moment as f64 / MOMENTS as f64;
            let turn = |moment| share * Complex64::cis(-TAU * (frequency_hz * at(moment)).fract());
            Beat { tones, frequency_hz, share, turns: (0..SECONDS * MOMENTS).map(turn).collect() }
        };
        Self { pairs: pairs.map(beat).collect() }
    }

    /// The swing at a place where the tones have these amplitudes.
    fn swing(&self, amplitudes: &[Complex64]) -> Swing {
        let mean: f64 = 0.5 * amplitudes.iter().map(Complex64::norm_sqr).sum::<f64>();
        let mut squares = vec![mean; SECONDS * MOMENTS];
        let (mut power, mut weighted) = (0.0, 0.0);
        for Beat { tones, frequency_hz, share, turns } in &self.pairs {
            let product = amplitudes[tones.0] * amplitudes[tones.1].conj();
            for (square, turn) in squares.iter_mut().zip(turns) {
                *square += product.re * turn.re - product.im * turn.im;
            }
            let beat = product.norm_sqr() * share * share;
            power += beat;
            weighted += beat * frequency_hz;
        }
        let depth_db = |second: &[f64]| {
            let (low, high) = second
                .iter()
                .fold((f64::INFINITY, 0.0_f64), |(low, high), &square| (low.min(square), high.max(square)));
            if high > 0.0 { 10.0 * (high / low.max(f64::MIN_POSITIVE)).log10() } else { 0.0 }
        };
        Swing {
            depth_db: depth_db(&squares[..MOMENTS]),
            largest_db: squares.chunks(MOMENTS).map(depth_db).fold(0.0, f64::max),
            frequency_hz: if power > 0.0 { weighted / power } else { 0.0 },
        }
    }
}
