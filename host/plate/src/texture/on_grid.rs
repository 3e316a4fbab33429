//! A texture as a chord: its tones on multiples of one base frequency, with phases for a small peak.
//!
//! ```text
//! Texture --each to the nearest multiple--> powers fitted again --> phases (crest) --> as loud as the peak allows
//! ```
//! The sum of tones on a grid is periodic, so a device can verify its peak and play it louder than the sum of the
//! amplitudes allows. The figures include the error that the grid causes.

use super::crest::low_peak_turns;
use super::error::TextureError;
use super::figures::Figures;
use super::fit::{HEADROOM, Texture, TextureTone, least_beat_hz};
use super::palette::Palette;
use super::refinement;
use super::target::Target;
use crate::quantity::decibels;

/// The longest period of a chord, in samples.
pub const CHORD_PERIOD: u32 = 1 << 14;
/// Bisection steps of the search for a place.
const HALVINGS: usize = 60;

/// A texture whose tones are multiples of the sample rate over [`CHORD_PERIOD`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ChordTexture {
    /// The tones, together as loud as the sum of their amplitudes allows; the phases are those of the chord.
    pub texture: Texture,
    /// The multiple of the base frequency of each tone, rising.
    pub harmonics: Vec<u32>,
    /// Additional gain of the chord, possible because its peak is smaller than the sum of the amplitudes, dB; 0 or
    /// more.
    pub gain_db: f64,
}

/// Tolerated losses by the grid: relative increase of the error, dB of ripple, dB of contrast.
const TOLERATED: (f64, f64, f64) = (0.05, 0.5, 1.0);

impl ChordTexture {
    /// Whether the loss by the grid against the texture with free tones is negligible: at most 5 % more error, 0.5 dB
    /// more ripple and 1 dB less contrast.
    pub fn is_as_good_as(&self, free: &Texture) -> bool {
        let (error, ripple_db, contrast_db) = TOLERATED;
        let (is, was) = (&self.texture.figures, &free.figures);
        let within = |is: Option<f64>, was: Option<f64>, worse_by: f64, sign: f64| {
            is.zip(was).is_none_or(|(is, was)| sign * (is - was) <= worse_by)
        };
        is.rms_error <= (1.0 + error) * was.rms_error
            && within(is.ripple_db, was.ripple_db, ripple_db, 1.0)
            && within(is.contrast_db, was.contrast_db, contrast_db, -1.0)
    }
}

impl Texture {
    /// The same texture on the multiples of `sample rate / CHORD_PERIOD`, with powers fitted again. `None` if no
    /// multiple lies within the frequencies that the target allows, or if none of the tones on them has any power.
    ///
    /// # Errors
    /// [`TextureError::Silent`] if the plate does not respond.
    pub fn on_grid(
        &self,
        palette: &Palette<'_>,
        target: &Target,
    ) -> Result<Option<ChordTexture>, TextureError> {
        let table = palette.table();
        let base_hz = table.sample_rate_hz() / f64::from(CHORD_PERIOD);
        let (start_m, end_m) = target.allowed_m;
        let (lowest, highest) = (
            (table.frequency_hz(start_m) / base_hz).ceil() as u32,
            (table.frequency_hz(end_m) / base_hz).floor() as u32,
        );
        if lowest > highest {
            return Ok(None);
        }
        let nearest: Vec<u32> =
            self.tones.iter().map(|tone| (tone.frequency_hz / base_hz).round() as u32).collect();
        let harmonics = parted(&nearest, lowest.max(1), highest, base_hz);
        let positions_m: Vec<f64> =
            harmonics.iter().map(|&m| place_of(palette, f64::from(m) * base_hz)).collect();
        let powers = refinement::powers_at(palette, target, &positions_m)?;
        let (harmonics, (positions_m, powers)): (Vec<u32>, (Vec<f64>, Vec<f64>)) = harmonics
            .into_iter()
            .zip(positions_m.into_iter().zip(powers))
            .filter(|(_, (_, power))| *power > 0.0)
            .unzip();
        if harmonics.is_empty() {
            return Ok(None);
        }
        let dac: Vec<f64> =
            positions_m.iter().zip(&powers).map(|(&x, power)| power.sqrt() * table.gain(x)).collect();
        let (turns, peak) = low_peak_turns(&harmonics, &dac, CHORD_PERIOD);
        let (sum, loudest) = (dac.iter().sum::<f64>(), powers.iter().copied().fold(0.0, f64::max).sqrt());
        // No tone may exceed the level 1 of the table.
        let scale = |of: f64| (HEADROOM / of).min(loudest.recip());
        let tones = positions_m.iter().zip(&powers).zip(turns).map(|((&position_m, power), phase_turns)| {
            TextureTone {
                position_m,
                frequency_hz: table.frequency_hz(position_m),
                level: power.sqrt() * scale(sum),
                phase_turns,
            }
        });
        let squares = palette.squares(&positions_m)?.times(&powers);
        let figures = Figures::of(&squares, &self.places_m, target);
        let texture = self.with_tones(tones.collect(), figures, &squares, target, scale(sum), palette);
        Ok(Some(ChordTexture { texture, harmonics, gain_db: decibels(scale(peak) / scale(sum)) }))
    }
}

/// These rising harmonics, each within `lowest..=highest` and without repetition. A harmonic whose beat with the next
/// higher one would be too slow is moved down; it is left out if there is no room for it. The highest is kept, because
/// it determines the edge of an area.
fn parted(nearest: &[u32], lowest: u32, highest: u32, base_hz: f64) -> Vec<u32> {
    let mut parted: Vec<u32> = Vec::with_capacity(nearest.len());
    for harmonic in nearest.iter().rev().map(|harmonic| (*harmonic).clamp(lowest, highest)) {
        let Some(&above) = parted.last() else {
            parted.push(harmonic);
            continue;
        };
        let apart = (least_beat_hz(f64::from(above) * base_hz) / base_hz).ceil() as u32;
        let moved = harmonic.min(above.saturating_sub(apart));
        if harmonic != above && moved >= lowest {
            parted.push(moved);
        }
    }
    parted.reverse();
    parted
}

/// The place of the span with this frequency, metres; the frequency must be within those of the table.
fn place_of(palette: &Palette<'_>, frequency_hz: f64) -> f64 {
    let table = palette.table();
    let (mut low_m, mut high_m) = table.span_m();
    for _ in 0..HALVINGS {
        let middle_m = 0.5 * (low_m + high_m);
        if table.frequency_hz(middle_m) < frequency_hz { low_m = middle_m } else { high_m = middle_m }
    }
    0.5 * (low_m + high_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ultrasonic_harmonics_that_would_beat_are_moved_down_and_others_stay() {
        // 40 multiples are 976.6 Hz, 41 are 1001 Hz; 20 kHz is the multiple 819.2.
        let base_hz = 400e3 / f64::from(CHORD_PERIOD);
        let parted = |nearest: &[u32], lowest| parted(nearest, lowest, 1600, base_hz);
        assert_eq!(parted(&[860, 900, 940, 981], 700), [858, 899, 940, 981]);
        assert_eq!(parted(&[860, 901, 945], 700), [860, 901, 945]);
        // Below 20 kHz one step of 24 Hz is enough, and two tones on one multiple become one.
        assert_eq!(parted(&[4, 4, 5, 780, 783, 825], 4), [4, 5, 780, 783, 825]);
        // A tone right below 20 kHz beats with one above: 40 multiples are too few there, too.
        assert_eq!(parted(&[818, 858], 700), [817, 858]);
        // There is no room for the lowest; the highest becomes the table's.
        assert_eq!(parted(&[1550, 1590, 1700], 1550), [1559, 1600]);
    }
}
